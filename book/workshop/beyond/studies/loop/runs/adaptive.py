"""Adaptive controllers side by side: the same motions, one trial after another, in one batch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ddlib.control import ComputedTorque, ControlLaw, Controller, as_controller, pd
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, Effects
from ddlib.setups import KD, Setup
from ddlib.simulation import CONTROL_STEP, follow
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS, Trajectory, pick_and_place
from workshop.beyond.control.adaptive.craig import CraigHsuSastry
from workshop.beyond.control.adaptive.model_reference import ModelReference
from workshop.beyond.control.adaptive.regressor import PARAMETERS, mixed_regressor
from workshop.beyond.control.adaptive.slotine_li import SlotineLi
from workshop.beyond.control.guarded import Guarded

RIGID = PARAMETERS[:3]
FRICTION = PARAMETERS[5:]
FULL = (*RIGID, *FRICTION)
"""Parameters that are adapted: the horizontal arm's, without and with friction."""

TRUTH = np.array([CMU_DD_ARM_II.a, CMU_DD_ARM_II.b, CMU_DD_ARM_II.d])
"""Base parameters of the arm without a load."""

INERTIA = np.array([CMU_DD_ARM_II.a + 2 * CMU_DD_ARM_II.b, CMU_DD_ARM_II.d])
"""What the joints of the stretched arm turn, each with the other at rest, kg m^2."""

SIZES = np.array([5.0, 0.5, 0.5, 5.0, 1.0, 1.5, 0.5])
"""Sizes of the parameters, in their units: rates are measured by their squares. Assumed."""

BOX = np.array([2.6, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0]), np.array([14.0, 4.0, 2.5, 20.0, 5.0, 8.0, 3.0])
"""Box of the estimates of Craig, Hsu & Sastry: it holds the arm with 10 kg. Assumed."""

AFTER = 0.1
"""Rest recorded before and after each motion, s."""

LAWS = ("rigid body", "with friction", "measured acceleration", "joint models")
"""Adaptive laws: Slotine & Li without and with friction among the parameters; Craig, Hsu & Sastry
with it; model-reference control of each joint."""

RATES = {
    "joint damping": dict(zip(LAWS, (3.0, 3.0, 10.0, 0.01))),
    "state feedback": dict(zip(LAWS, (3.0, 10.0, 10.0, 0.3))),
}
"""Rates of adaptation: chosen by the eye from a grid of nine on four motions of another seed, for
each law and set-up the quickest that settles."""


@dataclass(frozen=True)
class Beside:
    """Controllers side by side: the first axis of the runs says whose they are.

    Parameters
    ----------
    controllers : tuple of Controller
    """

    controllers: tuple[Controller, ...]

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """One law for all; ``law.laws`` are the controllers' own."""
        return _Together(
            [
                as_controller(c).start(Trajectory(*(x[i] for x in reference)), step)
                for i, c in enumerate(self.controllers)
            ]
        )


class _Together:
    def __init__(self, laws):
        self.laws = laws

    def __call__(self, k, q, qd):
        return np.stack([law(k, q[i], qd[i]) for i, law in enumerate(self.laws)])


@dataclass(frozen=True)
class Behind:
    """A controller that follows the motion of a linear model in place of the reference.

    Where the reference's velocity jumps, the model's does not.

    Parameters
    ----------
    controller : Controller
    model : ModelReference
        Its linear model.
    """

    controller: Controller
    model: ModelReference

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law of the controller along the model's motion."""
        return self.controller.start(self.model.model(reference, step), step)

    @property
    def estimate(self):
        """That of the controller."""
        return self.controller.estimate


POLE = 7.0
"""Both poles of the model that smooths the reference, 1/s: at the family's largest jump the arm
without a load stays below `LIMITS`."""

SMOOTH = ModelReference((POLE**2,) * 2, (2 * POLE,) * 2, (POLE,) * 2, np.zeros(8), np.zeros(8))
"""Only its model is used."""


def taught(controller: Controller, estimate) -> Controller:
    """The controller with other estimates to begin with; others than adaptive ones as they are."""
    if not hasattr(controller, "estimate"):
        return controller
    if isinstance(controller, Behind):
        return replace(controller, controller=taught(controller.controller, estimate))
    return replace(controller, estimate=estimate)


LIMITS = np.array(CMU_DD_ARM_II_EFFECTS.actuator[0].limit)
"""Torques that the motors can give, N m."""


class Able:
    """Mixed into a law: it learns nothing while it asks for more torque than the motors have."""

    def advance(self, law, estimate, wanted, q, qd):
        """Torque of a running law, and its estimate one period later."""
        torque, after = super().advance(law, estimate, wanted, q, qd)
        able = (np.abs(torque) <= LIMITS).all(-1, keepdims=True)
        return torque, np.where(able, after, estimate)


