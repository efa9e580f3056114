"""From samples as they were logged to samples on one even grid, with a word on every change."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.signal import cheby1, sosfiltfilt

from ddlib._check import integer, number
from ddlib.logs._text_files import fault, listed, shown
from ddlib.logs.log import Log, LoggedRecording, LoggedRun
from ddlib.trajectories import Trajectory

_SMALL = 2e-3  # of a step: a stamp may be off by this, which no encoder sees
_ALIKE = 1e-3  # by how much, relatively, clocks of runs may differ unseen
_OTHER = 0.1  # by how much they differ if rates do
_LOWER = 1.02  # a step this many times the log's needs a low-pass
_MUCH = 0.01  # of all samples: to lose or to invent more is worth a warning


class LogWarning(UserWarning):
    """Much of a log was left out or filled in, to bring it onto an even grid."""


@dataclass
class Piece:
    """Samples of a run without a gap."""

    run: str
    t: np.ndarray
    q: np.ndarray
    tau: np.ndarray
    lines: np.ndarray

    def cut(self, part) -> Piece:
        """Those samples that a slice or a mask picks."""
        return Piece(self.run, self.t[part], self.q[part], self.tau[part], self.lines[part])

    def at(self, t) -> Piece:
        """Interpolated at other times: angles by cubic splines, torques by straight lines."""
        if t.shape == self.t.shape and (t == self.t).all():
            return self
        q, tau = (
            make_interp_spline(self.t, x, min(degree, len(self.t) - 1))(t)
            for x, degree in ((self.q, 3), (self.tau, 1))
        )
        right = np.clip(np.searchsorted(self.t, t), 1, len(self.t) - 1)
        nearest = right - (t - self.t[right - 1] < self.t[right] - t)
        return Piece(self.run, t, q, tau, self.lines[nearest])


def resample(
    log: Log,
    step: float | None = None,
    *,
    longest_gap: int = 3,
    seconds: float | None = None,
    trust_stamps: bool = True,
) -> LoggedRecording:
    """Bring the runs of a log onto one even grid, and into arrays of equal length.

    Stamps that were rounded stand for samples at equal steps, of the mean length: samples stay as
    they are. Else angles are interpolated by cubic splines and torques by straight lines. A lower
    rate is taken after a low-pass without a lag, the same for angles and torques (Chebyshev's, of
    order 8, there and back). Gaps part a run into several. Of runs of unlike lengths all are cut
    to the length that keeps most samples, and what is shorter is left out.

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
        Whether samples were taken when uneven stamps say. If False, they were taken at equal steps,
        and the stamps came late.

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
    recording, told = resampled(log, step, longest_gap, seconds, trust_stamps)
    if told:
        warnings.warn(told, LogWarning, stacklevel=2)
    return recording


def resampled(log, step, longest_gap, seconds, trust_stamps) -> tuple[LoggedRecording, str]:
    """The recording of `resample`, and the text of its warning if there is one."""
    if not isinstance(log, Log):
        raise TypeError(f"log must be a Log, as read_log gives, got {type(log).__name__}")
    if step is not None:
        step = number("step", step, 0.0, open_low=True)
    integer("longest_gap", longest_gap, 1)
    if seconds is not None:
        seconds = number("seconds", seconds, 0.0, open_low=True)
    if not log.runs:
        raise ValueError("log must hold one run or more, got none")
    for run in log.runs:
        _check_times(run)
    own = [_step_of(run.t) for run in log.runs]
    common = float(np.median(own))
    for run, one in zip(log.runs, own):
        if step is None and abs(one / common - 1) > _OTHER:
            first = shown(log.runs[int(np.argmin(np.abs(np.array(own) - common)))].name, 80)
            raise fault(
                f"{shown(run.name, 80)}: steps of {one:g} s, where {first} has {common:g} s; "
                f"say by step= to which all are brought"
            )
    notes = list(log.notes)
    pieces, lost = _pieces(log, own, longest_gap, notes)
    if step is not None:  # three samples at least, and no flood of them
        number("step", step, min(own) / 100, max(np.ptp(piece.t) for piece in pieces) / 2)
    made, added = _even(pieces, step, trust_stamps, notes)
    grid = made[0].t[1] - made[0].t[0] if step is None else step
    total = sum(len(piece.t) for piece in made)
    made = _of_one_length(made, grid, seconds, notes)
    kept = sum(len(piece.t) for piece in made)
    changed = (total - kept) / total, added / total, lost / (total + lost)
    told = ""
    if max(changed) > _MUCH:
        what = "filled in" if changed[1] == max(changed) else "left out"
        told = (
            f"{shown(log.runs[0].name, 100)}: {100 * max(changed):.0f} % of the samples of the log "
            f"were {what}; the recording's notes say where"
        )
    return _recording(made, grid, notes), told


