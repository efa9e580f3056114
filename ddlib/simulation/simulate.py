"""Recordings: controller, arm and sensors at their own rates."""

from __future__ import annotations

import numpy as np

from ddlib._check import (
    filled,
    finite_array,
    instance,
    integer,
    number,
    one_of,
    seed_number,
    shaped,
    told,
    triple,
)
from ddlib.control import Controller, as_controller
from ddlib.dynamics import Arm
from ddlib.effects import IDEAL, Effects
from ddlib.effects.real_arm import signal_path
from ddlib.simulation.plant import Plant, runge_kutta_steps
from ddlib.simulation.recording import Recording, equal_step
from ddlib.trajectories import MOTION_SECONDS, Trajectory, pick_and_place, time_grid

# The page Provenance shows these notes.
CONTROL_STEP = 0.002
"""Control period of the DD Arm II, s."""

LOG_STEP = 0.010
"""Sampling period of the recordings, s (Appendix I: 100 samples per second)."""

REST = 0.5
"""Rest recorded before and after a motion, s, so that every window is whole."""


class _Streams:
    """Noise for many runs, each from a generator of its own; drawn in blocks."""

    BLOCK = 256

    def __init__(self, seeds: np.ndarray):
        self.shape = seeds.shape
        self.generators = [np.random.default_rng(int(s)) for s in seeds.ravel()]
        self.used = self.BLOCK

    def standard_normal(self, shape) -> np.ndarray:
        """The next sample of every run, shape ``(*runs, 2)``; `shape` must fit to it."""
        runs, own = shape[:-1], self.shape
        if len(runs) > len(own) or any(n not in (1, m) for n, m in zip(runs[::-1], own[::-1])):
            raise ValueError(f"seed must be one number or one for each run {runs}, got {own}")
        if self.used == self.BLOCK:
            drawn = np.stack([g.standard_normal((self.BLOCK, 2)) for g in self.generators], 1)
            self.block, self.used = drawn.reshape(self.BLOCK, *self.shape, 2), 0
        self.used += 1
        return self.block[self.used - 1]


def _generator(seed):
    """Source of noise for one seed (all runs share it) or for an array of them."""
    try:
        seeds = np.asarray(seed)
    except ValueError:  # lists of unequal lengths
        seeds = np.array([np.nan])
    if seeds.ndim == 0:
        return np.random.default_rng(seed_number("seed", seed))
    if seeds.dtype.kind not in "iu":
        raise TypeError(f"seed must be an integer or an array of integers, got {told(seed)}")
    if not seeds.size or (seeds < 0).any():
        raise ValueError(f"seed must hold integers from 0 and up, got {told(seed)}")
    return _Streams(seeds)


def _held(plant: Plant, x, v, tau, seconds, parts):
    """Positions and velocities after `seconds` under constant torque, in `parts` steps a run."""
    most = int(np.max(parts))
    if np.min(parts) == most:
        for _ in range(most):
            x, v = plant.advance(x, v, tau, seconds / most)
        return x, v
    parts = parts[..., None]
    for k in range(most):  # runs that need fewer steps wait for the others
        x_next, v_next = plant.advance(x, v, tau, seconds / parts)
        x, v = np.where(k < parts, x_next, x), np.where(k < parts, v_next, v)
    return x, v


def _moving(plant: Plant, q, qd):
    """Positions and velocities of a plant whose motors turn like the joints behind them."""
    x, v = plant.rest(q)
    return x, v + (np.concatenate([qd, qd], -1) if v.shape[-1] == 4 else qd)


