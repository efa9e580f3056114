"""Adaptive controllers side by side: the same motions, one trial after another, in one batch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from beyond.control.adaptive import (
    PARAMETERS,
    CraigHsuSastry,
    ModelReference,
    SlotineLi,
    Watched,
    mixed_regressor,
)
from beyond.control.guarded import Stops
from beyond.studies.loop.abreast import repeated, run_abreast
from ddlib.control import ComputedTorque, ControlLaw, Controller, pd
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, Effects
from ddlib.setups import KD, Setup
from ddlib.simulation import CONTROL_STEP, follow
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS, Trajectory, pick_and_place

_RIGID = PARAMETERS[:3]
_FRICTION = PARAMETERS[5:]
WITH_FRICTION = (*_RIGID, *_FRICTION)
TRUTH = np.array([CMU_DD_ARM_II.a, CMU_DD_ARM_II.b, CMU_DD_ARM_II.d])  # without a load
_INERTIA = np.array([CMU_DD_ARM_II.a + 2 * CMU_DD_ARM_II.b, CMU_DD_ARM_II.d])  # kg m^2, stretched

# Sizes of the parameters: rates go by their squares. Assumed.
SIZES = np.array([5.0, 0.5, 0.5, 5.0, 1.0, 1.5, 0.5])

# Box of the estimates of Craig, Hsu & Sastry: it holds the arm with 10 kg. Assumed.
_BOX = np.array([[2.6, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0], [14.0, 4.0, 2.5, 20.0, 5.0, 8.0, 3.0]])
_AFTER = 0.1  # s, rest before and after each motion

# Slotine & Li without and with friction; Craig, Hsu & Sastry; a reference model of each joint.
LAWS = ("rigid body", "with friction", "measured acceleration", "joint models")

# Of a grid of nine, on four motions of another seed, the quickest that settles.
_RATES = {
    "joint damping": dict(zip(LAWS, (3.0, 3.0, 10.0, 0.01))),
    "state feedback": dict(zip(LAWS, (3.0, 10.0, 10.0, 0.3))),
}


@dataclass(frozen=True)
class BehindModel:
    """A controller that follows the motion of a linear model: its velocity never jumps."""

    controller: Controller
    model: ModelReference

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The controller's law, with the model's motion for a reference."""
        return self.controller.start(self.model.model(reference, step), step)

    @property
    def estimate(self):
        """What the controller inside takes for true."""
        return self.controller.estimate


_POLE = 7.0  # 1/s, twice: without a load the arm stays below `LIMITS` at the largest jump

SMOOTH = ModelReference((_POLE**2,) * 2, (2 * _POLE,) * 2, (_POLE,) * 2, np.zeros(8), np.zeros(8))


def _taught(controller: Controller, estimate) -> Controller:
    """The controller with other estimates to begin with."""
    if isinstance(controller, BehindModel):
        return replace(controller, controller=replace(controller.controller, estimate=estimate))
    return replace(controller, estimate=estimate)


LIMITS = np.array(CMU_DD_ARM_II_EFFECTS.actuator[0].limit)  # N m, of the motors


