"""From recordings to equations for identification: differences, smoothing, modulation."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import savgol_filter

from ddlib._check import finite_array, flag, instance, integer, number
from ddlib.control import Controller
from ddlib.dynamics import Arm
from ddlib.effects import Effects, EncoderZero, Quantisation
from ddlib.identification.averaging import (
    BY_SAMPLE,
    acting_time,
    bumps_held,
    bumps_over,
    five_point_velocity,
    kept_bumps,
    mean_sign,
    notes_on_slow_joints,
    samples_apart,
    where_sign_is_sure,
    with_runs,
)
from ddlib.identification.regression import (
    FRICTION,
    GRAVITY,
    OFFSETS,
    RIGID,
    Equations,
    from_states,
    known_names,
    regressor_columns,
)
from ddlib.identification.whitening import independent_equations
from ddlib.logs import DoubtfulRecording, LoggedRecording, warn_of
from ddlib.logs.findings import JOINTS
from ddlib.simulation import Recording, record

POSE = ("g1", "g1_cos", "g2", "g2_cos")
"""Weight of an arm whose zeros are anywhere: columns of `modulated`."""


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
    instance("recording", recording, Recording)
    flag("smooth_torque", smooth_torque)
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
        Parameters, from `RIGID`, `GRAVITY`, `FRICTION` and `OFFSETS`.
    width : float
        Width of a bump, s: 12 samples or more, and no longer than the motion; cut to a multiple of
        six samples. Narrow bumps let quantisation through, wide ones lose detail.
    hold : float, optional
        Time for which a logged torque acts, s, from its sample on: the shorter of the log's step
        and the controller's period. Default: as the recording says, its computing time included.

    Warns
    -----
    DoubtfulRecording
        Of a log that shows what makes every fit wrong, or torques that depend on the pose though
        `GRAVITY` is not among the names.
    """
    instance("recording", recording, Recording)
    known_names(names)
    warn_of(recording)
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
    acting, recording = acting_time(recording, hold), with_runs(recording)
    place = recording.t - begin, width, end - begin
    bumps, later = bumps_over(*place), bumps_held(*place, *acting)
    after = bumps_held(*place, 0.0, recording.step)
    sure = where_sign_is_sure(recording, names)
    apart = samples_apart(recording)

    def averaged(q, names=names) -> list[np.ndarray]:
        like = np.empty((*q.shape[:-2], len(later)))
        rows = modulated(bumps, after, five_point_velocity(q, recording.step, apart), q)
        return [regressor_columns(row, names, like) for row in rows]

    kept, bent = kept_bumps(sure, bumps[0]), (bumps[2], bumps[2])
    if isinstance(recording, LoggedRecording) and not set(GRAVITY) & set(names):
        torques = np.moveaxis(recording.tau, -1, 0) @ later.T
        _warn_of_weight(names, lambda every: averaged(recording.q, every), torques, kept)
    return independent_equations(recording, names, averaged, sure, kept, bent, later, acting[1])


def _warn_of_weight(names, columns, torques, kept) -> None:
    """Warn if torques that only the pose explains are more than half of what `names` leave over.

    Each joint has an offset in any case.
    """
    size = [tau[keep].std() if keep.any() else 0.0 for tau, keep in zip(torques, kept)]
    if not min(size) > 0:
        return
    y = np.concatenate([tau[keep] / s for tau, keep, s in zip(torques, kept, size)])
    joint = np.repeat([0, 1], [keep.sum() for keep in kept])
    left = []
    for more in (OFFSETS, OFFSETS + POSE):
        rows = columns((*names, *more))
        a = np.concatenate([x[keep] / s for x, keep, s in zip(rows, kept, size)])
        residual = y - a @ np.linalg.lstsq(a, y, rcond=1e-7)[0]
        left.append(np.bincount(joint, residual**2) / np.bincount(joint))
    heavy = [JOINTS[j] for j in range(2) if left[1][j] < min(0.5 * left[0][j], left[0][j] - 0.002)]
    if heavy:
        warnings.warn(
            "torques that depend on the pose are most of what would be left over at the "
            f"{' and '.join(heavy)}, as if the arm hung: without GRAVITY among the names an "
            "estimate is wrong. A spring or a cable looks alike.",
            DoubtfulRecording,
            stacklevel=3,
        )


