"""From recordings to equations for identification: differences, smoothing, modulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import BSpline
from scipy.signal import savgol_filter

from ddlib._check import finite_array, integer, number
from ddlib.control import Controller
from ddlib.dynamics import Arm
from ddlib.effects import Effects, EncoderZero, Quantisation
from ddlib.identification.regression import (
    FRICTION,
    RIGID,
    SIGN_SPEED,
    SLOW,
    Equations,
    _columns,
    from_states,
)
from ddlib.logs.checking import warn_of_log
from ddlib.simulation import Recording, record

_BY_SAMPLE = "Equations of single samples give no intervals: what smoothing takes away biases them."
_SHAKES = 8  # how often noise is added to readings, to see what it does to a regressor


def by_differences(recording: Recording, names: Sequence[str] = RIGID + FRICTION) -> Equations:
    """Equations with velocity and acceleration from differences of neighbouring samples."""
    return by_smoothing(recording, 3, names)  # parabolas through three samples


def by_smoothing(
    recording: Recording,
    width: int,
    names: Sequence[str] = RIGID + FRICTION,
    smooth_torque: bool = False,
) -> Equations:
    """Equations with the derivatives of parabolas in windows (Savitzky & Golay 1964)."""
    if integer("width", width, 3) % 2 == 0:
        raise ValueError(f"width must be an odd number of samples, got {width}")
    if smooth_torque:
        recording = replace(recording, tau=savgol_filter(recording.tau, width, 2, axis=-2))
    step = recording.step
    velocity, acceleration = (
        savgol_filter(recording.q, width, 2, order, step, axis=-2) for order in (1, 2)
    )
    return _sampled(recording, velocity, acceleration, names, width // 2)


def by_modulation(
    recording: Recording,
    names: Sequence[str] = RIGID + FRICTION,
    width: float = 0.6,
    hold: float | None = None,
) -> Equations:
    """Equations of motion averaged under smooth bumps, so that no acceleration is needed.

    Both sides are multiplied by a bump ``w(t)`` (a B-spline of degree 5) and integrated (Shinbrot
    1957). Integration by parts moves the derivatives from the measured position to the bump:
    ``int w qdd dt = int w'' q dt``. Leading axes before those of the reference are repetitions.

    Parameters
    ----------
    names : sequence of str
        Parameters, from `RIGID`, `GRAVITY` and `FRICTION`.
    width : float
        Width of a bump, s: 12 samples or more, and no longer than the motion; cut to a multiple of
        six samples. Narrow bumps let quantisation through, wide ones lose detail.
    hold : float, optional
        Time for which a logged torque acts, s, from its sample on: the shorter of the log's step
        and the controller's period. Default: as the recording says, its computing time included.
    """
    warn_of_log(recording)
    begin, end = recording.span
    shortest, tiny = 12 * recording.step, 1e-6 * recording.step
    if end - begin < shortest - tiny:
        raise ValueError(f"recording must have 12 samples of motion or more, got {end - begin:g} s")
    if not shortest - tiny <= number("width", width) <= end - begin + tiny:
        raise ValueError(
            f"width must lie in [{shortest:g}, {end - begin:g}], got {width:g} s: a bump has "
            "12 samples or more, and is no longer than the motion"
        )
    width = int((width + tiny) / (6 * recording.step)) * 6 * recording.step
    if hold is None and recording.control_step is None:
        raise ValueError("hold must be given, as the recording has no control_step; got None")
    acts, recording = _acting(recording, hold), _in_runs(recording)
    place = recording.t - begin, width, end - begin
    bumps, later, after = _bumps(*place), _held(*place, *acts), _held(*place, 0.0, recording.step)
    steady = _steady(recording, names) @ bumps[0].T / bumps[0].sum(-1) > 0.9
    torque = np.moveaxis(recording.tau, -1, 0) @ later.T
    # bumps overlap: the inverse Cholesky factor makes their torque noise independent
    whiten = [
        [np.linalg.inv(np.linalg.cholesky(later[k] @ later[k].T)) for k in keeps]
        for keeps in steady
    ]

    def regressor(q) -> tuple[np.ndarray, ...]:
        rows = _modulated(bumps, after, q, recording.step)
        found = []
        for row, keeps, factors in zip(rows, steady, whiten):
            a = _columns(row, names, np.empty((*q.shape[:-2], len(later))))
            parts = [w @ a[..., k, keep, :] for k, (w, keep) in enumerate(zip(factors, keeps))]
            found.append(np.concatenate(parts, -2))
        return tuple(found)

    torques = tuple(
        np.concatenate([y[..., k, keep] @ w.T for k, (w, keep) in enumerate(zip(ws, keeps))], -1)
        for y, keeps, ws in zip(torque, steady, whiten)
    )
    blur, notes = _blur(recording, regressor), _slow(steady, names)
    return Equations(tuple(names), regressor(recording.q), torques, blur, notes=notes)


def repeat(
    arm: Arm,
    controller: Controller,
    extents_deg,
    effects: Effects,
    repetitions: int,
    seed: int = 0,
    **options,
) -> Recording:
    """The same motions recorded many times: new sensor noise, the encoder mounted anew.

    Arguments are those of `ddlib.simulation.record`. In each repetition the zero of the encoders
    falls elsewhere within a step. Arrays are ``(repetitions, runs, time, joint)``, the reference
    ``(runs, time, joint)``.
    """
    integer("repetitions", repetitions, 1)
    extents = finite_array("extents_deg", extents_deg, 2).reshape(-1, 2)
    runs = len(extents)
    steps = [e.step for e in effects.encoder if isinstance(e, Quantisation)]
    zeros = np.random.default_rng(seed).uniform(0.0, sum(steps), (repetitions, 1, 2))
    shift = EncoderZero(np.broadcast_to(zeros, (repetitions, runs, 2)).reshape(-1, 2))
    mounted = replace(effects, encoder=(shift, *effects.encoder))
    options |= {"effects": mounted, "seed": seed}
    many = record(arm, controller, np.tile(extents, (repetitions, 1)), **options)
    many = many.mapped(lambda x: x.reshape(repetitions, runs, -1, 2))
    return replace(many, reference=type(many.reference)(*(x[0] for x in many.reference)))


def _in_runs(recording: Recording) -> Recording:
    """The recording with an axis for runs, even if it is a single one."""
    single = recording.reference.q.ndim == 2
    return recording.mapped(lambda x: x[..., None, :, :]) if single else recording


def _blur(recording: Recording, regressor) -> tuple[np.ndarray, ...]:
    """``E' E`` by joint of the errors ``E`` that readings' noise makes in a regressor of angles.

    Noise like that of the readings is added to them, of the first repetition.
    """
    q = recording.q.reshape(-1, *recording.q.shape[-3:])[0]
    noise = _reading_noise(q[..., recording.motion, :])
    plain, rng = regressor(q), np.random.default_rng(0)
    shaken = [regressor(q + noise * rng.normal(size=q.shape)) for _ in range(_SHAKES)]
    return tuple(
        np.mean([(x[j] - a).T @ (x[j] - a) for x in shaken], 0) for j, a in enumerate(plain)
    )


def _reading_noise(q) -> np.ndarray:
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
    gaps = np.abs(np.diff(q, axis=-1)).ravel()
    size = np.abs(q).max(initial=0.0)
    gaps = gaps[gaps > 1e-9 * size + 1e-15]
    if gaps.size < 10:
        return None
    step = gaps.min()
    counts = np.round(gaps / step)
    step = float((gaps * counts).sum() / (counts**2).sum())
    rough = np.abs(gaps / step - np.round(gaps / step)).max() > 0.1
    return None if rough or counts.max() > 1e6 else step


def _acting(recording: Recording, hold: float | None) -> tuple[float, float]:
    """When a logged torque begins to act, after its sample, and for how long, s."""
    if hold is not None:
        return 0.0, number("hold", hold, 0.0)
    period = recording.control_step or 0.0
    late = recording.computing_time  # with one, a sample holds the torque of the reading before
    return late - period if late else 0.0, period


def _steady(recording: Recording, names) -> np.ndarray:
    """Where friction has a sure sign, by the speed over all repetitions: (joint, run, time)."""
    q = recording.q
    speed = np.abs(_five_point(q, recording.step))
    speed = np.moveaxis(speed.reshape(-1, *q.shape[-3:]).mean(0), -1, 0)
    wanted = np.array([SLOW if f"F_c{j + 1}" in names else 0.0 for j in range(2)])
    return speed >= wanted[:, None, None]


def _slow(kept, names) -> tuple[str, ...]:
    """A word on each joint (joint, ...) of which nothing is kept, as it is slow."""
    return tuple(
        f"All equations of joint {j + 1} were left out: with F_c{j + 1} they ask for a joint that "
        f"moves on at {SLOW} rad/s or more. Without F_c{j + 1} they count."
        for j, keep in enumerate(kept)
        if f"F_c{j + 1}" in names and not np.any(keep)
    )


def _sampled(recording: Recording, velocity, acceleration, names, margin) -> Equations:
    """Equations at the samples of the motion, `margin` samples away from its ends."""
    recording = _in_runs(recording)
    shape = recording.q.shape
    equations = from_states(
        recording.q, velocity.reshape(shape), acceleration.reshape(shape), recording.tau, names
    )
    inside = np.zeros(recording.t.size, bool)
    inside[recording.motion.start + margin : recording.motion.stop - margin] = True
    keep = _steady(recording, names) & inside
    regressors = tuple(a[..., k, :] for a, k in zip(equations.regressor, keep))
    torques = tuple(y[..., k] for y, k in zip(equations.torque, keep))
    notes = _slow(keep, names)
    return Equations(tuple(names), regressors, torques, biased=_BY_SAMPLE, notes=notes)


def _bumps(t, width, length, orders=(0, 1, 2)) -> list[np.ndarray]:
    """B-splines inside a motion of `length` s and their first two derivatives, (bumps, time)."""
    knot = width / 6
    shape = BSpline.basis_element(knot * np.arange(7), extrapolate=False)
    first = knot * np.arange(int((length - width) / knot + 1e-9) + 1)
    place = t - first[:, None]
    return [np.nan_to_num(shape(place, order)) for order in orders]


def _held(t, width, length, begin, hold) -> np.ndarray:
    """Mean of each bump while a sample's torque acts: its value in the middle misses ``hold^2``."""
    nodes, weights = np.polynomial.legendre.leggauss(3)  # exact for a B-spline of degree 5
    times = t + begin + hold * (1 + nodes[:, None]) / 2
    return sum(w / 2 * _bumps(x, width, length, (0,))[0] for w, x in zip(weights, times))


