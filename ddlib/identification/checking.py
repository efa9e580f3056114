"""Is a recording fit to be fitted? What its readings and the equations of motion show of it.

One set of equations is fitted to the recording read in many ways: with joints exchanged, with other
signs, in degrees. If one of them leaves much less of the torques over, it is told. Else the same
equations show a torque's scale, a geared motor, a lag, weight, wrong zeros and offsets.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.interpolate import interp1d
from scipy.optimize import minimize_scalar
from scipy.signal import savgol_filter

from ddlib._check import instance
from ddlib.identification.averaging import (
    acting_time,
    bumps_held,
    bumps_over,
    five_point_velocity,
    kept_bumps,
    samples_apart,
    where_sign_is_sure,
)
from ddlib.identification.equations import POSE, modulated
from ddlib.identification.regression import (
    FRICTION,
    GRAVITY,
    OFFSETS,
    RIGID,
    known_names,
    regressor_columns,
)
from ddlib.logs.findings import JOINTS, SEVERITIES, Check, Finding
from ddlib.logs.readings import at_rest, readings, spikes, steady
from ddlib.simulation import Recording
from ddlib.trajectories import Trajectory

DRY = ("F_c1", "F_c2")
EVERY = (*RIGID, "rotor", "b_sin", *POSE, *FRICTION, *OFFSETS)
"""All parameters: of angles whose zeros may be anywhere, and an elbow with a geared motor."""

SAMPLES = 60  # of a bump, up to twice as many: more tell a check nothing
LONGEST = 24  # bumps' widths in a piece of a run
MOST_LAG = 8  # samples
MOST_LOG = 3.0  # of the ratio of two torques' scales: 20 times
SURE = 8.0  # logarithm of a likelihood ratio: four standard deviations
LEAST_ANGLE = (2.0, 4.0)  # degrees of a zero that matter: sines, and cosines


def check_recording(recording: Recording, names: Sequence[str] = RIGID + FRICTION) -> Check:
    """What a recording shows before anything is fitted to it, the worst first.

    Single readings show wrong units, wraps, spikes, drop-outs and values that are held,
    saturation, joints that rest or have no torque, and torques that look like a command. The
    equations of motion show wrong signs, units and scales, exchanged joints, a lag, a geared motor,
    angles that are counted otherwise or from another zero, and weight and offsets that are not
    among the parameters. What the motion tells of each parameter, `least_squares` says.

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
    pieces, width = _pieces(recording)
    resting = at_rest(np.concatenate([*(pieces.q - pieces.q[:, :1])]))
    works = [not steady(pieces.tau[..., j].ravel()) for j in range(2)]
    both = all(works) and not resting.any()
    if resting.all() or not any(works):
        return
    if width < 12 or pieces.q[..., 0].size < 4 * width:
        yield _finding(
            "too short", "note", "There are too few samples to compare torque and motion.",
            "Sign, lag and units of the torque are not checked.", "Record longer motions.",
        )  # fmt: skip
        return
    bumps = _bumps(pieces, width)
    model = _model(pieces, bumps)
    if not model:
        return
    scaled = model.best(partial(_smaller_elbow, pieces.tau), MOST_LOG)[2] if both else model
    found = [*_other_reading(pieces, bumps, model.fit, scaled.fit.share)] if both else []
    found = found or [*_sizes(scaled if scaled.fit.share < 0.8 * model.fit.share else model, works)]
    yield from found
    if not found:
        heavy = _hangs(model)
        model, gains = _explained(model, heavy.any(), both)
        yield from _constants(model, gains, pieces.tau, heavy, names)
        yield from _torque_spikes(recording, model, pieces, bumps)
        if both:
            yield from _lag(model, pieces, width, recording.step / pieces.step)


def _with(recording, t, q, tau) -> Recording:
    """A recording of the motion alone, of other angles and torques."""
    none = np.full_like(q, np.nan)
    zero = Trajectory(*(np.zeros_like(q),) * 3)
    return Recording(t, zero, q, tau, none, none, none, control_step=recording.control_step,
                     computing_time=recording.computing_time)  # fmt: skip


