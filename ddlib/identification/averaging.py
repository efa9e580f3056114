"""What equations of averaged and of smoothed motion share: bumps, noise, where friction is sure.

Bumps are B-splines of degree 5, under which both sides of the equations of motion are averaged.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BSpline

from ddlib._check import number, shaped
from ddlib.identification.regression import SIGN_SPEED, SLOW
from ddlib.simulation import Recording

BY_SAMPLE = "Equations of single samples give no intervals: what smoothing takes away biases them."
_SURE = 0.95  # of a bump
_APART = 0.03  # s, between samples of which a velocity is made
_SHAKES = 8  # how often noise is added to readings, to see what it does to a regressor


def with_runs(recording: Recording) -> Recording:
    """The recording with an axis for runs, even if it is a single one."""
    single = recording.reference.q.ndim == 2
    return recording.mapped(lambda x: x[..., None, :, :]) if single else recording


def acting_time(recording: Recording, hold: float | None) -> tuple[float, float]:
    """When a logged torque begins to act, after its sample, and for how long, s."""
    if hold is not None:
        return 0.0, number("hold", hold, 0.0)
    period = recording.control_step or 0.0
    computing_time = (
        recording.computing_time
    )  # with one, a sample holds the torque of the reading before
    return computing_time - period if computing_time else 0.0, period


def bumps_over(t, width, length, orders=(0, 1, 2)) -> list[np.ndarray]:
    """B-splines inside a motion of `length` s and their first two derivatives, (bumps, time)."""
    knot = width / 6
    shape = BSpline.basis_element(knot * np.arange(7), extrapolate=False)
    first = knot * np.arange(int((length - width) / knot + 1e-9) + 1)
    place = t - first[:, None]
    return [np.nan_to_num(shape(place, order)) for order in orders]


def bumps_held(t, width, length, begin, hold) -> np.ndarray:
    """Mean of each bump while a sample's torque acts: its value in the middle misses ``hold^2``."""
    nodes, weights = np.polynomial.legendre.leggauss(3)  # exact for a B-spline of degree 5
    times = t + begin + hold * (1 + nodes[:, None]) / 2
    return sum(w / 2 * bumps_over(x, width, length, (0,))[0] for w, x in zip(weights, times))


def where_sign_is_sure(recording: Recording, names) -> np.ndarray:
    """Where friction has a sure sign, by the speed over all repetitions: (joint, run, time)."""
    q = recording.q
    speed = np.abs(five_point_velocity(q, recording.step, samples_apart(recording)))
    speed = np.moveaxis(speed.reshape(-1, *q.shape[-3:]).mean(0), -1, 0)
    least_speed = np.array([SLOW if f"F_c{j + 1}" in names else 0.0 for j in range(2)])
    return speed >= least_speed[:, None, None]


def kept_bumps(steady, bumps) -> np.ndarray:
    """Bumps (bump, time) in which friction's sign is sure (joint, run, time) nearly throughout.

    Where a joint turns back it may stick for a while, which no equation knows.
    """
    return steady @ bumps.T / bumps.sum(-1) > _SURE


def notes_on_slow_joints(used, names) -> tuple[str, ...]:
    """A word on each joint (joint, ...) of which nothing is kept, as it is slow."""
    return tuple(
        f"All equations of joint {j + 1} were left out: with F_c{j + 1} they ask for a joint that "
        f"moves on at {SLOW} rad/s or more. Without F_c{j + 1} they count."
        for j, keep in enumerate(used)
        if f"F_c{j + 1}" in names and not np.any(keep)
    )


def mean_sign(velocity) -> np.ndarray:
    """Mean sign of velocities (..., time, joint) from each sample to the next, straight between.

    The sign at a sample would be wrong by up to a period where a velocity changes it.
    """
    blurred_sign = np.clip(velocity / SIGN_SPEED, -1.0, 1.0)
    area = blurred_sign * (
        velocity - SIGN_SPEED * blurred_sign / 2
    )  # integral of the sign over the velocity
    change = np.diff(velocity, axis=-2)
    steady_speed = np.abs(change) < 1e-6 * SIGN_SPEED
    mean = np.where(
        steady_speed,
        blurred_sign[..., 1:, :],
        np.diff(area, axis=-2) / np.where(steady_speed, 1.0, change),
    )
    return np.concatenate([mean, blurred_sign[..., -1:, :]], -2)


def five_point_velocity(q, step, apart=1) -> np.ndarray:
    """Velocity by central differences of fourth order of samples `apart` (plain ones at ends)."""
    velocity = np.gradient(q, step, axis=-2)
    samples = q.shape[-2]
    for n in range(1, apart + 1):  # near the ends the differences are as wide as fits
        if samples <= 4 * n:
            break
        at = [q[..., 2 * n + k * n : samples - 2 * n + k * n, :] for k in (-2, -1, 1, 2)]
        inner = (8 * (at[2] - at[1]) - (at[3] - at[0])) / (12 * n * step)
        velocity[..., 2 * n : samples - 2 * n, :] = inner
    return velocity


def samples_apart(recording: Recording) -> int:
    """How far apart samples are that a velocity is made of: its noise must not hide a slow joint.

    One, or if the readings are coarse more, up to 30 ms.
    """
    q = recording.q.reshape(-1, *recording.q.shape[-3:])[0]
    noise = reading_noise(q[..., recording.motion, :]).max() / recording.step
    most = max(1, round(_APART / recording.step))
    return int(np.clip(np.ceil(noise / (SLOW / 3)), 1, most))


def regressor_blur(recording: Recording, regressor) -> tuple[np.ndarray, ...]:
    """``E' E`` by joint of the errors ``E`` that readings' noise makes in a regressor of angles.

    Noise like that of the readings is added to them, of the first repetition.
    """
    q = recording.q.reshape(-1, *recording.q.shape[-3:])[0]
    noise = reading_noise(q[..., recording.motion, :])
    plain, rng = regressor(q), np.random.default_rng(0)
    shaken = [regressor(q + noise * rng.normal(size=q.shape)) for _ in range(_SHAKES)]
    return tuple(
        np.mean([(x[j] - a).T @ (x[j] - a) for x in shaken], 0) for j, a in enumerate(plain)
    )


def reading_noise(q) -> np.ndarray:
    """Standard deviation of each joint's readings (run, time, joint), rad.

    From sixth differences, which see noise and hardly any motion; an encoder's step gives more.
    """
    if q.shape[-2] < 8:
        return np.zeros(q.shape[-1])
    rough = np.sqrt(np.mean(np.diff(q, 6, axis=-2) ** 2, (0, 1)) / 924)
    steps = [encoder_step(q[..., j]) or 0.0 for j in range(q.shape[-1])]
    rounding = 1e-12 * np.abs(q).max((0, 1))  # of sums: all that a joint at rest has
    return np.maximum.reduce([rough, np.array(steps) / np.sqrt(12), rounding])


def encoder_step(q) -> float | None:
    """The step of which all differences of readings ``(..., time)`` are multiples; or None."""
    gaps = np.abs(np.diff(shaped("q", q, "(..., time)"), axis=-1)).ravel()
    size = np.abs(q).max(initial=0.0)
    gaps = gaps[gaps > 1e-9 * size + 1e-15]
    if gaps.size < 10:
        return None
    step = gaps.min()
    counts = np.round(gaps / step)
    step = float((gaps * counts).sum() / (counts**2).sum())
    rough = np.abs(gaps / step - np.round(gaps / step)).max() > 0.1
    return None if rough or counts.max() > 1e6 else step
