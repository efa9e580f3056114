"""Motions, feedforwards and scores of the study "run-time"."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from beyond.control.windowed import WindowFeedforward
from beyond.rivals.protocol import derivative_filters
from ddlib.analysis import inside_hull
from ddlib.control import PID, ComputedTorque, Feedforward, closed_loop, plant
from ddlib.dynamics import Arm, end_point_error, jacobian
from ddlib.effects import Effects, EncoderZero
from ddlib.learning import TorqueModel, sliding_windows
from ddlib.setups import Setup
from ddlib.simulation import CONTROL_STEP, LOG_STEP, REST, Recording, follow
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS, Trajectory, pick_and_place, time_grid
from workshop.report import results

WIDTH = 21  # samples of a window: the paper's best
POINTS = 7  # trajectories in a row of the square of extents


def square_extents(points: int) -> np.ndarray:
    """Extents of a square, degrees, shape (runs, 2); the elbow's change fastest."""
    edge = MAX_EXTENT_DEG * np.arange(1, points + 1) / points
    return np.stack(np.meshgrid(edge, edge, indexing="ij"), -1).reshape(-1, 2)


EXTENTS = square_extents(POINTS)
_INSIDE = inside_hull(EXTENTS)  # the hull of the training trajectories
FEWER_EXTENTS = EXTENTS.reshape(POINTS, POINTS, 2)[::2, ::2].reshape(-1, 2)
TIMES = time_grid(CONTROL_STEP, REST)  # control samples, s
_START = 0.5  # s: what counts as the start of a motion
_Model = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def exact(setup: Setup, arm: Arm | None = None) -> _Model:
    """The equations of the set-up's arm or another, friction included: torque of a state."""
    body = arm or setup.arm
    return lambda q, qd, qdd: body.inverse_dynamics(q, qd, qdd) + setup.effects.friction_torque(qd)


def with_impulse(setup: Setup) -> _Model:
    """`exact`, with the impulse of each jump in velocity, within one control period."""

    def torque(q, qd, qdd):
        rate = np.diff(qd, axis=-2, append=qd[..., -1:, :]) / CONTROL_STEP
        jump = np.where(np.abs(rate - qdd) > 10 * np.abs(qdd).max(), rate, 0.0)
        at_once = np.einsum("...ij,...j->...i", setup.arm.mass_matrix(q), jump)
        return exact(setup)(q, qd, qdd) + at_once

    return torque


def through_window(torque: _Model, width: int = WIDTH) -> WindowFeedforward:
    """Equations of a state that see windows: a polynomial in each gives the state."""
    filters = derivative_filters(width, LOG_STEP)

    def model(windows):
        return torque(*np.moveaxis(windows @ filters.T, -1, 0))

    return WindowFeedforward(model, width)


def networks(setup: Setup, count: int, width: int = WIDTH, **options) -> list[WindowFeedforward]:
    """The first networks of a cell of Table 4-1 as feedforwards."""
    model = results.networks(width, setup.name)
    options = {"step": model.step, **options}
    return [WindowFeedforward(model[k].torque, width, **options) for k in range(count)]


def computed_torque(setup: Setup, arm: Arm | None = None) -> Callable:
    """Computed torque with the reference's friction, as stiff as the feedback."""
    kp = np.asarray(setup.controller.kp) / np.diag(setup.arm.mass_matrix(np.zeros(2)))
    kd = 2 * np.sqrt(kp)
    law = ComputedTorque(arm or setup.arm, tuple(kp), tuple(kd))

    def torque(wanted, q, qd):
        one = Trajectory(*(x[..., None, :] for x in wanted))
        return law.start(one, CONTROL_STEP)(0, q, qd) + setup.effects.friction_torque(wanted.qd)

    return torque


# --- motions ------------------------------------------------------------------------------


def rounded(extents_deg, seconds: float) -> Trajectory:
    """The paper's motions with corners averaged over a raised cosine of so many seconds."""
    plan = pick_and_place(extents_deg, TIMES)
    half = round(seconds / CONTROL_STEP / 2)
    if not half:
        return plan
    weights = 1 + np.cos(np.pi * np.arange(-half, half + 1) / (half + 1))
    weights /= weights.sum()

    def smooth(x):
        ends = [(0, 0)] * (x.ndim - 2) + [(half, half), (0, 0)]
        whole = np.lib.stride_tricks.sliding_window_view(np.pad(x, ends), weights.size, axis=-2)
        return whole @ weights

    qd = smooth(plan.qd)
    return Trajectory(smooth(plan.q), qd, np.gradient(qd, CONTROL_STEP, axis=-2))


def on_days(effects: Effects, setup: Setup, days) -> Effects:
    """Effects with the encoder's zero of other days, which are the first axis of the runs."""
    zero = np.stack([setup.repeated(day).effects.encoder[0].angle for day in days])[:, None]
    return replace(effects, encoder=(EncoderZero(zero), *effects.encoder, EncoderZero(-zero)))


def torques_along(models, reference: Trajectory) -> np.ndarray:
    """Torques of several feedforwards along a reference, shape (models, ..., time, 2), N m."""
    return _time_first(np.stack([model(*reference) for model in models]))


