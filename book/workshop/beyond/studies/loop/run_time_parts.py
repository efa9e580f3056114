"""Motions, feedforwards and scores of the study "run-time"."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ddlib._check import integer, number
from ddlib.control import PID, ComputedTorque, Feedforward, closed_loop, plant
from ddlib.dynamics import Arm, end_point_error, jacobian
from ddlib.effects import Effects, EncoderZero
from ddlib.learning import TorqueModel, sliding_windows
from ddlib.setups import Setup, inside_hull
from ddlib.simulation import CONTROL_STEP, LOG_STEP, REST, Recording, follow
from ddlib.trajectories import (
    MAX_EXTENT_DEG,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    time_grid,
)
from workshop.beyond.control.windowed import WindowFeedforward
from workshop.beyond.rivals.protocol import derivative_filters
from workshop.report import results

WIDTH = 21
"""Samples of a window: the paper's best."""

POINTS = 7
"""Trajectories in a row of the square of extents."""

EDGE = MAX_EXTENT_DEG * np.arange(1, POINTS + 1) / POINTS
EXTENTS = np.stack(np.meshgrid(EDGE, EDGE, indexing="ij"), -1).reshape(-1, 2)
"""Extents of the square, degrees, shape (runs, 2); the elbow's change fastest."""

INSIDE = inside_hull(EXTENTS)
"""Whether they lie in the hull of the training trajectories."""

FEWER = EXTENTS.reshape(POINTS, POINTS, 2)[::2, ::2].reshape(-1, 2)
"""Every other one of either joint, for the side experiments."""

T = time_grid(CONTROL_STEP, REST)
"""Times of the control samples, s."""

START = 0.5
"""What counts as the start of a motion, s."""

Model = Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


def exact(setup: Setup, arm: Arm | None = None) -> Model:
    """The equations of the arm, friction included: torque of a state.

    Parameters
    ----------
    setup : Setup
    arm : Arm, optional
        Another arm in place of the set-up's, with the same friction.
    """
    body = arm or setup.arm
    return lambda q, qd, qdd: body.inverse_dynamics(q, qd, qdd) + setup.effects.friction_torque(qd)


def with_impulse(setup: Setup) -> Model:
    """`exact`, and where the reference's velocity jumps the impulse, within one control period.

    Parameters
    ----------
    setup : Setup
    """

    def torque(q, qd, qdd):
        rate = np.diff(qd, axis=-2, append=qd[..., -1:, :]) / CONTROL_STEP
        jump = np.where(np.abs(rate - qdd) > 10 * np.abs(qdd).max(), rate, 0.0)
        at_once = np.einsum("...ij,...j->...i", setup.arm.mass_matrix(q), jump)
        return exact(setup)(q, qd, qdd) + at_once

    return torque


def through_window(torque: Model, width: int = WIDTH) -> WindowFeedforward:
    """Equations of a state that see windows: a polynomial in each gives the state.

    Parameters
    ----------
    torque : callable
        Of position, velocity and acceleration, as from `exact`.
    width : int
    """
    filters = derivative_filters(width, LOG_STEP)

    def model(windows):
        return torque(*np.moveaxis(windows @ filters.T, -1, 0))

    return WindowFeedforward(model, width, step=LOG_STEP)


def networks(setup: Setup, count: int, width: int = WIDTH, **options) -> list[WindowFeedforward]:
    """The first networks of a cell of Table 4-1 as feedforwards.

    Parameters
    ----------
    setup : Setup
    count, width : int
    **options
        Of `WindowFeedforward`.
    """
    model = results.networks(width, setup.name)
    options = {"step": model.step, **options}
    return [
        WindowFeedforward(model[k].torque, width, **options)
        for k in range(integer("count", count, 1, len(model.weights)))
    ]


def computed_torque(setup: Setup, arm: Arm | None = None) -> Callable:
    """Computed torque with friction of the reference: `exact` at the measured state.

    As stiff as the set-up's feedback with the arm stretched, and critically damped.

    Parameters
    ----------
    setup : Setup
    arm : Arm, optional
        What the controller takes the arm for; default: the set-up's.
    """
    kp = np.asarray(setup.controller.kp) / np.diag(setup.arm.mass_matrix(np.zeros(2)))
    kd = 2 * np.sqrt(kp)
    law = ComputedTorque(arm or setup.arm, tuple(kp), tuple(kd))

    def torque(wanted, q, qd):
        one = Trajectory(*(x[..., None, :] for x in wanted))
        return law.start(one, CONTROL_STEP)(0, q, qd) + setup.effects.friction_torque(wanted.qd)

    return torque