class AbleSlotineLi(Able, SlotineLi):
    """`SlotineLi` that learns while the motors are able."""


class AbleCraig(Able, CraigHsuSastry):
    """`CraigHsuSastry` that learns while the motors are able."""


class AbleModelReference(Able, ModelReference):
    """`ModelReference` that learns while the motors are able."""


def gains(setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """The slope of a set-up, 1/s, and its linear loop: (a0, a1) of ``e'' + a1 e' + a0 e``.

    All laws have the damping term `KD` and the set-up's proportional gain; with the right
    parameters all have this loop at the stretched arm without a load.
    """
    slope = np.asarray(setup.controller.kp) / KD
    return slope, np.stack([slope * KD / INERTIA, slope + KD / INERTIA])


def rates(law: str, setup: Setup, factor=1.0) -> np.ndarray:
    """Speeds of adaptation of a `law` in a `setup`, times a `factor` of shape (...)."""
    speed = RATES[setup.name][law] * np.asarray(factor, float)[..., None]
    if law == "joint models":
        return speed * np.concatenate([m**2 * np.array([1, 2e3, 1e2, 2e3]) for m in INERTIA])
    return speed * (SIZES[:3] if law == "rigid body" else SIZES) ** 2


def make(law: str, setup: Setup, start=None, factor=1.0, *, jumps=False, **options):
    """An adaptive controller of a set-up, behind `SMOOTH`; "joint models" have a model anyway.

    Parameters
    ----------
    law : str
        Of `LAWS`.
    setup : Setup
    start : array_like, shape (..., 3) or (..., 7), optional
        Base parameters to begin with, and friction; default: those of the arm without a load. No
        friction, if it is not given.
    factor : float or array_like, shape (...)
        Times the law's rate.
    jumps : bool
        Follow the reference itself, whose velocity jumps, and learn whatever the motors can do.
    **options
        Of the controller.
    """
    slope, (a0, a1) = gains(setup)
    start = TRUTH if start is None else np.asarray(start, float)
    rate = rates(law, setup, factor)
    if law == "joint models":
        own = np.stack([start[..., 0] + 2 * start[..., 1], start[..., 2]], -1)
        each = np.stack([own, a0 * own, a1 * own, 0 * own], -1)
        return AbleModelReference(a0, a1, a1 / 2, rate, each.reshape(*own.shape[:-1], 8), **options)
    names = RIGID if law == "rigid body" else FULL
    missing = np.zeros((*start.shape[:-1], len(names) - start.shape[-1]))
    first = np.concatenate([start, missing], -1)
    if law == "measured acceleration":
        made = AbleCraig(a0, a1, a1 / 2, rate, first, *BOX, names, **options)
    else:
        kind = SlotineLi if jumps else AbleSlotineLi
        made = kind(KD, slope, rate, first, names, **options)
    return made if jumps else Behind(made, SMOOTH)


def fixed(setup: Setup) -> dict[str, Controller]:
    """What the adaptive laws are compared with: PD, and computed torque without a load."""
    _, (a0, a1) = gains(setup)
    return {
        "PD": pd(setup.controller.kp, KD),
        "computed torque": Behind(ComputedTorque(CMU_DD_ARM_II, a0, a1), SMOOTH),
    }


class Trial(NamedTuple):
    """What became of one motion, runs of shape (laws, runs).

    Attributes
    ----------
    hand, settled : ndarray, shape (laws, runs)
        Root mean square of the hand's error over the motion, mm; without its first third.
    stops : Stops
    laws : dict
        The controllers with what they know after it.
    """

    hand: np.ndarray
    settled: np.ndarray
    stops: object
    laws: dict


def trial(laws: Mapping[str, Controller], extents, arm: Arm, effects: Effects, **options) -> Trial:
    """One motion of all laws side by side.

    Parameters
    ----------
    laws : mapping
        Controllers by name.
    extents : array_like, shape (runs, 2)
        Degrees.
    arm, effects
        The plant.
    **options
        ``velocity``, as in `ddlib.simulation.follow`.
    """
    steps = np.arange(-round(AFTER / CONTROL_STEP), round((MOTION_SECONDS + AFTER) / CONTROL_STEP))
    t = steps * CONTROL_STEP
    reference = pick_and_place(extents, t)
    reference = Trajectory(*(np.broadcast_to(x, (len(laws), *x.shape)) for x in reference))
    kept = []

    class _Kept(Guarded):
        def start(self, reference, step):
            kept.append(super().start(reference, step))
            return kept[0]

    guard = _Kept(Beside(tuple(laws.values())))
    log = follow(arm, guard, reference, t, effects=effects, duration=MOTION_SECONDS, **options)
    hand, wanted = (arm.forward_kinematics(x)[..., 1, :] for x in (log.q_true, log.reference.q))
    off = 1e3 * np.linalg.norm(hand - wanted, axis=-1)
    stops = kept[0].stops
    running = stops.running(log.t)
    off = np.where(running, off, np.nan)[..., log.motion]
    third = off.shape[-1] // 3

    def rms(x):
        return np.where(stops.stopped, np.inf, np.sqrt((x**2).mean(-1)))

    after = {
        name: taught(law, getattr(own, "estimate", None))
        for (name, law), own in zip(laws.items(), kept[0].inner.laws)
    }
    return Trial(rms(off), rms(off[..., third:]), stops, after)


@dataclass(frozen=True)
class Rounded:
    """Readings rounded to a step of each run's own, after a shift of its own; 0: not rounded.

    Parameters
    ----------
    step, shift : array_like, shape (..., 1) and (..., 2)
        rad.
    """

    step: np.ndarray
    shift: np.ndarray

    def apply(self, x, rng=None):
        """The readings of `x`, rad."""
        step = np.where(self.step > 0, self.step, 1.0)
        found = np.round((x + self.shift) / step) * step - self.shift
        return np.where(self.step > 0, found, x)


def rounding(setup: Setup, runs: int, seed: int, step=None) -> Effects:
    """The set-up's effects with an encoder's zero of its own in each run.

    Parameters
    ----------
    setup : Setup
    runs, seed : int
        How many; of the zeros.
    step : array_like, shape (runs,), optional
        Steps of the encoders, rad; default: the set-up's.
    """
    step = np.full(runs, setup.effects.encoder[0].step) if step is None else np.asarray(step)
    shift = np.random.default_rng(seed).uniform(0, 1, (runs, 2)) * step[:, None]
    return replace(setup.effects, encoder=(Rounded(step[:, None], shift),))


def trials(laws, extents, arm: Arm, effects: Effects, **options) -> tuple[list[Trial], dict]:
    """Motions one after another, each law with what it has learnt; and the laws at the end.

    Parameters
    ----------
    laws, arm, effects, **options
        As in `trial`.
    extents : array_like, shape (trials, runs, 2)
    """
    found = []
    for each in extents:
        found.append(trial(laws, each, arm, effects, **options))
        laws = found[-1].laws
    return found, laws


def drawn(runs: int, count: int, seed: int) -> np.ndarray:
    """Random extents of the family, degrees, shape `(count, runs, 2)`, by a `seed`."""
    return np.random.default_rng(seed).uniform(0, MAX_EXTENT_DEG, (count, runs, 2))


def by_law(found: list[Trial], laws, what: str = "settled") -> dict[str, np.ndarray]:
    """Errors of the trials `found` by the names of `laws`, shape (trials, runs), mm.

    Of `Trial` it is the attribute `what`.
    """
    return {name: np.stack([getattr(t, what)[k] for t in found]) for k, name in enumerate(laws)}


def excitation(extents) -> np.ndarray:
    """Integral of Y'Y along motions, for base parameters as shares of the true ones.

    Parameters
    ----------
    extents : array_like, shape (..., 2)
        Degrees.

    Returns
    -------
    ndarray, shape (..., 3, 3)
        (N m)^2 s.
    """
    t = (np.arange(1500) + 0.5) * 0.002
    wanted = pick_and_place(extents, t)
    Y = mixed_regressor(wanted.q, wanted.qd, wanted.qd, wanted.qdd) * TRUTH
    return np.einsum("...tjp,...tjk->...pk", Y, Y) * 0.002


def sampled_lyapunov(law: SlotineLi, reference, t, effects: Effects) -> np.ndarray:
    """The Lyapunov function at each control sample of runs without friction, (..., time).

    Parameters
    ----------
    law : SlotineLi
        Of the rigid body.
    reference : Trajectory
    t : array_like, shape (time,)
    effects : Effects
    """
    kept = []

    class _Kept:
        def start(self, reference, step):
            kept.append(law.start(reference, step))
            return kept[0]

    log = follow(CMU_DD_ARM_II, _Kept(), reference, t, effects=effects, log_every=1)
    estimates = np.broadcast_to(
        kept[0].estimates[..., :-1, :], (*log.q_true.shape[:-1], len(law.names))
    )
    return law.lyapunov(CMU_DD_ARM_II, TRUTH, estimates, log.reference, log.q_true, log.qd_true)