def _modulated(bumps, after, q, step) -> list[dict]:
    """What each parameter contributes to the modulated torque, for shoulder and elbow.

    The means of the bumps from each sample to the next are `after`.
    """
    w, w1, w2 = (x.T for x in bumps)
    velocity = _five_point(q, step)
    sign = _mean_sign(velocity)
    q1, q2, v1, v2 = q[..., 0], q[..., 1], velocity[..., 0], velocity[..., 1]
    c2, s2 = np.cos(q2), np.sin(q2)
    weight = np.sin(q1 + q2) @ w
    shoulder = {
        "a": q1 @ w2,
        "b": s2 @ w2 - (2 * c2 * v1) @ w1,
        "d": q2 @ w2,
        "g1": np.sin(q1) @ w,
        "g2": weight,
        "F_v1": -q1 @ w1,
        "F_c1": sign[..., 0] @ after.T,
    }
    elbow = {
        "b": (s2 * v1 * (v1 + v2)) @ w - (c2 * v1) @ w1,
        "d": (q1 + q2) @ w2,
        "g2": weight,
        "F_v2": -q2 @ w1,
        "F_c2": sign[..., 1] @ after.T,
    }
    return [shoulder, elbow]


def _mean_sign(velocity) -> np.ndarray:
    """Mean sign of velocities (..., time, joint) from each sample to the next, straight between.

    The sign at a sample would be wrong by up to a period where a velocity changes it.
    """
    slow = np.clip(velocity / SIGN_SPEED, -1.0, 1.0)
    area = slow * (velocity - SIGN_SPEED * slow / 2)  # integral of the sign over the velocity
    change = np.diff(velocity, axis=-2)
    even = np.abs(change) < 1e-6 * SIGN_SPEED
    mean = np.where(even, slow[..., 1:, :], np.diff(area, axis=-2) / np.where(even, 1.0, change))
    return np.concatenate([mean, slow[..., -1:, :]], -2)


def _five_point(q, step) -> np.ndarray:
    """Velocity by central differences of fourth order (plain ones at the ends)."""
    velocity = np.gradient(q, step, axis=-2)
    near, far = q[..., 3:-1, :] - q[..., 1:-3, :], q[..., 4:, :] - q[..., :-4, :]
    velocity[..., 2:-2, :] = (8 * near - far) / (12 * step)
    return velocity
