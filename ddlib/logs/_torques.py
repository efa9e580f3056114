"""Findings on a torque column: none at all, noise, or a command in place of a measurement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.signal import savgol_filter

from ddlib.logs._readings import unwrapped, without_gaps
from ddlib.logs._stamps import usual_step
from ddlib.logs.findings import JOINTS, Finding, finding
from ddlib.logs.log import LoggedRun

ALIKE = 0.45
"""Correlation of fast changes from which a torque counts as a multiple of the measured velocity."""


def at_rest(run: LoggedRun) -> np.ndarray:
    """Which joints do not move, but for a noise of their reading, (2,)."""
    ranges = np.nanpercentile(run.q, 99.5, axis=0) - np.nanpercentile(run.q, 0.5, axis=0)
    return (ranges < 1e-3) | (ranges < 0.005 * ranges.max())


def weak(run: LoggedRun, j: int) -> bool:
    """Whether a joint's torque is small beside the other's, and noise a third of it or more."""
    tau, other = run.tau[:, j], np.nanstd(run.tau[:, 1 - j])
    tau = tau[np.isfinite(tau)]
    if tau.size < 12 or not tau.std() < 0.3 * other or steady(tau):
        return False
    # second differences of white noise have a median of 1.65 times its deviation
    return bool(np.median(np.abs(np.diff(tau, 2))) > 0.5 * tau.std())


def _moved(q):
    """How far each joint moves, in rad, without the rounding of a computation, (2,)."""
    return np.round(np.nanmax(q, axis=0) - np.nanmin(q, axis=0), 9)


def steady(x) -> bool:
    """Whether values are one value, but for the rounding of a computation."""
    x = x[np.isfinite(x)]
    return bool(np.ptp(x) <= 1e-9 * np.abs(x).max()) if x.size else True


def at_work(k: int, run: LoggedRun) -> Iterator[Finding]:
    """Joints of run number `k` that rest, or whose torque says nothing."""
    rest = at_rest(run)
    if rest.all():
        yield finding(
            run, "at rest", "wrong", (k, None), [],
            f"No joint moves: the angles stay within {_moved(run.q).max():.3g} rad.",
            "No inertia and no friction can be told from this run, of an arm that hangs only the "
            "torque of its weight in this pose.",
            "Leave the run out, unless it is one of many poses of an arm that hangs.",
        )  # fmt: skip
    for j in range(2):
        if rest[j] and not rest.all():
            yield finding(
                run, "at rest", "doubtful", (k, j), [],
                f"The {JOINTS[j]} moves by {_moved(run.q)[j]:.3g} rad only.",
                "Its own inertia, the coupling and its friction cannot be told one by one, only "
                "the inertia of both links together.",
                "Add runs in which it moves, or fit the sum alone.",
            )  # fmt: skip
        tau = run.tau[:, j]
        tau = tau[np.isfinite(tau)]
        if tau.size < 12:
            continue
        other = np.nanstd(run.tau[:, 1 - j])
        if steady(tau):
            both = steady(run.tau[:, 1 - j])
            yield finding(
                run, "no torque", "wrong" if both else "doubtful", (k, j), [],
                f"The {JOINTS[j]}'s torque is {tau[0]:.4g} N m throughout.",
                "A network has nothing to learn there. Equations of a joint without a motor hold, "
                "but weights by what they leave over can run away, and those of a motor whose "
                "torque was not logged do not hold.",
                "If the joint has no motor, keep its equations with a noise that you set; else "
                "leave them out.",
            )  # fmt: skip
        elif weak(run, j):
            yield finding(
                run, "little torque", "doubtful", (k, j), [],
                f"The {JOINTS[j]}'s torque varies by {tau.std():.2g} N m, where the other's varies "
                f"by {other:.2g} N m, and is noisy.",
                "Such a run tells the joint's friction and its coupling, not its own inertia.",
                "Add runs in which this joint is driven.",
            )  # fmt: skip


def fast(x, width: int = 7) -> np.ndarray:
    """What a parabola through `width` samples leaves over: noise and steps of a quantiser."""
    return x - savgol_filter(x, width, 2)


def follows_velocity(run: LoggedRun, j: int) -> tuple[float, float]:
    """How the fast changes of a torque go with those of velocity and angle: two correlations.

    The velocity is that of the log, from each sample to the next, up to two samples early or late.
    Those of a measured torque go with neither: an arm's inertia leaves none of them in the angle.
    """
    t, q, tau = run.t, run.q[:, j], run.tau[:, j]
    good = np.isfinite(q) & np.isfinite(tau) & np.concatenate([[True], np.diff(t) > 0])
    if good.sum() < 300 or np.nanstd(tau) == 0:
        return 0.0, 0.0
    q, tau, t = unwrapped(without_gaps(q[good])), tau[good], t[good]
    step = usual_step(t)
    velocity = fast(np.diff(q) / np.maximum(np.diff(t), 0.3 * step))
    angle, torque = fast(q)[1:], fast(tau)[1:]
    blocks = max(2, min(20, velocity.size // 40))
    torques = np.array_split(torque[2:-2], blocks)
    # smooth signals leave a smooth rest, which goes with anything
    rough = np.median([x[1:] @ x[:-1] / (x @ x + 1e-300) for x in torques]) < 0.5
    if not rough or not velocity.std() or not angle.std():
        return 0.0, 0.0
    best = [0.0, 0.0]
    for late in range(-2, 3):
        inside = slice(2 - late, velocity.size - 2 - late)
        for n, x in enumerate((velocity, angle)):
            pairs = zip(torques, np.array_split(x[inside], blocks))
            # no start and no stop decides: the median over stretches of time
            c = float(np.median([_correlation(*pair) for pair in pairs]))
            best[n] = c if abs(c) > abs(best[n]) else best[n]
    return best[0], best[1]


def _correlation(x, y) -> float:
    """Correlation of two series of mean about 0; 0 if one of them is 0."""
    size = np.sqrt((x @ x) * (y @ y))
    return float(x @ y / size) if size else 0.0


def comes_in_steps(tau) -> float:
    """The step of a quantised torque, N m; 0 if its values are continuous."""
    tau = tau[np.isfinite(tau)]
    values = np.unique(tau)
    if values.size < 5 or values.size > 0.5 * tau.size:
        return 0.0
    gaps = np.diff(values)
    step = float(np.percentile(gaps, 10))
    return step if np.mean(np.abs(gaps / step - np.round(gaps / step)) < 0.1) > 0.9 else 0.0


def round_limit(tau) -> float:
    """The largest torque either way, if it is a round number of N m; else 0."""
    tau = tau[np.isfinite(tau)]
    if not tau.size:
        return 0.0
    high = float(np.abs(tau).max())
    # a multiple of 0.5 to seven digits: chance hits one in a hundred thousand
    fits = high > 0.4 and abs(2 * high - round(2 * high)) < 1e-6 * high
    return high if fits and np.unique(tau).size > 20 else 0.0


def commands(runs: Sequence[LoggedRun]) -> Iterator[Finding]:
    """Torques that look like what a controller asked for, not like what a sensor measured."""
    steps = np.array([[comes_in_steps(run.tau[:, j]) for j in range(2)] for run in runs])
    in_steps = steps[steps > 0]
    for k, run in enumerate(runs):
        for j in range(2):
            tau = run.tau[:, j]
            if run.t.size < 100 or np.nanstd(tau) == 0:
                continue
            signs = []
            velocity, angle = follows_velocity(run, j)
            if abs(velocity) > ALIKE and abs(velocity) > 0.9 * abs(angle):
                signs.append(
                    f"its fast changes go with those of the measured velocity ({velocity:+.2f})"
                )
            if in_steps.size and not steps[k, j] and np.unique(tau).size > 100:
                signs.append(
                    f"its values are continuous, where {in_steps.size} others come in steps of "
                    f"{np.median(in_steps):.2g} N m"
                )
            limit = round_limit(tau)
            if limit and not steps[k, j]:
                signs.append(f"it ends at exactly {limit:g} N m")
            if not signs or (len(signs) == 1 and "ends at" in signs[0]):
                continue
            yield finding(
                run, "command", "wrong" if len(signs) > 1 else "doubtful", (k, j), [],
                f"The {JOINTS[j]}'s torque looks like a command: {' and '.join(signs)}.",
                "What the motor gave may differ by half; then inertias and friction are those of "
                "the command.",
                "Log the measured current, or leave these runs out of a fit. A fast drive on the "
                "same encoder looks alike: then all is well.",
            )  # fmt: skip