def _check_times(run: LoggedRun) -> None:
    """Refuse a run whose times do not grow."""
    name = shown(run.name, 100)
    if len(run.t) < 3:
        raise fault(f"{name}: must have three samples or more, got {len(run.t)}")
    steps = np.diff(run.t)
    bad = np.flatnonzero(~(steps > 0))
    if not bad.size:
        return
    k = bad[0]
    place = f"{name}, line {run.lines[k + 1]}: time must grow, but"
    ends = f"{run.t[0]:.9g} s to {run.t[-1]:.9g} s"
    if (steps < 0).all():
        raise fault(f"{place} falls throughout, from {ends}; is the file in reverse order?")
    if (steps == 0).all():
        raise fault(f"{place} is {run.t[0]:.9g} s throughout; is it the right column?")
    told = f"{place} {run.t[k]:.9g} s is followed by {run.t[k + 1]:.9g} s"
    if bad.size > 1:
        told += f" (and {bad.size - 1} more such places)"
    if run.t[k + 1] <= run.t[0] + abs(steps[steps > 0].mean()):
        raise fault(f"{told}; if a run begins there, tell runs apart by a column, run=")
    raise fault(f"{told}; skip_bad=True leaves such lines out")


def _step_of(t) -> float:
    """The step at which samples were taken, though some are missing or stamps uneven."""
    steps = np.diff(t)
    step = float(np.median(steps))
    for _ in range(5):
        count = np.round(steps / step)
        near = (count >= 1) & (count <= 3)
        if near.mean() < 0.9 or (count < 1).any():
            return _mean_step(steps)
        step = float(steps[near].sum() / count[near].sum())
    left = t[1:] - step * np.cumsum(count)
    return step if np.ptp(left) < step else _mean_step(steps)


def _mean_step(steps) -> float:
    for _ in range(20):
        fine = steps <= 5 * steps.mean()
        if fine.all():
            break
        steps = steps[fine]
    return float(steps.mean())


def _pieces(log, own, longest_gap, notes) -> tuple[list[Piece], int]:
    """Runs parted at their gaps, and how many samples were lost in pieces too short to use."""
    pieces, lost = [], 0
    for run, step in zip(log.runs, own):
        steps = np.diff(run.t)
        cuts = np.flatnonzero(steps > (longest_gap + 0.5) * step) + 1
        if cuts.size:
            worst = int(steps.argmax())
            notes.append(
                f"{shown(run.name, 100)}: parted at {_times(cuts.size, 'gap')} of more than "
                f"{longest_gap} steps, the longest of {steps[worst]:.3g} s before line "
                f"{run.lines[worst + 1]}."
            )
        for k, rows in enumerate(np.split(np.arange(len(run.t)), cuts)):
            name = f"{run.name}, part {k + 1}" if cuts.size else run.name
            if len(rows) < 3:
                lost += len(rows)
                continue
            piece = Piece(name, run.t, run.q, run.tau, run.lines)
            pieces.append(piece.cut(rows) if cuts.size else piece)
    if lost:
        notes.append(f"{_times(lost, 'sample')} between gaps left out.")
    if not pieces:
        raise fault(f"{shown(log.runs[0].name, 100)}: gaps leave no three samples in a row")
    return pieces, lost


