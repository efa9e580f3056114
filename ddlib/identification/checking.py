"""Is a recording fit to be fitted? What its readings and the equations of motion show of it.

The same equations are fitted to the recording read in other ways: with joints exchanged, with
other signs, with a later torque. The reading under which they leave least of the torques is told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import interp1d
from scipy.signal import savgol_filter

from ddlib._check import instance
from ddlib.identification.averaging import (
    acting_time,
    bumps_held,
    bumps_over,
    five_point_velocity,
    kept_bumps,
    regressor_blur,
    samples_apart,
    where_sign_is_sure,
)
from ddlib.identification.equations import POSE, modulated
from ddlib.identification.regression import (
    FRICTION,
    GRAVITY,
    OFFSETS,
    RIGID,
    Equations,
    Estimate,
    estimated,
    known_names,
    regressor_columns,
)
from ddlib.logs.findings import JOINTS, SEVERITIES, Check, Finding
from ddlib.logs.readings import at_rest, readings, spikes, steady
from ddlib.simulation import Recording
from ddlib.trajectories import Trajectory

EVERY = (*RIGID, "b_sin", *POSE, *FRICTION, *OFFSETS)
"""All parameters: coupling and weight are those of angles whose zeros may be anywhere."""

SAMPLES = 60  # of a bump, up to twice as many: more tell a check nothing
LONGEST = 24  # bumps' widths in a piece of a run
MOST_LAG = 8  # samples
LEAST_ANGLE = (2.0, 4.0)  # degrees of a zero that matter: sines, and cosines


def check_recording(recording: Recording, names: Sequence[str] = RIGID + FRICTION) -> Check:
    """What a recording shows before anything is fitted to it, the worst first.

    Single readings show wrong units, wraps, spikes, drop-outs and values that are held,
    saturation, joints that rest or have no torque, and torques that look like a command. The
    equations of motion show wrong signs, exchanged joints, a lag, angles that are counted
    otherwise or from another zero, and weight and offsets that are not among the parameters. What
    the motion tells of each parameter, `least_squares` says.

    Parameters
    ----------
    recording : Recording
        Simulated, or a log from `ddlib.logs.read_csv`: arrays (time, 2) or (runs, time, 2).
    names : sequence of str
        The parameters that will be fitted, from `RIGID`, `GRAVITY`, `FRICTION` and `OFFSETS`.

    Returns
    -------
    Check
        Its ``findings``, ``wrong`` and ``of(kind)``. A check that found nothing wrong does not
        say that nothing is.

    Raises
    ------
    TypeError
        If it is no recording.
    ValueError
        If its arrays do not have two joints, or hold what is no finite number.
    """
    instance("recording", recording, Recording)
    known_names(names)
    q, tau = (np.asarray(x, float) for x in (recording.q, recording.tau))
    if q.shape[-2:] != (recording.t.size, 2) or tau.shape != q.shape:
        raise ValueError(
            f"recording must have q and tau of shape (..., {recording.t.size}, 2), got {q.shape} "
            f"and {tau.shape}"
        )
    for name, x in (("q", q), ("tau", tau)):
        if not np.isfinite(x).all():
            raise ValueError(f"recording must have finite {name}, got NaN or infinity")
    recording = recording.mapped(lambda x: x.reshape(-1, *x.shape[-2:]))
    found = [*readings(recording), *_joints(recording), *_motions(recording, names)]
    return Check(tuple(sorted(found, key=lambda f: SEVERITIES.index(f.severity))), recording)


def _finding(kind, severity, what, effect, advice, joint=None) -> Finding:
    return Finding(kind, severity, None, joint, what, effect, advice)


def _joints(recording) -> Iterator[Finding]:
    """Two joints of an arm that has more."""
    joints = getattr(recording, "joints", 2)
    if joints > 2:
        yield _finding(
            "larger arm", "doubtful", f"The file has {joints} joints, and two of them were read.",
            "The equations are those of two joints with parallel axes, all others locked. Else "
            "the others' motion goes into these numbers.",
            "Hold the other joints still, or take a tool for all of them: figaroh, FloBaRoID or "
            "Pinocchio.",
        )  # fmt: skip


def _motions(recording, names) -> Iterator[Finding]:
    """What the equations of motion show over all runs together."""
    thinned = _thinned(recording)
    width, resting = _width(thinned), at_rest(np.concatenate([*(thinned.q - thinned.q[:, :1])]))
    works = [not steady(thinned.tau[..., j].ravel()) for j in range(2)]
    if resting.all() or not any(works):
        return
    if width < 12 or thinned.q[..., 0].size < 4 * width:
        yield _finding(
            "too short", "note", "There are too few samples to compare torque and motion.",
            "Sign, lag and units of the torque are not checked.", "Record longer motions.",
        )  # fmt: skip
        return
    pieces = _pieces(thinned, width)
    fit = _fit(pieces, width, blurred=True)
    if fit is None:
        return
    other = [] if resting.any() or not all(works) else [*_other_readings(pieces, width, fit)]
    yield from other
    if not other:
        yield from _torque_spikes(recording, pieces, width, fit)
        yield from _signs(pieces, fit, works)
        yield from _lag(pieces, width, recording.step / pieces.step)
        yield from _pose(pieces, width, fit, names)


def _with(recording, t, q, tau) -> Recording:
    """A recording of the motion alone, of other angles and torques."""
    none = np.full_like(q, np.nan)
    zero = Trajectory(*(np.zeros_like(q),) * 3)
    return Recording(t, zero, q, tau, none, none, none, control_step=recording.control_step,
                     computing_time=recording.computing_time)  # fmt: skip


def _thinned(recording) -> Recording:
    """The motion, without whole turns, as means of a few samples if there are many in a bump."""
    q, tau = (x[:, recording.motion] for x in (np.unwrap(recording.q, axis=1), recording.tau))
    step = recording.step
    plain = _with(recording, step * np.arange(q.shape[1]), q, tau)
    count = max(_width(plain) // SAMPLES, 1)
    if count == 1:
        return plain
    whole = q.shape[1] // count
    q, tau = (x[:, : whole * count].reshape(len(x), whole, count, 2).mean(2) for x in (q, tau))
    return _with(plain, step * count * np.arange(whole), q, tau)


def _width(recording) -> int:
    """Samples of a bump: two thirds of the motion's own period, a multiple of six."""
    q, samples = recording.q, recording.q.shape[1]
    smooth = savgol_filter(q, min(15, samples // 2 * 2 - 1), 2, axis=1) if samples > 3 else q
    speed = np.sum(np.diff(smooth, axis=1) ** 2, (0, 1))
    size = np.sum((smooth - smooth.mean(1, keepdims=True)) ** 2, (0, 1))
    moving = speed > 1e-12 * size.max() if size.max() else np.zeros(2, bool)
    if not moving.any():
        return 0
    period = 2 * np.pi * np.sqrt(size[moving] / speed[moving]).min()
    return int(min(max(0.67 * period, 18), samples // 4) // 6) * 6


def _pieces(recording, width) -> Recording:
    """Long runs cut into pieces, so that bumps are not many times more than equations need."""
    runs, samples, _ = recording.q.shape
    count = max(round(samples / (LONGEST * width)), 1)
    length = samples // count
    q, tau = (
        x[:, : count * length].reshape(runs * count, length, 2)
        for x in (recording.q, recording.tau)
    )
    return _with(recording, recording.t[:length], q, tau)


def _averaged(pieces, names, width, blurred=False) -> Equations:
    """Equations under bumps of so many samples.

    Their torques' noise is independent. How, depends on the motion alone, not on the torques: one
    torque can be held against another's equations.
    """
    begin, end = pieces.span
    place = pieces.t - begin, width * pieces.step, end - begin
    bumps, later = bumps_over(*place), bumps_held(*place, *acting_time(pieces, None))
    after = bumps_held(*place, 0.0, pieces.step)
    kept = kept_bumps(where_sign_is_sure(pieces, names), bumps[0])
    apart = samples_apart(pieces)
    whiten = [
        [np.linalg.inv(np.linalg.cholesky(later[k] @ later[k].T)) for k in runs] for runs in kept
    ]

    def white(series) -> tuple[np.ndarray, ...]:
        return tuple(
            np.concatenate([w @ x[run, k] for run, (w, k) in enumerate(zip(*parts))])
            for x, *parts in zip(series, whiten, kept)
        )

    def regressor(q) -> tuple[np.ndarray, ...]:
        rows = modulated(bumps, after, five_point_velocity(q, pieces.step, apart), q)
        like = np.empty((len(q), len(later)))
        return white([regressor_columns(row, names, like) for row in rows])

    torques = white(np.moveaxis(pieces.tau, -1, 0) @ later.T)
    blur = regressor_blur(pieces, regressor) if blurred else None
    return Equations(tuple(names), regressor(pieces.q), torques, blur)


@dataclass(frozen=True)
class _Fit:
    """Equations and what they tell; `share` is what they leave of the torques."""

    equations: Equations
    estimate: Estimate

    @property
    def shares(self) -> np.ndarray:
        """What is left of each joint's torque, as a share of its root mean square; NaN: none."""
        size = [np.sqrt(np.mean(y**2)) if y.any() else np.nan for y in self.equations.torque]
        return self.estimate.noise / np.array(size)

    @property
    def share(self) -> float:
        """Their geometric mean over joints."""
        return float(np.exp(np.nanmean(np.log(self.shares + 1e-9))))

    def of(self, name) -> tuple[float, float]:
        """A parameter and its standard error; NaN if it is not told."""
        names = self.estimate.names
        if name not in names:
            return np.nan, np.nan
        at = names.index(name)
        return float(self.estimate.values[at]), float(self.estimate.errors[at])

    def angle(self, cosine, sine) -> tuple[float, float]:
        """The angle whose cosine and sine two parameters have, and its standard error, degrees."""
        (x, dx), (y, dy) = self.of(cosine), self.of(sine)
        return np.degrees(np.arctan2(y, x)), np.degrees(np.hypot(x * dy, y * dx) / (x**2 + y**2))


def _fit(pieces, width, names=EVERY, blurred=False) -> _Fit | None:
    """The equations under bumps, solved; None if they determine nothing.

    A joint that is slow throughout has no friction of a sure sign.
    """
    for chosen in (names, [name for name in names if name[:-1] != "F_c"]):
        equations = _averaged(pieces, chosen, width, blurred)
        if min(y.shape[-1] for y in equations.torque) > len(names):
            try:
                return _Fit(equations, estimated(equations))
            except ValueError:
                pass
    return None


_READINGS = (
    (
        "elbow angle",
        "the elbow's angle were counted from a fixed direction, not from the upper arm",
        "Read the log with absolute_elbow=True, or take q2 - q1.",
        lambda q, tau: (np.stack([q[..., 0], q[..., 1] - q[..., 0]], -1), tau),
    ),
    (
        "sign of the elbow",
        "the elbow's angle and torque were counted the other way round than the shoulder's",
        "Give the elbow's angle and torque the factor -1.",
        lambda q, tau: (q * [1, -1], tau * [1, -1]),
    ),
    (
        "sign of a torque",
        "the sign of one joint's torque were wrong",
        "Give the torque of one joint the factor -1.",
        lambda q, tau: (q, tau * [1, -1]),
    ),
    (
        "order of the torques",
        "the torques of the two joints were exchanged",
        "Exchange the columns of the torques.",
        lambda q, tau: (q, tau[..., ::-1]),
    ),
    (
        "order of the joints",
        "shoulder and elbow were exchanged",
        "Exchange the columns of both, angles and torques; some programs list joints by alphabet.",
        lambda q, tau: (q[..., ::-1], tau[..., ::-1]),
    ),
    (
        "order of the angles",
        "the angles of the two joints were exchanged",
        "Exchange the columns of the angles.",
        lambda q, tau: (q[..., ::-1], tau),
    ),
    (
        "units of angle",
        "the angles were degrees",
        "Name the unit of the angles: deg.",
        lambda q, tau: (np.deg2rad(q), tau),
    ),
)


def _other_readings(pieces, width, fit) -> Iterator[Finding]:
    """Whether the equations hold better if angles or torques are read in another way."""
    best = None
    for kind, words, advice, read in _READINGS:
        if kind == "units of angle" and np.ptp(pieces.q, axis=1).max() < np.pi:
            continue
        again = _fit(_with(pieces, pieces.t, *read(pieces.q, pieces.tau)), width)
        if again and again.share < (best or fit).share and again.of("a")[0] > 0:
            best, told = again, (kind, words, advice)
    if best is None or best.share > 0.75 * fit.share or fit.share < 0.02:
        return
    kind, words, advice = told
    yield _finding(
        kind, "wrong" if best.share < 0.5 * fit.share else "doubtful",
        f"The equations leave {100 * fit.share:.1f} % of the torques over; they would leave "
        f"{100 * best.share:.1f} % if {words}.",
        "Nothing that is fitted to these columns describes the arm.", advice,
    )  # fmt: skip


def _torque_spikes(recording, pieces, width, fit) -> Iterator[Finding]:
    """Single torques that stand alone, and did not act on the arm: the equations leave them over.

    A torque that jumps for one sample may be a true one, as where a plan's velocity jumps, or where
    a joint turns back against its dry friction.
    """
    anywhere = _fit(pieces, width, [name for name in EVERY if name[:-1] != "F_c"])  # slow, too
    for joint in range(2):
        every = recording.tau[:, recording.motion, joint]
        angles = recording.q[:, recording.motion, joint]
        found = [(n, run, row) for run, tau in enumerate(every) for row, n in zip(*spikes(tau))]
        for size, run, row in sorted(found, reverse=True)[:3]:
            near = angles[run, max(row - 4, 0) : row + 5]
            if np.ptp(near) > 1.5 * abs(near[-1] - near[0]):  # it turns back
                continue
            one = np.zeros_like(recording.tau)
            one[run, recording.motion.start + row, joint] = size
            one = _pieces(_thinned(replace(recording, tau=one)), width)
            for model in filter(None, (fit, anywhere)):
                names, values = model.equations.names, np.nan_to_num(model.estimate.values)
                left = model.equations.torque[joint] - model.equations.regressor[joint] @ values
                spike = _averaged(one, names, width).torque[joint]
                seen = np.linalg.norm(spike) > 3 * model.estimate.noise[joint]
                if seen and 0.5 < abs(spike @ left) / (spike @ spike) < 2:
                    yield Finding(
                        "torque spike", "wrong", run, joint,
                        f"One torque is off by {size:.3g} N m.",
                        "The arm did not move as if it had acted, but the fit believes it.",
                        "Take this sample out of the file, and read it again.",
                        [recording.motion.start + row],
                    )  # fmt: skip
                    break


def _signs(pieces, fit, works) -> Iterator[Finding]:
    """The inertia of each joint as it alone tells it: a positive torque must accelerate.

    That is the mean of the mass matrix's entry, ``a + 2 b cos(q2)`` or ``d``.
    """
    names, torques, blur = fit.equations.names, fit.equations.torque, fit.equations.blur
    at = [names.index(name) for name in ("a", "b", "b_sin", "d")]
    for j in np.flatnonzero(works):
        regressor = fit.equations.regressor[j].copy()
        if j == 0:  # so that the first parameter is the mean entry
            regressor[:, at[1]] -= 2 * np.cos(pieces.q[..., 1]).mean() * regressor[:, at[0]]
            regressor[:, at[2]] += 2 * np.sin(pieces.q[..., 1]).mean() * regressor[:, at[0]]
        equations = Equations(names, (regressor,), (torques[j],), (blur[j],))
        try:
            alone = _Fit(equations, estimated(equations))
        except ValueError:
            continue
        inertia, error = alone.of("a" if j == 0 else "d")
        if alone.share > 0.5:
            continue
        if inertia < -4 * error:
            yield _finding(
                "sign of the torque", "wrong",
                f"A positive torque of the {JOINTS[j]} slows it down: its inertia would be "
                f"{inertia:.3g} kg m².",
                "Inertias come out negative.",
                "Give the torque of this joint the factor -1.", int(j),
            )  # fmt: skip
        elif inertia > 4 * error and not 1e-6 < inertia < 1e4:
            yield _finding(
                "units of torque", "wrong",
                f"The inertia of the {JOINTS[j]} would be {inertia:.3g} kg m².",
                "No arm of this kind exists.",
                "Check the units of time (ms?), angle (deg?) and torque (mN m, A?).", int(j),
            )  # fmt: skip


def _lag(pieces, width, least) -> Iterator[Finding]:
    """How much later the torque would have to be read to fit best; `least` is a logged sample.

    What a lag leaves over is proportional to the torque's derivative; a few rounds of Gauss and
    Newton find it.
    """
    margin, lag, error, now = MOST_LAG + 2, 0.0, np.inf, None
    if pieces.t.size < 2 * margin + width:
        return
    inner = slice(margin, -margin)

    def shifted(by):
        tau = interp1d(pieces.t, pieces.tau, axis=1)(pieces.t[inner] + by * pieces.step)
        return _with(pieces, pieces.t[inner] - pieces.t[margin], pieces.q[:, inner], tau)

    for _ in range(6):
        at, before, after = (_fit(shifted(lag + by), width) for by in (0, -1, 1))
        if not (at and before and after):
            return
        now = now or at
        slopes = [(y - x) / 2 for x, y in zip(before.equations.torque, after.equations.torque)]
        columns = tuple(
            np.concatenate([a, -slope[:, None]], 1)
            for a, slope in zip(at.equations.regressor, slopes)
        )
        names = (*at.equations.names, "lag")
        change, error = _Fit(
            at.equations, estimated(Equations(names, columns, at.equations.torque))
        ).of("lag")
        if not np.isfinite(change):
            return
        lag = float(np.clip(lag + change, -MOST_LAG, MOST_LAG))
        if abs(change) < 0.1 * least:
            break
    if abs(lag) < max(0.6 * least, 4 * error) or at.share > 0.9 * now.share:
        return
    which, step = "later" if lag > 0 else "earlier", 1000 * pieces.step
    yield _finding(
        "lag", "wrong" if at.share < 0.5 * now.share else "doubtful",
        f"The torque fits the motion best if it is read {step * abs(lag):.3g} ± "
        f"{2 * step * error:.2g} ms {which}; {100 * now.share:.1f} % of it are left over now, "
        f"{100 * at.share:.1f} % then.",
        "A torque that is logged late adds to the damping: inertia times delay times the square of "
        "the motion's frequency; an early one takes as much away.",
        "Look for a filter or a queue between the two columns, and shift one. Friction and "
        "backlash that the equations lack look alike: before you do, push the resting arm. Which "
        "column moves first?",
    )  # fmt: skip


def _pose(pieces, width, fit, names) -> Iterator[Finding]:
    """Weight and offsets that are not among the parameters, and zeros of the angles."""
    light = _fit(pieces, width, [name for name in EVERY if name not in POSE])
    heavy = np.zeros(2, bool)
    if light:
        explained = 1 - (fit.shares / light.shares) ** 2
        heavy = (explained > 0.5) & (light.shares**2 - fit.shares**2 > 0.002)
    if heavy.any() and not set(GRAVITY) <= set(names):
        parts = " and ".join(
            f"{100 * explained[j]:.0f} % of the {JOINTS[j]}'s" for j in np.flatnonzero(heavy)
        )
        yield _finding(
            "gravity", "wrong",
            f"The arm seems to hang: torques that only the pose explains make up {parts} rest.",
            "Without them inertias and frictions are wrong.",
            "Add `GRAVITY` to the names of the parameters, with the shoulder's angle counted from "
            "the vertical. A spring or a cable looks alike: these names do not hold it.",
        )  # fmt: skip
    zeros = [("g1", "g1_cos", ("g1_cos", "g2_cos"), "where it hangs")] if heavy.any() else []
    for cosine, sine, both, zero in (*zeros, ("b", "b_sin", ("b_sin",), "the upper arm's line")):
        joint, (angle, error) = "gb".index(cosine[0]), fit.angle(cosine, sine)
        right = _fit(pieces, width, [name for name in EVERY if name not in both])
        if right and abs(angle) > max(LEAST_ANGLE[joint], 4 * error):
            gain = right.share / fit.share  # what is left if the zero is right
            if gain > 1.03:
                yield _finding(
                    f"zero of the {JOINTS[joint]}",
                    "wrong" if gain > 1.1 and abs(angle) > 5 else "doubtful",
                    f"The {JOINTS[joint]}'s angle seems to be 0 at {-angle:.1f}° ± "
                    f"{2 * error:.1g}° from {zero}.",
                    "Sines and cosines of wrong angles make wrong inertias and weights.",
                    f"Add {angle:.1f}° to the {JOINTS[joint]}'s angles.", joint,
                )  # fmt: skip
    for joint, name in enumerate(OFFSETS):
        offset, error = fit.of(name)
        if name not in names and abs(offset) > max(4 * error, 0.05 * pieces.tau[..., joint].std()):
            yield _finding(
                "torque offset", "doubtful",
                f"The {JOINTS[joint]}'s torque has a constant of {offset:.3g} ± {2 * error:.1g} "
                "N m.",
                "Friction and weight take it up.", "Add `OFFSETS` to the names.", joint,
            )  # fmt: skip