def _time_first(torque) -> np.ndarray:
    """Torques unchanged, but one sample of all runs lies together in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(torque, -2, 0)), 0, -2)


def given(torque, feedback) -> Feedforward:
    """A feedforward of torques ``(..., time, 2)`` that are known for every control sample."""
    return Feedforward(lambda *_: torque, feedback)


def drive(setup: Setup, controller, reference, days, *, arm=None, effects=None) -> Recording:
    """Follow a reference on several days, which become the first axis of the runs."""
    effects = on_days(effects or setup.effects, setup, days)
    return follow(
        arm or setup.arm, controller, reference, TIMES, effects=effects, duration=MOTION_SECONDS
    )


def drive_lines(
    setup: Setup, made: dict, reference: Trajectory, **changed
) -> tuple[Recording, dict[str, slice]]:
    """Recording of all lines ``{name: (torques, days)}``, and which part of it belongs to each."""
    every, days, parts = [], [], {}
    for name, (torque, own) in made.items():
        parts[name] = slice(len(days), len(days) + len(own))
        days += own
        every.append(np.broadcast_to(torque, (len(own), *torque.shape[1:])))
    law = given(_time_first(np.concatenate(every)), setup.controller)
    return drive(setup, law, reference, days, **changed), parts


# --- scores -------------------------------------------------------------------------------


class _Score(NamedTuple):
    """End-point errors of runs, mm, and joint errors, degrees: RMS over the motion."""

    whole: np.ndarray
    start: np.ndarray  # over the first `_START` seconds
    rest: np.ndarray
    along: np.ndarray  # the path of the hand
    across: np.ndarray
    largest: np.ndarray  # not the root mean square
    shoulder: np.ndarray
    elbow: np.ndarray


def score(arm: Arm, recording: Recording) -> _Score:
    """End-point and joint errors of a recording."""
    moving = recording.motion
    wanted, wanted_rate, _ = (x[..., moving, :] for x in recording.reference)
    q = recording.q_true[..., moving, :]
    gap = 1e3 * end_point_error(arm, wanted, q)
    way = np.einsum("...ij,...j->...i", jacobian(arm, wanted), wanted_rate)
    way = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-12)
    along = (gap * way).sum(-1)
    across = gap[..., 1] * way[..., 0] - gap[..., 0] * way[..., 1]
    size2, early = (gap**2).sum(-1), recording.t[moving] < _START
    joints = np.rad2deg(np.sqrt(((wanted - q) ** 2).mean(-2)))

    def root(x):
        return np.sqrt(x.mean(-1))

    return _Score(
        whole=root(size2),
        start=root(size2[..., early]),
        rest=root(size2[..., ~early]),
        along=root(along**2),
        across=root(across**2),
        largest=np.sqrt(size2.max(-1)),
        shoulder=joints[..., 0],
        elbow=joints[..., 1],
    )


def median_errors(
    setup: Setup, made: dict, reference: Trajectory, **changed
) -> dict[str, np.ndarray]:
    """Median end-point error over the runs on each day of each line, as of `drive_lines`, mm."""
    log, parts = drive_lines(setup, made, reference, **changed)
    middle = np.median(score(setup.arm, log).whole, -1)
    return {name: middle[part] for name, part in parts.items()}


def median_scores(found: _Score) -> dict:
    """Medians over the square of scores ``(members, runs)``, by member, and a map of `whole`."""
    row = {name: np.median(values, -1) for name, values in found._asdict().items()}
    row["inside"] = np.median(found.whole[:, _INSIDE], -1)
    row["outside"] = np.median(found.whole[:, ~_INSIDE], -1)
    row["map"] = np.median(found.whole, 0)
    return row


# --- the linear loop ----------------------------------------------------------------------


def linear_loop(setup: Setup, elbow: float):
    """The loop about one elbow angle as a python-control system, without Coulomb friction.

    Inputs are torques of shoulder and elbow (N m), held for a control period; outputs joint errors
    (rad).
    """
    feedback: PID = setup.controller
    joints = plant(
        setup.arm.mass_matrix([0.0, elbow]), np.asarray(setup.effects.friction[0].coefficient)
    )
    return closed_loop(joints, feedback.kp, feedback.ki, feedback.kd, CONTROL_STEP)[:, 2:]


def through_loop(system, torque) -> np.ndarray:
    """Joint errors (rad) that the linear loop makes of torques ``(..., time, 2)``, N m."""
    torque = np.asarray(torque)
    x = np.zeros((*torque.shape[:-2], system.nstates))
    errors = np.empty(torque.shape)
    for k in range(torque.shape[-2]):
        errors[..., k, :] = x @ system.C.T
        x = x @ system.A.T + torque[..., k, :] @ system.B.T
    return errors


def predicted_error(setup: Setup, torque, reference: Trajectory) -> np.ndarray:
    """End-point error that the linear loop and the plan's Jacobian predict, RMS in mm."""
    system = linear_loop(setup, float(reference.q[..., 1].mean()))
    moving = (TIMES >= 0) & (TIMES < MOTION_SECONDS)
    error = through_loop(system, torque - with_impulse(setup)(*reference))[..., moving, :]
    gap = np.einsum("...ij,...j->...i", jacobian(setup.arm, reference.q[..., moving, :]), error)
    return 1e3 * np.sqrt((gap**2).sum(-1).mean(-1))


def error_of_logged(setup: Setup, model: TorqueModel, run: Recording) -> np.ndarray:
    """What each member's error on a recorded motion would do to the hand, RMS in mm."""
    moving = run.motion
    missed = model.torque(sliding_windows(run.q, model.weights.width, moving)) - run.tau[moving]
    held = np.repeat(missed, round(run.step / CONTROL_STEP), axis=-2)
    system = linear_loop(setup, float(run.q[moving, 1].mean()))
    error = through_loop(system, held)
    J = np.repeat(jacobian(setup.arm, run.q[moving]), round(run.step / CONTROL_STEP), axis=0)
    gap = np.einsum("...ij,...j->...i", J, error)
    return 1e3 * np.sqrt((gap**2).sum(-1).mean(-1))