def _even(pieces, step, trust_stamps, notes) -> tuple[list[Piece], int]:
    """All pieces at times with one even step, and how many samples were filled in."""
    fits = [_fit(piece.t) for piece in pieces]
    weights = np.array([len(piece.t) for piece in pieces], float)
    steps = np.array([fit.step for fit in fits])
    mean = float((steps * weights).sum() / weights.sum())
    target = mean if step is None else step
    lower = 1 + _OTHER if step is None else _LOWER
    made, added = [], 0
    for piece, fit in zip(pieces, fits):
        name, n = shown(piece.run, 100), len(piece.t)
        doubt = fit.grain / (n * fit.step)
        alike = abs(fit.step / target - 1) <= max(_ALIKE, doubt)
        if fit.count is not None and fit.off > _SMALL * fit.step:
            notes.append(
                f"{name}: stamps are rounded (steps of {np.diff(piece.t).min():.6g} to "
                f"{np.diff(piece.t).max():.6g} s); taken as even steps of {fit.step:.6g} s."
            )
        if fit.count is None and not trust_stamps:
            fit = replace(fit, count=np.arange(n), step=(piece.t[-1] - piece.t[0]) / (n - 1))
            alike = step is None or abs(fit.step / target - 1) <= _ALIKE
            notes.append(
                f"{name}: uneven stamps taken as late notes of samples at even steps of "
                f"{fit.step:.6g} s; the stamps are off by up to {1e3 * fit.off:.3g} ms."
            )
        if fit.count is not None:  # samples lie on a grid, some of them may be missing
            every = np.arange(fit.count[-1] + 1)
            on_grid = Piece(
                piece.run, piece.t[0] + fit.step * fit.count, piece.q, piece.tau, piece.lines
            )
            if len(every) > n:
                added += len(every) - n
                first = int(np.argmax(np.diff(fit.count) > 1))
                notes.append(
                    f"{name}: {_times(len(every) - n, 'missing sample')} interpolated, the first "
                    f"after line {piece.lines[first]}."
                )
                on_grid = on_grid.at(piece.t[0] + fit.step * every)
                on_grid = _kept(on_grid, piece, fit.count)
            elif fit.off <= _SMALL * fit.step:
                on_grid = replace(on_grid, t=piece.t)  # the file's own times
        else:
            notes.append(
                f"{name}: uneven stamps (steps of {np.diff(piece.t).min():.3g} to "
                f"{np.diff(piece.t).max():.3g} s); angles interpolated by cubic splines and "
                f"torques by lines, to even steps of {target:.6g} s."
            )
            on_grid = piece if not target > lower * fit.step else piece.at(_grid(piece.t, fit.step))
            alike = False
        if not alike:
            if fit.count is not None:
                notes.append(
                    f"{name}: brought from steps of {fit.step:.6g} s to steps of {target:.6g} s"
                    + (", finer than logged: nothing is gained." if target < fit.step else ".")
                )
            if target > lower * fit.step:
                on_grid = _low_pass(on_grid, fit.step, target)
                notes.append(
                    f"{name}: angles and torques went through a low-pass without a lag, up to "
                    f"{0.4 / target:.4g} Hz."
                )
            on_grid = on_grid.at(_grid(on_grid.t, target))
        made.append(on_grid)
    spread = steps.max() / steps.min() - 1
    if step is None and spread > 1e-4 and all(fit.count is not None for fit in fits):
        notes.append(
            f"runs have steps of {steps.min():.6g} to {steps.max():.6g} s; all are taken as "
            f"{mean:.6g} s."
        )
    same = all(len(x.t) == len(made[0].t) and (x.t == made[0].t).all() for x in made)
    if not same or step is not None or not np.allclose(np.diff(made[0].t), mean, rtol=1e-6, atol=0):
        start = made[0].t[0] if all(x.t[0] == made[0].t[0] for x in made) else 0.0
        made = [replace(x, t=start + target * np.arange(len(x.t))) for x in made]
    return made, added


@dataclass
class _Fit:
    """The even grid that stamps are nearest to."""

    step: float
    count: np.ndarray | None  # which point of the grid each sample is; None: on none
    off: float  # largest distance of a stamp from it, s
    grain: float  # what stamps were rounded to, s


def _fit(t) -> _Fit:
    """Whether stamps are an even grid's, to rounding, and which of its points are missing."""
    grain, tried = _grain(t), []
    guesses = [np.arange(len(t))]
    steps = np.round(np.diff(t) / _step_of(t))
    if (steps >= 1).all():
        guesses.append(np.r_[0, np.cumsum(steps)].astype(int))
    for count in guesses:
        slope = np.polynomial.polynomial.polyfit(count - count.mean(), t - t[0], 1)
        left = t - t[0] - slope[0] - slope[1] * (count - count.mean())
        off = float((left.max() - left.min()) / 2)
        if off <= max(_SMALL * slope[1], 0.55 * grain):
            if len(count) == count[-1] + 1 and off < 1e-9 * slope[1] * len(t):
                slope[1] = (t[-1] - t[0]) / count[-1]
            return _Fit(float(slope[1]), count, off, grain)
        tried.append((off, float(slope[1])))
    return _Fit(_step_of(t), None, tried[0][0], grain)