def _pieces(recording) -> tuple[Recording, int]:
    """The motion without whole turns, and how many samples a bump has.

    If these are many, it is made of means of a few; if a run has many bumps, of pieces.
    """
    q, tau = (x[:, recording.motion] for x in (np.unwrap(recording.q, axis=1), recording.tau))
    few = max(_width(q) // SAMPLES, 1)
    length = q.shape[1] // few
    q, tau = (x[:, : length * few].reshape(-1, length, few, 2).mean(2) for x in (q, tau))
    width = _width(q)
    parts = max(round(length / (LONGEST * width)), 1) if width else 1
    length = length // parts
    q, tau = (x[:, : length * parts].reshape(-1, length, 2) for x in (q, tau))
    return _with(recording, few * recording.step * np.arange(length), q, tau), width


def _width(q) -> int:
    """Samples of a bump: two thirds of the motion's own period, a multiple of six."""
    samples = q.shape[1]
    smooth = savgol_filter(q, min(15, samples // 2 * 2 - 1), 2, axis=1) if samples > 3 else q
    speed = np.sum(np.diff(smooth, axis=1) ** 2, (0, 1))
    size = np.sum((smooth - smooth.mean(1, keepdims=True)) ** 2, (0, 1))
    moving = speed > 1e-12 * size.max() if size.max() else np.zeros(2, bool)
    if not moving.any():
        return 0
    period = 2 * np.pi * np.sqrt(size[moving] / speed[moving]).min()
    return int(min(max(0.67 * period, 18), samples // 4) // 6) * 6


def _bumps(pieces, width) -> tuple:
    """Bumps of so many samples and derivatives, as torques act, and from sample to sample."""
    begin, end = pieces.span
    place = pieces.t - begin, width * pieces.step, end - begin
    later = bumps_held(*place, *acting_time(pieces, None))
    return bumps_over(*place), later, bumps_held(*place, 0.0, pieces.step)


class _Fit(NamedTuple):
    """What equations tell, and what they leave of the torques."""

    values: dict[str, float]  #: Of parameters.
    errors: dict[str, float]  #: Their standard errors: large if the motion does not tell them.
    shares: np.ndarray  #: Left of each joint's torque, by root mean squares; NaN: it has none.
    share: float  #: Their geometric mean.
    left: float  #: The logarithm of how unlikely it is.


@dataclass(frozen=True)
class _Model:
    """Equations of a motion under bumps, against which any torques can be held.

    Their torques' noise is independent. How, depends on the motion alone, not on the torques.
    """

    names: Sequence[str]
    parts: list  #: Of each joint's regressor: an orthogonal matrix, and a triangular one.
    averaged: Callable  #: From torques (pieces, time, 2) to each joint's under the bumps.
    tau: np.ndarray
    without: frozenset = frozenset({"rotor"})  #: Names of parameters that are 0.

    @cached_property
    def torques(self) -> tuple[np.ndarray, ...]:
        """Of each joint, under the bumps."""
        return self.averaged(self.tau)

    @cached_property
    def fit(self) -> _Fit:
        """The equations solved; joints count by the inverse of what they leave over."""
        names = [name for name in self.names if name not in self.without]
        at = [self.names.index(name) for name in names]
        size = np.array([np.sqrt(np.mean(y**2)) for y in self.torques])
        used = np.flatnonzero(size)
        count = np.array([self.torques[j].size for j in used])
        rows = [self.parts[j][1][:, at] / size[j] for j in used]
        seen = [self.parts[j][0].T @ self.torques[j] / size[j] for j in used]
        rest = [n - y @ y for n, y in zip(count, seen)]
        scale = np.linalg.norm(np.concatenate(rows), axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        left = np.ones(used.size)
        for _ in range(4):
            a, y = (np.concatenate([x / n for x, n in zip(xs, left)]) for xs in (rows, seen))
            values = np.linalg.lstsq(a / scale, y, rcond=1e-7)[0] / scale
            squares = [np.sum((y - a @ values) ** 2) + z for a, y, z in zip(rows, seen, rest)]
            left = np.sqrt(np.maximum(squares, 0) / np.maximum(count - len(at) / 2, 1)) + 1e-9
        squared = (a / scale).T @ (a / scale)
        squared += 1e-12 * np.trace(squared) * np.eye(len(at))
        errors = np.sqrt(np.diag(np.linalg.inv(squared))) / scale
        shares = np.full(2, np.nan)
        shares[used] = left
        return _Fit(dict(zip(names, values)), dict(zip(names, errors)), shares,
                    np.exp(np.log(left).mean()), count @ np.log(left))  # fmt: skip

    def told(self, name) -> tuple[float, float]:
        """A parameter and its standard error."""
        return self.fit.values.get(name, 0.0), self.fit.errors.get(name, 0.0)

    def unexplained(self, joint) -> np.ndarray:
        """What is left of a joint's torque under each bump."""
        values = [self.fit.values.get(name, 0.0) for name in self.names]
        q, r = self.parts[joint]
        return self.torques[joint] - q @ (r @ values)

    def best(self, torque, most) -> tuple[float, float, _Model]:
        """The number up to `most` whose `torque` fits best, its standard error, and that model."""

        def left(number):
            return replace(self, tau=torque(number)).fit.left

        near = most / 25  # there may be several valleys
        deepest = min(near * np.arange(-24, 25), key=left)
        bounds = deepest - near, deepest + near
        number = minimize_scalar(left, bounds=bounds, method="bounded").x
        bend = (left(number - near) + left(number + near) - 2 * left(number)) / near**2
        error = bend**-0.5 if bend > 0 else np.inf
        return number, error, replace(self, tau=torque(number))


def _model(pieces, bumps, dry=True) -> _Model | None:
    """Equations with dry friction, or without if a joint is too slow for a sure sign of it."""
    names = EVERY if dry else tuple(name for name in EVERY if name not in DRY)
    over, later, after = bumps
    kept = kept_bumps(where_sign_is_sure(pieces, names), over[0])
    if dry and kept.sum((1, 2)).min() <= len(names):
        return _model(pieces, bumps, dry=False)
    whiten = [
        [np.linalg.inv(np.linalg.cholesky(later[k] @ later[k].T)) for k in runs] for runs in kept
    ]

    def white(series) -> tuple[np.ndarray, ...]:
        return tuple(
            np.concatenate([w @ x[run, k] for run, (w, k) in enumerate(zip(*parts))])
            for x, *parts in zip(series, whiten, kept)
        )

    def averaged(tau) -> tuple[np.ndarray, ...]:
        return white(np.moveaxis(tau, -1, 0) @ later.T)

    if kept.sum((1, 2)).min() <= len(names):
        return None
    velocity = five_point_velocity(pieces.q, pieces.step, samples_apart(pieces))
    shoulder, elbow = modulated(over, after, velocity, pieces.q)
    # "a" is the mean inertia at the shoulder, and "d" the elbow's with its rotor
    cosine, sine = (2 * f(pieces.q[..., 1]).mean() for f in (np.cos, np.sin))
    shoulder["b"] = shoulder["b"] - cosine * shoulder["a"]
    shoulder["b_sin"] = shoulder["b_sin"] + sine * shoulder["a"]
    shoulder["rotor"], elbow["rotor"] = -shoulder["d"], -shoulder["a"]
    rows = [regressor_columns(row, names, shoulder["a"]) for row in (shoulder, elbow)]
    parts = [np.linalg.qr(a) for a in white(rows)]
    return _Model(names, parts, averaged, pieces.tau)


_SIGNS = {  # of the elbow's angle and of both torques: what is the wrong way round
    (1, 1, 1): None,
    (1, 1, -1): ("a torque", "the elbow's torque"),
    (1, -1, 1): ("a torque", "the shoulder's torque"),
    (1, -1, -1): ("a torque", "the torque of both joints"),
    (-1, 1, 1): ("an angle", "the elbow's angle"),
    (-1, -1, -1): ("an angle", "the shoulder's angle"),
    (-1, 1, -1): ("the elbow", "the elbow's angle and torque"),
    (-1, -1, 1): ("the shoulder", "the shoulder's angle and torque"),
}
_ORDERS = {  # of the angles and of the torques
    (-1, -1): ("joints", "shoulder and elbow", "both, angles and torques; some programs list "
               "joints by alphabet"),
    (-1, 1): ("angles", "the angles of shoulder and elbow", "the angles"),
    (1, -1): ("torques", "the torques of shoulder and elbow", "the torques"),
}  # fmt: skip
_ELBOWS = {1: np.eye(2), -1: np.diag([1, -1]), 0: np.array([[1, -1], [0, 1]])}  # 0: absolute


def _other_reading(pieces, bumps, fit, scaled) -> Iterator[Finding]:
    """What was read wrongly, if the equations leave much less over when it is read otherwise.

    Each further fault must take away a tenth of what is left, and more than another scale of the
    elbow's torque does, which leaves the share `scaled`.
    """
    least, told = min(0.8 * fit.share, 1.1 * scaled), ()
    units = [(1.0, np.pi / 180)[: 1 + far] for far in np.ptp(pieces.q, axis=1).max(0) > np.pi]
    for unit, order, elbow in product([*product(*units)], (1, -1), _ELBOWS):
        q = (pieces.q * unit)[..., ::order] @ _ELBOWS[elbow]
        model = _model(_with(pieces, pieces.t, q, pieces.tau), bumps)
        for exchanged, sign in product((1, -1), (1, -1) if model else ()):
            again = replace(model, tau=pieces.tau[..., ::exchanged] * [1, sign]).fit
            shoulder, elbow_alone = again.values["a"], again.values["d"]
            signs = np.sign(shoulder) * np.array([1, sign])
            faults = [*_faults(unit, order, elbow, exchanged, signs)]
            if shoulder * elbow_alone > 0 and again.share * 1.1 ** len(faults) < least:
                least, told, share = again.share * 1.1 ** len(faults), faults, again.share
    for kind, words, advice in told if fit.shares.max() > 0.02 else ():
        yield _finding(
            kind, "wrong" if share < 0.5 * fit.share else "doubtful",
            f"The equations leave {100 * fit.share:.1f} % of the torques over; they would leave "
            f"{100 * share:.1f} % if {' and '.join(words for _, words, _ in told)}.",
            "Nothing that is fitted to these columns describes the arm.", advice,
        )  # fmt: skip


def _faults(unit, order, elbow, exchanged, signs) -> Iterator[tuple[str, str, str]]:
    """Kind, words and advice of each fault that a reading mends."""
    joints = [name for name, factor in zip(JOINTS, unit) if factor < 1]
    if joints:
        which = " and ".join(joints)
        yield "units of angle", f"angles ({which}) were degrees", "Name the unit of these: deg."
    if elbow == 0:
        yield (
            "elbow angle",
            "the elbow's angle were counted from a fixed direction, not from the upper arm",
            "Read the log with absolute_elbow=True, or take q2 - q1.",
        )
    if (order, exchanged) in _ORDERS:
        kind, what, columns = _ORDERS[order, exchanged]
        yield f"order of the {kind}", f"{what} were exchanged", f"Exchange the columns: {columns}."
    if wrong := _SIGNS[(elbow or 1, *signs)]:
        kind, what = wrong
        yield f"sign of {kind}", f"{what} had the other sign", f"Give {what} the factor -1."


def _sizes(model, works) -> Iterator[Finding]:
    """The inertia at each joint: a positive torque must accelerate, and arms have a size."""
    for joint, name in enumerate("ad"):
        inertia, error = model.told(name)
        if not works[joint] or not abs(inertia) > 4 * error or 1e-6 < inertia < 1e4:
            continue
        seen = f"The inertia of the {JOINTS[joint]} would be {inertia:.3g} kg m²"
        if inertia < 0:
            yield _finding(
                "sign of a torque", "wrong", f"{seen}: a positive torque slows it down.",
                "Inertias come out negative.", "Give the torque of this joint the factor -1.",
                joint,
            )  # fmt: skip
        else:
            yield _finding(
                "units of torque", "wrong", f"{seen}.", "No arm of this kind exists.",
                "Check the units of time (ms?), angle (deg?) and torque (mN m, A?).", joint,
            )  # fmt: skip


def _torque_spikes(recording, model, pieces, bumps) -> Iterator[Finding]:
    """Single torques that stand alone, and did not act on the arm: the equations leave them over.

    A torque that jumps for one sample may be a true one, as where a plan's velocity jumps, or where
    a joint turns back against its dry friction.
    """
    anywhere = _model(pieces, bumps, dry=False)  # where a joint is slow, too
    models = [model, replace(anywhere, without=model.without)] if anywhere else [model]
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
            one = _pieces(replace(recording, tau=one))[0].tau
            for model in models:
                left, spike = model.unexplained(joint), model.averaged(one)[joint]
                seen = np.linalg.norm(spike) > 3 * np.sqrt(np.mean(left**2))
                if seen and 0.5 < abs(spike @ left) / (spike @ spike) < 2:
                    yield Finding(
                        "torque spike", "wrong", run, joint,
                        f"One torque is off by {size:.3g} N m.",
                        "The arm did not move as if it had acted, but the fit believes it.",
                        "Take this sample out of the file, and read it again.",
                        [recording.motion.start + row],
                    )  # fmt: skip
                    break


_ZEROS = ("g1", "g1_cos", "where it hangs"), ("b", "b_sin", "the upper arm's line")
_EXTRA = {
    "zero of the shoulder": {"g1_cos", "g2_cos"},
    "zero of the elbow": {"b_sin"},
    "geared motor": {"rotor"},
}


def _hangs(model) -> np.ndarray:
    """At which joints torques that only the pose explains are most of the rest."""
    fit, light = model.fit.shares, replace(model, without=model.without.union(POSE)).fit.shares
    return (fit**2 < 0.5 * light**2) & (light**2 - fit**2 > 0.002)


def _explained(model, hangs, both) -> tuple[_Model, dict[str, float]]:
    """The model with what it needs more, and how much less that leaves, by kind.

    What explains most comes first; then the others are asked again.
    """
    model, gains = replace(model, without=frozenset().union(*_EXTRA.values())), {}
    while True:
        options = {
            kind: replace(model, without=model.without - names)
            for kind, names in _EXTRA.items() if hangs or "g1_cos" not in names
        }  # fmt: skip
        if both:
            factors = partial(_smaller_elbow, model.tau)
            options["scale of a torque"] = model.best(factors, MOST_LOG)[2]
        kind = min(options, key=lambda kind: options[kind].fit.left)
        gain = model.fit.share / options[kind].fit.share
        if kind in gains or gain < 1.03 or model.fit.left - options[kind].fit.left < SURE:
            return model, gains
        model, gains[kind] = options[kind], gain


def _smaller_elbow(tau, log) -> np.ndarray:
    """Torques, with the elbow's by another factor."""
    return tau * [1, np.exp(-log)]


def _constants(model, gains, tau, heavy, names) -> Iterator[Finding]:
    """What the model says: weight, a scale, a rotor, zeros of the angles, and offsets."""
    if heavy.any() and not set(GRAVITY) <= set(names):
        which = " and ".join(f"the {name}'s" for name, much in zip(JOINTS, heavy) if much)
        yield _finding(
            "gravity", "wrong",
            f"The arm seems to hang: torques that only the pose explains are most of {which} rest.",
            "Without them inertias and frictions are wrong.",
            "Add `GRAVITY` to the names of the parameters, with the shoulder's angle counted from "
            "the vertical. A spring or a cable looks alike: these names do not hold it.",
        )  # fmt: skip
    severity = {kind: "wrong" if gain > 1.1 else "doubtful" for kind, gain in gains.items()}
    ratio = tau[..., 1].std() / model.tau[..., 1].std()
    if abs(np.log(ratio)) > 0.08:
        yield _finding(
            "scale of a torque", "wrong" if gains["scale of a torque"] > 1.25 else "doubtful",
            f"Beside the shoulder's torque the elbow's seems to be {ratio:.3g} times too large.",
            "What both joints feel, like b and d, comes out between two values.",
            "Compare the factors of both torques (N m/A, gears).",
        )  # fmt: skip
    (rotor, error), (own, _) = model.told("rotor"), model.told("d")
    if "geared motor" in gains and rotor > 0.05 * own:
        yield _finding(
            "geared motor", "doubtful",
            f"The elbow's torque tells {own:.3g} kg m² for d, the shoulder's {own - rotor:.3g}: as "
            f"if a motor with a gear added {rotor:.2g} ± {2 * error:.1g} at the elbow alone.",
            "These equations have one d for both joints; what is fitted lies between.",
            "Take a tool that knows a rotor's inertia, like figaroh or FloBaRoID.", 1,
        )  # fmt: skip
    for joint, (cosine, sine, zero) in enumerate(_ZEROS):
        if joint == 0 and not heavy.any():
            continue
        (x, dx), (y, dy) = model.told(cosine), model.told(sine)
        angle = np.degrees(np.arctan2(y, x))
        error = np.degrees(np.hypot(x * dy, y * dx) / (x**2 + y**2 + 1e-300))
        kind = f"zero of the {JOINTS[joint]}"
        opposite = bool(abs(angle) > 175 and x < -8 * dx)
        if opposite or (kind in gains and abs(angle) > max(LEAST_ANGLE[joint], 4 * error)):
            sure = not opposite and abs(angle) > 5
            yield _finding(
                kind, severity[kind] if sure else "doubtful",
                f"The {JOINTS[joint]}'s angle seems to be 0 at {-angle:.1f}° ± "
                f"{2 * error:.1g}° from {zero}.",
                "Sines and cosines of wrong angles make wrong inertias and weights.",
                f"Add {angle:.1f}° to the {JOINTS[joint]}'s angles."
                + (joint == 0 and opposite) * " Or the arm stands upright, or the torque's sign is "
                "the other.", joint,
            )  # fmt: skip
    for joint, name in enumerate(OFFSETS):
        offset, error = model.told(name)
        if name not in names and abs(offset) > max(4 * error, 0.05 * model.tau[..., joint].std()):
            yield _finding(
                "torque offset", "doubtful",
                f"The {JOINTS[joint]}'s torque has a constant of {offset:.3g} ± {2 * error:.1g} "
                "N m.",
                "Friction and weight take it up.", "Add `OFFSETS` to the names.", joint,
            )  # fmt: skip


def _lag(model, pieces, width, least) -> Iterator[Finding]:
    """How much later the torque would have to be read to fit best; `least` is a logged sample."""
    margin, step = MOST_LAG + 2, pieces.step
    if pieces.t.size < 2 * margin + width:
        return
    inner = slice(margin, -margin)
    t, torque = pieces.t[inner], interp1d(pieces.t, model.tau, axis=1)

    def shifted(by):
        return torque(t + by * step)

    pieces = _with(pieces, t - t[0], pieces.q[:, inner], shifted(0))
    now = _model(pieces, _bumps(pieces, width))
    if not now:
        return
    lag, error, then = replace(now, without=model.without).best(shifted, MOST_LAG)
    now, then = now.fit, then.fit
    if abs(lag) < 0.6 * least or then.share > 0.9 * now.share or now.left - then.left < SURE:
        return
    which, step = "later" if lag > 0 else "earlier", 1000 * step
    yield _finding(
        "lag", "wrong" if then.share < 0.5 * now.share else "doubtful",
        f"The torque fits the motion best if it is read {step * abs(lag):.3g} ± "
        f"{2 * step * error:.2g} ms {which}; {100 * now.share:.1f} % of it are left over now, "
        f"{100 * then.share:.1f} % then.",
        "A torque that is logged late adds to the damping: inertia times delay times the square of "
        "the motion's frequency; an early one takes as much away.",
        "Look for a filter or a queue between the two columns, and shift one. Friction that the "
        "equations lack looks alike: push the resting arm. Which column moves first?",
    )  # fmt: skip
