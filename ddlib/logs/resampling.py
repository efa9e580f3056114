"""From samples as they were logged to samples on one even grid, with a word on every change."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import cheby1, sosfiltfilt

from ddlib._check import flag, instance, integer, number
from ddlib.logs._text import fault, shortened
from ddlib.logs.log import Log, LoggedRecording, LoggedRun
from ddlib.tables import plural
from ddlib.trajectories import Trajectory

_SMALL = 2e-3  # of a step: a stamp may be off by this, which no encoder sees
_ALIKE = 1e-3  # by how much, relatively, clocks of runs may differ unseen
_OTHER = 0.1  # by how much they differ if rates do
_MUCH = 0.01  # of all samples: to lose or to invent more is worth a warning


class LogWarning(UserWarning):
    """Much of a log was left out or filled in, to bring it onto an even grid."""


def resample(
    log: Log,
    step: float | None = None,
    *,
    longest_gap: int = 3,
    seconds: float | None = None,
    trust_stamps: bool = True,
) -> LoggedRecording:
    """Bring the runs of a log onto one even grid, and into arrays of equal length.

    If steps are whole multiples of the usual one, samples are missing. Stamps that were rounded
    stand for samples at equal steps, of the mean length: samples stay as they are. Stamps that may
    be either are read so that the angles are smoother. Else angles are interpolated by cubic
    splines and torques by straight lines. A lower rate is taken after a low-pass without a lag, the
    same for angles and torques (Chebyshev's, of order 8, there and back). Gaps part a run into
    several. Of runs of unlike lengths all are cut to the length that keeps most samples, and what
    is shorter is left out.

    Parameters
    ----------
    log : Log
        What `read_log` gives.
    step : float, optional
        Step of the grid, s; default: the mean step of the log.
    longest_gap : int
        A run is parted where stamps are further apart than this many steps; what is missing in a
        shorter gap is interpolated.
    seconds : float, optional
        Length into which all runs are cut, s; what is left at their ends is left out.
    trust_stamps : bool
        Whether samples were taken when stamps say. If False, they were taken at equal steps, none
        is missing but in gaps, and the stamps came late.

    Returns
    -------
    LoggedRecording
        `notes` are those of the log, then a sentence for each change. The torque of a sample is
        taken as that at its stamp.

    Raises
    ------
    ValueError
        With file, line and values: if times do not grow, or runs have different steps.

    Warns
    -----
    LogWarning
        If more than a hundredth of the samples were left out or filled in.
    """
    return on_one_grid(log, step, longest_gap, seconds, trust_stamps)


def on_one_grid(log, step, longest_gap, seconds, trust_stamps) -> LoggedRecording:
    """What `resample` returns; its warning names the line that called the caller."""
    instance("log", log, Log)
    for name, value in (("step", step), ("seconds", seconds)):
        if value is not None:
            number(name, value, 0.0, open_low=True)
    integer("longest_gap", longest_gap, 1)
    flag("trust_stamps", trust_stamps)
    if not log.runs:
        raise ValueError("log must hold one run or more, got none")
    for run in log.runs:
        _check_times(run)
    if step is None:
        _check_rates(log.runs)
    notes = list(log.notes)
    pieces = [piece for run in log.runs for piece in _parted(run, longest_gap, notes)]
    if not pieces:
        raise fault(f"{shortened(log.runs[0].name, 100)}: gaps leave no three samples in a row")
    grids = [_grid(piece, trust_stamps, notes) for piece in pieces]
    target = _common_step(pieces, grids, step, notes)
    even = [_even(piece, grid, target, notes) for piece, grid in zip(pieces, grids)]
    runs = _of_one_length(even, target, seconds, notes)
    logged, parted, total, kept = (
        sum(len(run.t) for run in some) for some in (log.runs, pieces, even, runs)
    )
    changes = {
        "left out": 1 - parted / logged * kept / total,
        "filled in": sum(grid.missing for grid in grids) / total,
    }
    what = max(changes, key=changes.get)
    if changes[what] > _MUCH:
        name = shortened(log.runs[0].name, 100)
        told = f"{100 * changes[what]:.0f} % of the samples of the log were {what}"
        warnings.warn(f"{name}: {told}; the recording's notes say where", LogWarning, stacklevel=3)
    return _recording(runs, target, notes)


def _check_times(run: LoggedRun) -> None:
    """Refuse a run of which no grid can be made."""
    name, steps = shortened(run.name, 100), np.diff(run.t)
    if len(run.t) < 3:
        raise fault(f"{name}: must have three samples or more, got {len(run.t)}")
    if not (steps > 0).all():
        k = int(np.argmin(steps > 0))
        advice = "skip_bad=True leaves such lines out; run= is a column that tells runs apart"
        raise fault(
            f"{name}, line {run.lines[k + 1]}: time must grow, but {run.t[k]:.9g} s is followed by "
            f"{run.t[k + 1]:.9g} s, one of {plural(int((steps <= 0).sum()), 'place')}; {advice}"
        )


def _check_rates(runs) -> None:
    """Refuse runs of different rates."""
    steps = np.array([_usual_step(np.diff(run.t)) for run in runs])
    off = np.abs(steps / np.median(steps) - 1)
    if off.max() > _OTHER:
        k = int(np.argmax(off))
        these = f"steps of {steps[k]:g} s, where {np.median(steps):g} s are usual"
        name = shortened(runs[k].name, 100)
        raise fault(f"{name}: {these}; say by step= to which all are brought")


def _parted(run: LoggedRun, longest_gap: int, notes) -> list[LoggedRun]:
    """A run parted at its gaps, without parts of less than three samples."""
    steps = np.diff(run.t)
    cuts = np.flatnonzero(steps > (longest_gap + 0.5) * _usual_step(steps)) + 1
    if not cuts.size:
        return [run]
    parts = np.split(np.arange(len(run.t)), cuts)
    lost = sum(len(part) for part in parts if len(part) < 3)
    notes.append(
        f"{shortened(run.name, 100)}: parted at {plural(cuts.size, 'gap')} of more than "
        f"{longest_gap} steps, the longest of {steps.max():.3g} s before line "
        f"{run.lines[steps.argmax() + 1]}; {plural(lost, 'sample')} between gaps left out."
    )
    cut = [_cut(run, part, f"{run.name}, part {k + 1}") for k, part in enumerate(parts)]
    return [part for part in cut if len(part.t) > 2]


def _usual_step(steps) -> float:
    """The step at which samples were taken, though some are missing or stamps uneven."""
    usual = float(np.percentile(steps, 50, method="lower"))  # a step that occurs
    multiples = np.round(steps / usual)
    if multiples.min() > 0 and (multiples <= 3).mean() > 0.9:
        return usual
    while steps.max() > 5 * steps.mean():  # stamps come in bursts
        steps = steps[steps <= 5 * steps.mean()]
    return float(steps.mean())


class _Grid(NamedTuple):
    """The even grid that samples were taken on."""

    step: float
    count: np.ndarray  #: Which point of the grid each sample is.
    off: float  #: Largest distance of a stamp from it, s.
    grain: float  #: What stamps are rounded to, s.
    uneven: bool = False  #: Whether samples lie between its points.

    @property
    def missing(self) -> int:
        """How many of its points have no sample."""
        return 0 if self.uneven else int(self.count[-1]) + 1 - len(self.count)


def _grid(run: LoggedRun, trust_stamps: bool, notes) -> _Grid:
    """The even grid of a run, from which samples are missing or whose stamps are rounded."""
    name, steps = shortened(run.name, 100), np.diff(run.t)
    stamps = f"stamps (steps of {steps.min():.6g} to {steps.max():.6g} s)"
    with_gaps = np.r_[0, np.cumsum(np.round(steps / _usual_step(steps)))].astype(int)
    in_a_row = _fitted(run.t, np.arange(len(run.t)))
    fits = [grid for grid in (_fitted(run.t, with_gaps), in_a_row) if not grid.uneven]
    if not trust_stamps:
        grid, what = in_a_row._replace(uneven=False), "taken as late notes of"
    elif not fits:
        notes.append(
            f"{name}: uneven {stamps}; angles interpolated by cubic splines and torques by lines."
        )
        return in_a_row
    else:
        rough = [_roughness(run.q, grid.count) for grid in fits]
        grid, what = fits[-1 if rough[-1] < 0.95 * rough[0] else 0], "are rounded; taken as"
    if grid.off > _SMALL * grid.step:
        notes.append(
            f"{name}: {stamps} {what} samples at even steps of {grid.step:.6g} s, from which they "
            f"are off by up to {1e3 * grid.off:.3g} ms."
        )
    if grid.missing:
        after = run.lines[np.argmax(np.diff(grid.count) > 1)]
        notes.append(
            f"{name}: {plural(grid.missing, 'missing sample')} interpolated, the first after line "
            f"{after}; if none is missing, as stamps are rounded, say trust_stamps=False."
        )
    return grid


def _fitted(t, count) -> _Grid:
    """The grid that fits best, if samples are these points of it."""
    step = np.polynomial.polynomial.polyfit(count - count.mean(), t - t[0], 1)[1]
    off, grain = np.ptp(t - t[0] - step * count) / 2, _grain(t)
    if off <= _SMALL * step:
        step = (t[-1] - t[0]) / count[-1]
    uneven = off > max(_SMALL * step, 0.55 * grain) or np.diff(count).min() < 1
    return _Grid(float(step), count, float(off), grain, bool(uneven))


def _grain(t) -> float:
    """The power of ten, or of two, that all stamps are multiples of, s; at least a nanosecond."""
    units = [10.0**-k for k in range(9)] + [2.0**-k for k in range(30)]
    for unit in sorted(units, reverse=True):
        if np.abs(t / unit - np.round(t / unit)).max() < 2e-3:
            return unit
    return 1e-9


def _roughness(q, count) -> float:
    """How far angles lie from straight lines between their neighbours, in all."""
    share = (count[1:-1] - count[:-2]) / (count[2:] - count[:-2])
    between = q[:-2] + (q[2:] - q[:-2]) * share[:, None]
    return float(np.linalg.norm(q[1:-1] - between))


def _common_step(pieces, grids, step, notes) -> float:
    """The step to which all are brought."""
    steps = np.array([grid.step for grid in grids])
    if step is not None:  # three samples at least, and no flood of them
        return number("step", step, steps.min() / 100, max(np.ptp(run.t) for run in pieces) / 2)
    mean = float(np.average(steps, weights=[len(piece.t) for piece in pieces]))
    if np.ptp(steps) > 1e-4 * mean and not any(grid.uneven for grid in grids):
        theirs = f"{steps.min():.6g} to {steps.max():.6g} s"
        notes.append(f"runs have steps of {theirs}; all are taken as {mean:.6g} s.")
    return mean


def _even(run: LoggedRun, grid: _Grid, target: float, notes) -> LoggedRun:
    """A run at even steps of `target`, or of very nearly that."""
    name, step = shortened(run.name, 100), grid.step
    lower = target > (1 + _OTHER) * step
    if grid.uneven:
        step = step if lower else target
        run = _at(run, _points(run.t, step))
    elif grid.missing or grid.off > _SMALL * step:
        taken = run = replace(run, t=run.t[0] + step * grid.count)
        if grid.missing:
            run = _at(taken, taken.t[0] + step * np.arange(grid.count[-1] + 1))
            run.q[grid.count], run.tau[grid.count] = taken.q, taken.tau  # to the last digit
    if abs(step / target - 1) <= max(_ALIKE, grid.grain / (step * len(run.t))):
        return run
    finer = ", finer than logged: nothing is gained" if target < step else ""
    notes.append(f"{name}: brought from steps of {step:.6g} s to {target:.6g} s{finer}.")
    if lower:
        run = _low_pass(run, step, target)
        notes.append(f"{name}: low-pass without a lag, up to {0.4 / target:.4g} Hz.")
    return _at(run, _points(run.t, target))


def _points(t, step) -> np.ndarray:
    """Times from the first to the last, at even steps."""
    return t[0] + step * np.arange(int((t[-1] - t[0]) / step + 1e-6) + 1)


def _at(run: LoggedRun, t) -> LoggedRun:
    """A run at other times: angles by cubic splines, torques by straight lines."""
    q = make_interp_spline(run.t, run.q, min(3, len(run.t) - 1))(t)
    tau = make_interp_spline(run.t, run.tau, 1)(t)
    nearest = np.searchsorted((run.t[1:] + run.t[:-1]) / 2, t)
    return replace(run, t=t, q=q, tau=tau, lines=run.lines[nearest])


def _low_pass(run: LoggedRun, step, target) -> LoggedRun:
    """What a lower rate can hold, by the filter of `scipy.signal.decimate`; no lag.

    That filter's gain at rest is 0.994, once there and once back, so it is divided out.
    """
    sections = cheby1(8, 0.05, 0.8 * step / target, output="sos")
    sections[0, :3] /= np.prod(sections[:, :3].sum(1) / sections[:, 3:].sum(1))
    reach = min(len(run.t) - 1, int(20 * target / step))
    q, tau = (sosfiltfilt(sections, x, axis=0, padlen=reach) for x in (run.q, run.tau))
    return replace(run, q=q, tau=tau)


def _cut(run: LoggedRun, part, name: str) -> LoggedRun:
    """Some samples of a run."""
    t, q, tau, lines = (x[part] for x in (run.t, run.q, run.tau, run.lines))
    return replace(run, name=name, t=t, q=q, tau=tau, lines=lines)


def _of_one_length(runs, step, seconds, notes) -> list[LoggedRun]:
    """All runs cut to one length: `seconds`, or the one that keeps most samples."""
    lengths = np.array([len(run.t) for run in runs])
    if seconds is None:
        length = int(max(np.sort(lengths)[::-1], key=lambda n: n * (lengths >= n).sum()))
        counts = np.minimum(lengths // length, 1)
    else:
        length = round(seconds / step)
        if not 3 <= length <= lengths.max():
            raise ValueError(
                f"seconds must lie in [{3 * step:g}, {lengths.max() * step:g}], got {seconds:g}"
            )
        counts = lengths // length
    cut = []
    for run, count in zip(runs, counts):
        for k in range(count):
            name = run.name if count == 1 else f"{run.name}, cut {k + 1}"
            cut.append(_cut(run, slice(k * length, (k + 1) * length), name))
    if short := [run.name for run, count in zip(runs, counts) if not count]:
        notes.append(f"left out, as shorter than {plural(length, 'sample')}: {', '.join(short)}.")
    if ends := int((lengths - counts * length)[counts > 0].sum()):
        notes.append(
            f"cut into {plural(len(cut), 'run')} of {plural(length, 'sample')}, "
            f"{length * step:.6g} s; {plural(ends, 'sample')} at their ends left out."
        )
    return cut


def _recording(runs, step, notes) -> LoggedRecording:
    """Runs of one length as a recording; where their times are one even grid, these are kept."""
    t = runs[0].t
    same = all(np.array_equal(run.t, t) for run in runs)
    if not same or not np.allclose(np.diff(t), step, rtol=1e-6, atol=0.0):
        t = (t[0] if all(run.t[0] == t[0] for run in runs) else 0.0) + step * np.arange(len(t))
    q, tau, lines = (np.stack([getattr(x, name) for x in runs]) for name in ("q", "tau", "lines"))
    unknown = np.full_like(q, np.nan)
    return LoggedRecording(
        t,
        Trajectory(unknown, unknown, unknown),
        q,
        tau,
        unknown,
        unknown,
        unknown,
        control_step=0.0,
        names=tuple(run.name for run in runs),
        lines=lines,
        notes=tuple(notes),
        joints=max(run.joints for run in runs),
    )