def _grain(t) -> float:
    """The power of ten that all stamps are multiples of, s; at least a nanosecond."""
    for decimals in range(9):
        scaled = t * 10.0**decimals
        if np.abs(scaled - np.round(scaled)).max() < 2e-3:
            return 10.0**-decimals
    return 1e-9


def _kept(full: Piece, piece: Piece, count) -> Piece:
    """A filled-in piece with the samples that were there, to the last digit."""
    q, tau = full.q.copy(), full.tau.copy()
    q[count], tau[count] = piece.q, piece.tau
    return replace(full, q=q, tau=tau)


def _grid(t, step) -> np.ndarray:
    return t[0] + step * np.arange(int((t[-1] - t[0]) / step + 1e-6) + 1)


def _low_pass(piece: Piece, step, target) -> Piece:
    """What a lower rate can hold, by the filter of `scipy.signal.decimate`; no lag.

    That filter's gain at rest is 0.994, once there and once back, so it is divided out.
    """
    sections = cheby1(8, 0.05, 0.8 * step / target, output="sos")
    sections[0, :3] /= np.prod(sections[:, :3].sum(1) / sections[:, 3:].sum(1))
    reach = min(len(piece.t) - 1, int(20 * target / step))
    q, tau = (sosfiltfilt(sections, x, axis=0, padlen=reach) for x in (piece.q, piece.tau))
    return replace(piece, q=q, tau=tau)


def _of_one_length(pieces, step, seconds, notes) -> list[Piece]:
    """All pieces cut to one length: `seconds`, or the one that keeps most samples."""
    lengths = np.array([len(piece.t) for piece in pieces])
    if seconds is not None:
        length = round(seconds / step)
        if not 3 <= length <= lengths.max():
            raise ValueError(
                f"seconds must lie in [{3 * step:g}, {lengths.max() * step:g}] for these runs, "
                f"got {seconds:g}"
            )
        cut = [
            replace(piece.cut(slice(k * length, (k + 1) * length)), run=_part(piece, k, length))
            for piece in pieces
            for k in range(len(piece.t) // length)
        ]
        left = lengths.sum() - length * len(cut)
        notes.append(
            f"cut into {_times(len(cut), 'run')} of {length} samples ({length * step:.6g} s)"
            + (f"; {_times(left, 'sample')} at their ends left out." if left else ".")
        )
        t = cut[0].t[0] if len(cut) == len(pieces) else 0.0
        return [replace(piece, t=t + step * np.arange(length)) for piece in cut]
    if (lengths == lengths[0]).all():
        return pieces
    options = np.unique(lengths)[::-1]
    length = int(options[np.argmax([n * (lengths >= n).sum() for n in options])])
    short = [piece for piece in pieces if len(piece.t) < length]
    long = [piece for piece in pieces if len(piece.t) > length]
    if short:
        worded = [f"{shown(piece.run, 60)} ({len(piece.t)} samples)" for piece in short]
        notes.append(
            f"left out as too short beside the {length} samples of others: "
            f"{listed(worded, 200, each=90)}."
        )
    if long:
        gone = sum(len(piece.t) - length for piece in long)
        notes.append(
            f"{_times(len(long), 'run')} cut to the {length} samples of the shortest that is "
            f"kept; {_times(gone, 'sample')} at their ends left out. seconds= cuts long runs into "
            f"several."
        )
    return [piece.cut(slice(length)) for piece in pieces if len(piece.t) >= length]


def _part(piece, k, length) -> str:
    return f"{piece.run}, cut {k + 1}" if len(piece.t) >= 2 * length else piece.run


def _times(count, what) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def _recording(pieces, step, notes) -> LoggedRecording:
    q, tau = (np.stack([getattr(piece, name) for piece in pieces]) for name in ("q", "tau"))
    unknown = np.full_like(q, np.nan)
    return LoggedRecording(
        pieces[0].t,
        Trajectory(unknown, unknown, unknown),
        q,
        tau,
        unknown,
        unknown,
        unknown,
        control_step=0.0,
        names=tuple(piece.run for piece in pieces),
        lines=np.stack([piece.lines for piece in pieces]),
        notes=tuple(notes),
    )
