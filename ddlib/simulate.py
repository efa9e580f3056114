"""Recordings: controller, arm and sensors at their own rates.

The controller reads the encoder every 2 ms and holds its torque until the next
reading; the log takes every fifth sample (10 ms), as on the real arm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, integer, number, one_of
from ddlib.arm import Arm
from ddlib.controllers import Controller
from ddlib.effects import IDEAL, Effects, pass_through
from ddlib.trajectories import MOTION_SECONDS, Trajectory, pick_and_place, time_grid

CONTROL_STEP = 0.002
"""Control period of the DD Arm II, s."""

LOG_STEP = 0.010
"""Sampling period of the recordings, s (Appendix I: 100 samples per second)."""

REST = 0.5
"""Rest recorded before and after a motion, s, so that every window is whole."""


@dataclass(frozen=True)
class Recording:
    """What the log holds. Leading axes, if any, are runs.

    Attributes
    ----------
    t : ndarray, shape (time,)
        Times in s; the motion begins at 0.
    reference : Trajectory
        What the controller was asked for.
    q : ndarray, shape (..., time, joint)
        Measured positions, rad.
    tau : ndarray, shape (..., time, joint)
        Measured torques, N m.
    q_true, qd_true, tau_true : ndarray, shape (..., time, joint)
        What a perfect sensor would have read; `tau_true` is the applied torque.
    """

    t: np.ndarray
    reference: Trajectory
    q: np.ndarray
    tau: np.ndarray
    q_true: np.ndarray
    qd_true: np.ndarray
    tau_true: np.ndarray

    @property
    def motion(self) -> slice:
        """The samples of the motion itself, without the rests."""
        first, end = np.searchsorted(self.t, (0.0, MOTION_SECONDS))
        return slice(int(first), int(end))

    @property
    def tracking_error(self) -> np.ndarray:
        """True position minus reference, rad, shape ``(..., time, joint)``."""
        return self.q_true - self.reference.q


def rk4_step(arm: Arm, effects: Effects, q, qd, tau, step):
    """One Runge-Kutta step of the plant under constant torque; returns new `q`, `qd`.

    The `arm` and the friction of `effects` make the plant. Arrays are ``(..., joint)``:
    angles `q` (rad), velocities `qd` (rad/s), applied torque `tau` (N m); `step` is in s.
    """

    def acceleration(q, qd):
        net = tau - effects.friction_torque(qd) if effects.friction else tau
        return arm._acceleration(q, qd, net)

    half = 0.5 * step
    a1 = acceleration(q, qd)
    v2 = qd + half * a1
    a2 = acceleration(q + half * qd, v2)
    v3 = qd + half * a2
    a3 = acceleration(q + half * v2, v3)
    v4 = qd + step * a3
    a4 = acceleration(q + step * v3, v4)
    return (
        q + step / 6 * (qd + 2 * v2 + 2 * v3 + v4),
        qd + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4),
    )


def substeps(arm: Arm, effects: Effects, step: float) -> int:
    """Runge-Kutta steps that one control period needs to stay stable.

    Friction acts like a first-order decay of joint speed, fastest where its curve is
    steepest: at rest. A step of RK4 is stable up to 2.78 times the decay's time constant;
    2 is used.

    Parameters
    ----------
    arm, effects
        The plant; frictions without a `slope` count as smooth.
    step : float
        Control period, s.
    """
    slope = sum(
        np.max(np.broadcast_to(f.slope, (*np.shape(f.slope)[:-1], 2)).reshape(-1, 2), axis=0)
        for f in effects.friction
        if hasattr(f, "slope")
    )
    elbow = np.linspace(0.0, np.pi, 13)
    mass = arm.mass_matrix(np.stack([0 * elbow, elbow], -1))
    decay = np.linalg.eigvals(np.linalg.solve(mass, np.eye(2) * slope)).real.max()
    return max(1, int(np.ceil(decay * step / 2)))


def free_motion(arm: Arm, q, qd, seconds, step=0.001, effects: Effects = IDEAL):
    """The arm left to itself, without torque: times, positions and velocities.

    Parameters
    ----------
    arm : Arm
        The arm that moves.
    q, qd : array_like, shape (..., 2)
        Initial angles (rad) and velocities (rad/s).
    seconds, step : float
        Duration and integration step, s; a whole number of steps.
    effects : Effects
        Only the friction acts here.

    Returns
    -------
    t : ndarray, shape (time,)
    q, qd : ndarray, shape (..., time, 2)
    """
    q, qd = np.broadcast_arrays(finite_array("q", q, 2), finite_array("qd", qd, 2))
    number("seconds", seconds, 0.0, open_low=True)
    number("step", step, 0.0, seconds, open_low=True)
    count = seconds / step
    if abs(count - round(count)) > 1e-6:
        raise ValueError(f"seconds must be a whole number of steps, got {count:g}")
    t = np.arange(round(count) + 1) * step
    states = [(q, qd)]
    zero = np.zeros_like(q)
    for _ in t[1:]:
        states.append(rk4_step(arm, effects, *states[-1], zero, step))
    q, qd = (np.stack(series, -2) for series in zip(*states))
    return t, q, qd


def follow(
    arm: Arm,
    controller: Controller,
    reference: Trajectory,
    t,
    *,
    effects: Effects = IDEAL,
    seed: int = 0,
    log_every: int = 5,
    velocity: str = "tachometer",
) -> Recording:
    """Drive the arm along a sampled reference and log what the sensors say.

    The arm starts at rest at the reference's first position.

    Parameters
    ----------
    arm, controller, effects
        Plant, control law and everything the rigid-body equations leave out.
    reference : Trajectory
        Sampled at the control period, shape ``(..., time, joint)``; leading axes are runs.
    t : array_like, shape (time,)
        Times of the control samples, equally spaced, s.
    seed : int
        Seed of the sensor noise.
    log_every : int
        Control periods between two logged samples.
    velocity : {"tachometer", "difference"}
        What the controller gets as velocity: the true one, or the difference of two
        encoder readings.

    Raises
    ------
    ValueError
        If shapes or options do not fit, or the loop diverges.
    """
    t = finite_array("t", t)
    if t.ndim != 1 or t.size < 2:
        raise ValueError(f"t must have shape (time,) with two or more samples, got {t.shape}")
    reference = Trajectory(
        *(finite_array(f"reference.{n}", x, 2) for n, x in zip(Trajectory._fields, reference))
    )
    if reference.q.ndim < 2 or reference.q.shape[-2] != t.size:
        raise ValueError(
            f"reference must have {t.size} samples like t, got shape {reference.q.shape}"
        )
    for name, x in zip(Trajectory._fields, reference):
        if x.shape != reference.q.shape:
            raise ValueError(
                f"reference.{name} must have the shape of reference.q {reference.q.shape}, "
                f"got {x.shape}"
            )
    if not callable(getattr(controller, "start", None)):
        raise TypeError(f"controller must have a start method, got {controller!r}")
    step = float(t[1] - t[0])
    if step <= 0 or not np.allclose(np.diff(t), step, rtol=1e-6, atol=0.0):
        raise ValueError(f"t must increase in equal steps, got steps from {step:g} s")
    integer("seed", seed, 0)
    integer("log_every", log_every, 1)
    one_of("velocity", velocity, ("tachometer", "difference"))
    rng = np.random.default_rng(seed)
    law = controller.start(reference, step)
    parts = substeps(arm, effects, step)

    q, qd = reference.q[..., 0, :].copy(), np.zeros_like(reference.q[..., 0, :])
    reading = pass_through(effects.encoder, q, rng)
    log = []
    for k in range(t.size):
        if not np.abs(qd).max() < 1e6:
            raise ValueError(
                f"the control loop diverges: joint speeds pass 1e6 rad/s at t = {t[k]:.3f} s; "
                "lower the gains or the control period"
            )
        previous, reading = reading, pass_through(effects.encoder, q, rng)
        speed = qd if velocity == "tachometer" else (reading - previous) / step
        tau = pass_through(effects.actuator, law(k, reading, speed), rng)
        if k % log_every == 0:
            log.append((reading, pass_through(effects.torque_sensor, tau, rng), q, qd, tau))
        with np.errstate(over="ignore", invalid="ignore"):  # divergence is reported above
            for _ in range(parts):
                q, qd = rk4_step(arm, effects, q, qd, tau, step / parts)
    read, tau, q_true, qd_true, tau_true = (
        np.stack(np.broadcast_arrays(*series), -2) for series in zip(*log)
    )
    logged = Trajectory(*(x[..., ::log_every, :] for x in reference))
    return Recording(t[::log_every], logged, read, tau, q_true, qd_true, tau_true)


def record(
    arm: Arm,
    controller: Controller,
    extents_deg,
    *,
    effects: Effects = IDEAL,
    seed: int = 0,
    rest: float = REST,
    control_step: float = CONTROL_STEP,
    log_step: float = LOG_STEP,
    velocity: str = "tachometer",
) -> Recording:
    """Record pick-and-place motions as in section 4 of the paper.

    Parameters
    ----------
    arm, controller
        Plant and control law.
    extents_deg : array_like, shape (2,) or (runs, 2)
        Extents in degrees; several rows are several runs, simulated together.
    effects, seed, velocity
        As in `follow`.
    rest : float
        Rest before and after the motion, s.
    control_step, log_step : float
        Periods of control and log, s; the second a multiple of the first.

    Returns
    -------
    Recording
        With ``300`` samples of motion at the default log step.

    Raises
    ------
    TypeError, ValueError
        If an argument is of the wrong kind, shape or range.
    """
    number("control_step", control_step, 1e-5, 0.1)
    number("log_step", log_step, control_step, 1.0)
    ratio = log_step / control_step
    if abs(ratio - round(ratio)) > 1e-6:
        raise ValueError(f"log_step must be a multiple of control_step, got ratio {ratio:g}")
    t = time_grid(control_step, rest)
    if round(rest / control_step) % round(ratio):
        raise ValueError(f"rest must be a multiple of log_step={log_step:g}, got {rest:g}")
    reference = pick_and_place(extents_deg, t)
    return follow(
        arm,
        controller,
        reference,
        t,
        effects=effects,
        seed=seed,
        log_every=round(ratio),
        velocity=velocity,
    )