def repeat(
    arm: Arm,
    controller: Controller,
    extents_deg,
    effects: Effects,
    repetitions: int,
    seed: int = 0,
    spread: float = 0.0,
    **options,
) -> Recording:
    """The same motions recorded many times: new sensor noise, the encoder mounted anew.

    Arguments are those of `ddlib.simulation.record`. In each run the zero of the encoders falls
    elsewhere within a step, and is known: a controller would take an unknown one away, with
    readings rounded alike each time. A motion that is quite the same is rounded in a pattern of its
    own, which is no noise, so extents may differ: each is smaller by up to the share `spread`.
    Arrays are ``(repetitions, runs, time, joint)``; the reference is that of the first repetition.
    """
    integer("repetitions", repetitions, 1)
    number("spread", spread, 0.0, 1.0)
    extents = finite_array("extents_deg", extents_deg, 2).reshape(-1, 2)
    runs, rng = len(extents), np.random.default_rng(seed)
    steps = [e.step for e in effects.encoder if isinstance(e, Quantisation)]
    zeros = rng.uniform(0.0, sum(steps), (repetitions * runs, 2))
    encoder = (EncoderZero(zeros), *effects.encoder, EncoderZero(-zeros))
    options |= {"effects": replace(effects, encoder=encoder), "seed": seed}
    extents = np.tile(extents, (repetitions, 1))
    extents = extents * (1 - rng.uniform(0.0, spread, extents.shape))
    many = record(arm, controller, extents, **options)
    many = many.mapped(lambda x: x.reshape(repetitions, runs, -1, 2))
    return replace(many, reference=type(many.reference)(*(x[0] for x in many.reference)))


def _sampled(recording: Recording, velocity, acceleration, names, margin) -> Equations:
    """Equations at the samples of the motion, `margin` samples away from its ends."""
    recording = with_runs(recording)
    shape = recording.q.shape
    equations = from_states(
        recording.q, velocity.reshape(shape), acceleration.reshape(shape), recording.tau, names
    )
    inside = np.zeros(recording.t.size, bool)
    inside[recording.motion.start + margin : recording.motion.stop - margin] = True
    keep = where_sign_is_sure(recording, names) & inside
    regressors = tuple(a[..., k, :] for a, k in zip(equations.regressor, keep))
    torques = tuple(y[..., k] for y, k in zip(equations.torque, keep))
    notes = notes_on_slow_joints(keep, names)
    return Equations(tuple(names), regressors, torques, biased=BY_SAMPLE, notes=notes)


def modulated(bumps, after, velocity, q) -> list[dict]:
    """What each parameter contributes to the modulated torque, for shoulder and elbow.

    The means of the bumps from each sample to the next are `after`. If the elbow's zero is off by
    an angle, `b` and `b_sin` are the coupling times its cosine and sine; likewise `g1`, `g1_cos`
    and `g2`, `g2_cos` for angles that are not counted from the vertical.
    """
    w, w1, w2 = (x.T for x in bumps)
    sign = mean_sign(velocity)
    q1, q2, v1, v2 = q[..., 0], q[..., 1], velocity[..., 0], velocity[..., 1]
    c2, s2 = np.cos(q2), np.sin(q2)
    weight, across = np.sin(q1 + q2) @ w, np.cos(q1 + q2) @ w
    ones = np.broadcast_to(w.sum(0), weight.shape)
    shoulder = {
        "a": q1 @ w2,
        "b": s2 @ w2 - (2 * c2 * v1) @ w1,
        "b_sin": c2 @ w2 + (2 * s2 * v1) @ w1,
        "d": q2 @ w2,
        "g1": np.sin(q1) @ w,
        "g2": weight,
        "g1_cos": np.cos(q1) @ w,
        "g2_cos": across,
        "F_v1": -q1 @ w1,
        "F_c1": sign[..., 0] @ after.T,
        "offset1": ones,
    }
    elbow = {
        "b": (s2 * v1 * (v1 + v2)) @ w - (c2 * v1) @ w1,
        "b_sin": (c2 * v1 * (v1 + v2)) @ w + (s2 * v1) @ w1,
        "d": (q1 + q2) @ w2,
        "g2": weight,
        "g2_cos": across,
        "F_v2": -q2 @ w1,
        "F_c2": sign[..., 1] @ after.T,
        "offset2": ones,
    }
    return [shoulder, elbow]