# --- motions ------------------------------------------------------------------------------


def rounded(extents_deg, seconds: float) -> Trajectory:
    """The paper's motions with rounded corners: averaged over a raised cosine in time.

    Parameters
    ----------
    extents_deg : array_like, shape (..., 2)
    seconds : float
        Length of the raised cosine, s; 0: the paper's motions as they are.
    """
    plan = pick_and_place(extents_deg, T)
    half = round(number("seconds", seconds, 0.0, REST) / CONTROL_STEP / 2)
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
    """Effects with the encoder's zero of other days, which are the first axis of the runs.

    Parameters
    ----------
    effects : Effects
    setup : Setup
        Whose encoder it is.
    days : sequence of int
        As in `Setup.repeated`.
    """
    zero = np.stack([setup.repeated(day).effects.encoder[0].angle for day in days])[:, None]
    return replace(effects, encoder=(EncoderZero(zero), *effects.encoder, EncoderZero(-zero)))


def planned(models, reference: Trajectory) -> np.ndarray:
    """Torques of several feedforwards along a reference, shape (models, ..., time, 2).

    Parameters
    ----------
    models : sequence of callable
    reference : Trajectory
    """
    return time_first(np.stack([model(*reference) for model in models]))


def time_first(torque) -> np.ndarray:
    """Torques unchanged, but one sample of all runs lies together in memory."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(torque, -2, 0)), 0, -2)


def given(torque, feedback) -> Feedforward:
    """A feedforward of torques that are known for every control sample.

    Parameters
    ----------
    torque : ndarray, shape (..., time, 2)
    feedback : Controller
    """
    return Feedforward(lambda *_: torque, feedback)


def drive(setup: Setup, controller, reference, days, *, arm=None, effects=None) -> Recording:
    """Follow a reference on several days; the days are the first axis of the runs.

    Parameters
    ----------
    setup : Setup
    controller : Controller or callable
    reference : Trajectory
    days : sequence of int
    arm, effects : optional
        In place of the set-up's; the encoder's zero is the day's.
    """
    effects = on_days(effects or setup.effects, setup, days)
    return follow(
        arm or setup.arm, controller, reference, T, effects=effects, duration=MOTION_SECONDS
    )


# --- scores -------------------------------------------------------------------------------


class Score(NamedTuple):
    """End-point errors of runs, mm, each of shape (...): root mean squares over the motion.

    Attributes
    ----------
    whole : ndarray
        Over the whole motion; `start` and `rest`: over its first `START` seconds and after.
    start, rest : ndarray
    along, across : ndarray
        Of the error along the path of the hand, and across it.
    largest : ndarray
        Largest error.
    shoulder, elbow : ndarray
        Root mean square of the joint errors, degrees.
    """

    whole: np.ndarray
    start: np.ndarray
    rest: np.ndarray
    along: np.ndarray
    across: np.ndarray
    largest: np.ndarray
    shoulder: np.ndarray
    elbow: np.ndarray


def score(arm: Arm, recording: Recording) -> Score:
    """End-point and joint errors of a recording.

    Parameters
    ----------
    arm : Arm
    recording : Recording
    """
    moving = recording.motion
    wanted, wanted_rate, _ = (x[..., moving, :] for x in recording.reference)
    q = recording.q_true[..., moving, :]
    gap = 1e3 * end_point_error(arm, wanted, q)
    way = np.einsum("...ij,...j->...i", jacobian(arm, wanted), wanted_rate)
    way = way / np.maximum(np.linalg.norm(way, axis=-1, keepdims=True), 1e-12)
    along = (gap * way).sum(-1)
    across = gap[..., 1] * way[..., 0] - gap[..., 0] * way[..., 1]
    size2, early = (gap**2).sum(-1), recording.t[moving] < START
    joints = np.rad2deg(np.sqrt(((wanted - q) ** 2).mean(-2)))

    def root(x):
        return np.sqrt(x.mean(-1))

    return Score(
        whole=root(size2),
        start=root(size2[..., early]),
        rest=root(size2[..., ~early]),
        along=root(along**2),
        across=root(across**2),
        largest=np.sqrt(size2.max(-1)),
        shoulder=joints[..., 0],
        elbow=joints[..., 1],
    )


def told(found: Score) -> dict:
    """Medians over the square, one for each member (the first axis), and a map of `whole`.

    Parameters
    ----------
    found : Score
        Of shape (members, runs) of `EXTENTS`.
    """
    row = {name: np.median(values, -1) for name, values in found._asdict().items()}
    row["inside"] = np.median(found.whole[:, INSIDE], -1)
    row["outside"] = np.median(found.whole[:, ~INSIDE], -1)
    row["map"] = np.median(found.whole, 0)
    return row


# --- the linear loop ----------------------------------------------------------------------


def linear_loop(setup: Setup, elbow: float):
    """The loop about one posture as a python-control system: torque errors in, joint errors out.

    Parameters
    ----------
    setup : Setup
        Its Coulomb friction is left out.
    elbow : float
        Elbow angle at which the mass matrix is taken, rad.

    Returns
    -------
    control.StateSpace
        Sampled; inputs are torques of shoulder and elbow, N m, held for a control period.
    """
    feedback: PID = setup.controller
    joints = plant(
        setup.arm.mass_matrix([0.0, elbow]), np.asarray(setup.effects.friction[0].coefficient)
    )
    return closed_loop(joints, feedback.kp, feedback.ki, feedback.kd, CONTROL_STEP)[:, 2:]


def through_loop(system, torque) -> np.ndarray:
    """What the linear loop makes of torques, shape (..., time, 2), rad.

    Parameters
    ----------
    system : control.StateSpace
        From `linear_loop`.
    torque : array_like, shape (..., time, 2)
        N m, a value for each control sample.
    """
    torque = np.asarray(torque)
    x = np.zeros((*torque.shape[:-2], system.nstates))
    found = np.empty(torque.shape)
    for k in range(torque.shape[-2]):
        found[..., k, :] = x @ system.C.T
        x = x @ system.A.T + torque[..., k, :] @ system.B.T
    return found


def predicted(setup: Setup, torque, reference: Trajectory) -> np.ndarray:
    """End-point error that the linear loop predicts for a feedforward, RMS in mm, shape (...).

    No motion is simulated: the torque that is missing goes through `linear_loop`, and joint errors
    to the hand by the Jacobian of the plan.

    Parameters
    ----------
    setup : Setup
    torque : ndarray, shape (..., time, 2)
        Feedforward for each control sample, N m.
    reference : Trajectory
    """
    system = linear_loop(setup, float(reference.q[..., 1].mean()))
    moving = (T >= 0) & (T < MOTION_SECONDS)
    error = through_loop(system, torque - with_impulse(setup)(*reference))[..., moving, :]
    gap = np.einsum("...ij,...j->...i", jacobian(setup.arm, reference.q[..., moving, :]), error)
    return 1e3 * np.sqrt((gap**2).sum(-1).mean(-1))


def logged_error(setup: Setup, model: TorqueModel, run: Recording) -> np.ndarray:
    """What a model's error on a recorded motion would do to the hand, RMS in mm, by member.

    The error of the torques, predicted less measured, goes through `linear_loop`. Nothing of it
    needs the model as a feedforward: a log, the feedback's gains and the arm's inertia are enough.

    Parameters
    ----------
    setup : Setup
    model : TorqueModel
        An ensemble.
    run : Recording
        One motion.
    """
    moving = run.motion
    missed = model.torque(sliding_windows(run.q, model.weights.width, moving)) - run.tau[moving]
    held = np.repeat(missed, round(run.step / CONTROL_STEP), axis=-2)
    system = linear_loop(setup, float(run.q[moving, 1].mean()))
    error = through_loop(system, held)
    J = np.repeat(jacobian(setup.arm, run.q[moving]), round(run.step / CONTROL_STEP), axis=0)
    gap = np.einsum("...ij,...j->...i", J, error)
    return 1e3 * np.sqrt((gap**2).sum(-1).mean(-1))