def gains(setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Slope of a set-up, 1/s, and its linear loop: (a0, a1) of ``e'' + a1 e' + a0 e``."""
    slope = np.asarray(setup.controller.kp) / KD
    return slope, np.stack([slope * KD / _INERTIA, slope + KD / _INERTIA])


def rates_of_adaptation(law: str, setup: Setup, factor=1.0) -> np.ndarray:
    """Speeds of adaptation of a `law` in a `setup`, times a `factor` of shape (...)."""
    speed = _RATES[setup.name][law] * np.asarray(factor, float)[..., None]
    if law == "joint models":
        return speed * np.concatenate([m**2 * np.array([1, 2e3, 1e2, 2e3]) for m in _INERTIA])
    return speed * (SIZES[:3] if law == "rigid body" else SIZES) ** 2


def make(law: str, setup: Setup, start=None, factor=1.0, *, jumps=False, **options):
    """An adaptive controller of a set-up, behind `SMOOTH`; "joint models" have a model anyway.

    It begins with the parameters ``start``, shape (..., 3) or with friction (..., 7); without it
    with those of the arm without a load. ``factor`` multiplies the law's rate. With ``jumps`` it
    follows the reference itself, and learns whatever the motors can do.
    """
    slope, (a0, a1) = gains(setup)
    start = TRUTH if start is None else np.asarray(start, float)
    rate = rates_of_adaptation(law, setup, factor)
    if law == "joint models":
        own = np.stack([start[..., 0] + 2 * start[..., 1], start[..., 2]], -1)
        each = np.stack([own, a0 * own, a1 * own, 0 * own], -1)
        each = each.reshape(*own.shape[:-1], 8)
        return ModelReference(a0, a1, a1 / 2, rate, each, limit=LIMITS, **options)
    names = _RIGID if law == "rigid body" else WITH_FRICTION
    missing = np.zeros((*start.shape[:-1], len(names) - start.shape[-1]))
    first = np.concatenate([start, missing], -1)
    if law == "measured acceleration":
        controller = CraigHsuSastry(a0, a1, a1 / 2, rate, first, *_BOX, names, **options)
    else:
        controller = SlotineLi(KD, slope, rate, first, names, **options)
    return controller if jumps else BehindModel(replace(controller, limit=LIMITS), SMOOTH)


def fixed_laws(setup: Setup) -> dict[str, Controller]:
    """What the adaptive laws are compared with: PD, and computed torque without a load."""
    _, (a0, a1) = gains(setup)
    return {
        "PD": pd(setup.controller.kp, KD),
        "computed torque": BehindModel(ComputedTorque(CMU_DD_ARM_II, a0, a1), SMOOTH),
    }


class _Trial(NamedTuple):
    """What became of one motion; arrays have shape (laws, runs)."""

    hand: np.ndarray  # root mean square of the hand's error, mm
    settled: np.ndarray  # the same without the motion's first third
    stops: Stops
    laws: dict  # the controllers with what they know after it


def trial(laws: Mapping[str, Controller], extents, arm: Arm, effects: Effects,
          plan=pick_and_place, **options) -> _Trial:  # fmt: skip
    """One motion of extents ``(runs, 2)``, degrees, by a `plan`, of all laws side by side."""
    steps = np.arange(
        -round(_AFTER / CONTROL_STEP), round((MOTION_SECONDS + _AFTER) / CONTROL_STEP)
    )
    t = steps * CONTROL_STEP
    options = {"effects": effects, "duration": MOTION_SECONDS, **options}
    reference = repeated(plan(extents, t), len(laws))
    log, gap, stops, ended = run_abreast(
        arm, list(laws.values()), [1] * len(laws), reference, t, **options
    )
    off = np.where(stops.running(log.t), 1e3 * gap, np.nan)[..., log.motion]
    third = off.shape[-1] // 3

    def rms(x):
        return np.where(stops.stopped, np.inf, np.sqrt((x**2).mean(-1)))

    after = {
        name: _taught(law, own.estimate[0]) if hasattr(own, "estimate") else law
        for (name, law), own in zip(laws.items(), ended)
    }
    return _Trial(rms(off), rms(off[..., third:]), stops, after)


@dataclass(frozen=True)
class RoundedReadings:
    """Readings rounded to a step of each run's own, after a shift of its own; 0: not rounded."""

    step: np.ndarray
    shift: np.ndarray

    def apply(self, x, rng=None):
        """Readings of `x`, rounded."""
        step = np.where(self.step > 0, self.step, 1.0)
        rounded = np.round((x + self.shift) / step) * step - self.shift
        return np.where(self.step > 0, rounded, x)


def with_rounding(setup: Setup, runs: int, seed: int, step=None) -> Effects:
    """The set-up's effects, in each run with an encoder's zero (and step) of its own."""
    step = np.full(runs, setup.effects.encoder[0].step) if step is None else np.asarray(step)
    shift = np.random.default_rng(seed).uniform(0, 1, (runs, 2)) * step[:, None]
    return replace(setup.effects, encoder=(RoundedReadings(step[:, None], shift),))


def run_trials(laws, extents, arm: Arm, effects: Effects, **options) -> tuple[list[_Trial], dict]:
    """Motions ``(trials, runs, 2)`` one after another, and the laws with what they have learnt."""
    trials = []
    for each in extents:
        trials.append(trial(laws, each, arm, effects, **options))
        laws = trials[-1].laws
    return trials, laws


def drawn_extents(runs: int, count: int, seed: int) -> np.ndarray:
    """Random extents of the family, degrees, shape `(count, runs, 2)`, by a `seed`."""
    return np.random.default_rng(seed).uniform(0, MAX_EXTENT_DEG, (count, runs, 2))


def errors_by_law(found: list[_Trial], laws, what: str = "settled") -> dict[str, np.ndarray]:
    """Errors of trials (an attribute of theirs) by law, shape (trials, runs), mm."""
    return {name: np.stack([getattr(t, what)[k] for t in found]) for k, name in enumerate(laws)}


def excitation(extents) -> np.ndarray:
    """Integral of Y'Y along motions, for base parameters as shares of the true ones, (N m)^2 s."""
    t = (np.arange(1500) + 0.5) * 0.002
    wanted = pick_and_place(extents, t)
    Y = mixed_regressor(wanted.q, wanted.qd, wanted.qd, wanted.qdd) * TRUTH
    return np.einsum("...tjp,...tjk->...pk", Y, Y) * 0.002


def sampled_lyapunov(law: SlotineLi, reference, t, effects: Effects) -> np.ndarray:
    """The Lyapunov function at each control sample of runs without friction, (..., time)."""
    watched = Watched(law)
    log = follow(CMU_DD_ARM_II, watched, reference, t, effects=effects, log_every=1)
    estimates = watched.law.estimates[..., :-1, :]
    estimates = np.broadcast_to(estimates, (*log.q_true.shape[:-1], len(law.names)))
    return law.lyapunov(CMU_DD_ARM_II, TRUTH, estimates, log.reference, log.q_true, log.qd_true)