def follow(
    arm: Arm,
    controller: Controller,
    reference: Trajectory,
    t,
    *,
    effects: Effects = IDEAL,
    seed: int | np.ndarray = 0,
    log_every: int = 5,
    velocity: str = "tachometer",
    start=None,
    duration: float | None = None,
) -> Recording:
    """Drive the arm along a sampled reference and log what the sensors say.

    Runs may differ in their reference, the gains, the strengths of the effects and the seed:
    leading axes of all are broadcast. No run depends on others, except through shared noise.

    Parameters
    ----------
    arm, controller, effects
        Plant, control law (or a function as in `ddlib.control.as_controller`) and everything the
        rigid-body equations leave out.
    reference : Trajectory
        Sampled at the control period, shape ``(..., time, joint)``; leading axes are runs.
    t : array_like, shape (time,)
        Times of the control samples, equally spaced, s.
    seed : int or array_like of int, shape (...)
        Of the sensor noise. With one number the runs of a batch share a generator; with one for
        each run each has its own noise, the same as if it ran alone.
    log_every : int
        Control periods between two logged samples.
    velocity : {"tachometer", "difference"}
        What the controller gets: the true velocity, or the difference of two encoder readings.
    start : pair of array_like, each of shape (..., 2), optional
        Angles (rad) and velocities (rad/s). Default: at rest at the reference's first position.
    duration : float, optional
        Length of the motion from 0 s on; default: where the reference moves.
    """
    reference = Trajectory(*triple("reference", reference))
    instance("arm", arm, Arm)
    instance("effects", effects, Effects)
    t = shaped("t", t, "(time,)")
    integer("samples of t", t.size, 2)
    shaped("reference.q", reference.q, f"(..., {t.size}, 2)")
    controller = as_controller(controller)
    step = equal_step(t)
    integer("log_every", log_every, 1, t.size - 1)
    one_of("velocity", velocity, ("tachometer", "difference"))
    rng = _generator(seed)
    computing_time = effects.computing_time
    if computing_time > step * (1 - 1e-9):
        raise ValueError(
            f"effects must have a computing time below the control period {step:g} s, got "
            f"{computing_time:g}; Delay adds whole periods"
        )
    reference = Trajectory(*(_time_first(x) for x in reference))
    first = reference.q[..., 0, :]
    start = _initial_state(first, (first, np.zeros(2)) if start is None else start)
    law = controller.start(reference, step)
    plant, parts = Plant(arm, effects), runge_kutta_steps(arm, effects, step)
    x, v = _moving(plant, *start)
    tau = np.zeros_like(start[0])
    encoder = signal_path(effects.encoder, x[..., -2:])
    actuator, torque_sensor = (
        signal_path(e, tau) for e in (effects.actuator, effects.torque_sensor)
    )
    reading = encoder(x[..., -2:] - step * v[..., -2:], rng)  # one period ago
    log = []
    for k in range(t.size):
        if not np.abs(v).max() < 1e6:
            raise ValueError(
                f"the control loop diverges: joint speeds pass 1e6 rad/s at t = {t[k]:.3f} s; "
                "lower the gains or the control period"
            )
        previous, reading = reading, encoder(x[..., -2:], rng)
        speed = v[..., -2:] if velocity == "tachometer" else (reading - previous) / step
        commanded = law(k, reading, speed)
        if np.shape(commanded)[-1:] != (2,):
            raise ValueError(
                "controller must return torques of shape (..., 2), one for each joint, got "
                f"{told(commanded)} of shape {np.shape(commanded)}"
            )
        if np.isnan(commanded).any():
            raise ValueError(
                f"controller must return finite torques, got NaN at t = {t[k]:.3f} s: look for a "
                "division by zero or a missing value in it"
            )
        previous_tau, tau = tau, actuator(commanded, rng)
        if k % log_every == 0:
            acting = previous_tau if computing_time else tau
            log.append((reading, torque_sensor(acting, rng), x[..., :2], v[..., :2], acting))
        with np.errstate(over="ignore", invalid="ignore"):  # divergence is reported above
            if computing_time:
                x, v = _held(plant, x, v, previous_tau, computing_time, parts)
            x, v = _held(plant, x, v, tau, step - computing_time, parts)
    read, tau, q_true, qd_true, tau_true = (
        np.stack(np.broadcast_arrays(*series), -2) for series in zip(*log)
    )
    logged = Trajectory(*(x[..., ::log_every, :] for x in reference))
    arrays = (read, tau, q_true, qd_true, tau_true)
    return Recording(t[::log_every], logged, *arrays, duration, step, computing_time)


def _initial_state(first, start):
    """Angles and velocities at the start of each run, checked, in the shape of the runs."""
    if not hasattr(start, "__len__") or len(start) != 2:
        raise ValueError(f"start must be a pair of angles and velocities, got {told(start)}")
    q, qd = (finite_array(f"start[{k}]", x, 2) for k, x in enumerate(start))
    try:
        return np.broadcast_arrays(q, qd, first)[:2]
    except ValueError as error:
        runs = first.shape[:-1]
        raise ValueError(f"start must fit to the runs {runs}, got {q.shape}, {qd.shape}") from error


def _time_first(x):
    """`x` unchanged, but one sample of all runs lies together in memory, joint by joint."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(x, (-2, -1), (0, 1))), (0, 1), (-2, -1))


def record(
    arm: Arm,
    controller: Controller,
    extents_deg,
    *,
    rest: float = REST,
    control_step: float = CONTROL_STEP,
    log_step: float = LOG_STEP,
    duration: float = MOTION_SECONDS,
    effects: Effects = IDEAL,
    seed: int | np.ndarray = 0,
    velocity: str = "tachometer",
    start=None,
) -> Recording:
    """Record pick-and-place motions as in section 4 of the paper.

    The controller reads the encoder every 2 ms and holds its torque until the next reading; the
    log takes every fifth sample (10 ms), as on the real arm: 300 samples of motion.

    Parameters
    ----------
    arm, controller
        Plant and control law.
    extents_deg : array_like, shape (2,) or (runs, 2)
        Extents in degrees; several rows are several runs, simulated together.
    rest, duration : float
        Rest before and after the motion, and its length, s.
    control_step, log_step : float
        Periods of control and log, s; the second a multiple of the first.
    effects, seed, velocity, start
        As in `follow`.
    """
    filled("extents_deg", extents_deg)
    number("control_step", control_step, 1e-5, 0.1)
    number("log_step", log_step, control_step, 1.0)
    ratio = log_step / control_step
    if abs(ratio - round(ratio)) > 1e-6:
        raise ValueError(f"log_step must be a multiple of control_step, got ratio {ratio:g}")
    t = time_grid(control_step, rest, duration)
    if round(rest / control_step) % round(ratio):
        raise ValueError(f"rest must be a multiple of log_step={log_step:g}, got {rest:g}")
    reference = pick_and_place(extents_deg, t, duration)
    return follow(
        arm, controller, reference, t, effects=effects, seed=seed, log_every=round(ratio),
        velocity=velocity, start=start, duration=duration,
    )  # fmt: skip
