"""What a reader sees who picks a learner for the loop: its errors and estimates, by motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beyond.control.feedback_error import FeedbackErrorLearning, RigidBodyTerms
from beyond.studies.loop.runs.adaptive import (
    _FULL,
    SMOOTH,
    _Behind,
    _drawn,
    _rates,
    make,
    trial,
)
from ddlib.control import pd
from ddlib.dynamics import with_load
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.setups import JOINT_DAMPING, JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS, KD
from workshop.report.code_hash import study

_LOADS = (0, 5)  # kg, in the hand

# Rates of adaptation, as multiples of the chapter's.
SPEEDS = {
    "a tenth": 0.1,
    "as in the chapter": 1.0,
    "ten times": 10.0,
    "a hundred times": 100.0,
}

_LEARNERS = ("none", "Slotine & Li", "Craig, Hsu & Sastry", "feedback-error learning")
_MOTIONS = 6  # one after another, with random extents


@dataclass(frozen=True)
class _FeedbackError:
    """Feedback-error learning with the terms of the other laws; `estimate` are its weights."""

    estimate: np.ndarray
    factor: np.ndarray

    def start(self, reference, step):
        # with one gain for all joints it would be Slotine & Li's law at the desired state
        rate = _rates("with friction", JOINT_DAMPING, self.factor) / KD[0]
        feedback = pd(JOINT_DAMPING.controller.kp, KD)
        learner = FeedbackErrorLearning(RigidBodyTerms(_FULL), rate, self.estimate, feedback)
        return _Kept(learner.start(reference, step))


class _Kept:
    def __init__(self, law):
        self._law = law

    def __call__(self, k, q, qd):
        return self._law(k, q, qd)

    @property
    def estimate(self):
        return self._law.weights[..., -1, :]


def _learned(load: int) -> dict[str, dict[str, np.ndarray]]:
    """Errors (mm; friction, rate, motions) and estimates of all learners."""
    setup, speeds = JOINT_DAMPING, list(SPEEDS.values())
    runs = 2 * len(speeds)
    factor = np.tile(speeds, 2)
    on = np.repeat([0.0, 1.0], len(speeds))[:, None]
    effects = Effects(
        friction=(
            ViscousFriction(on * JOINT_DAMPING_VISCOUS), CoulombFriction(on * JOINT_DAMPING_COULOMB)
        ),
        actuator=setup.effects.actuator,
        encoder=setup.effects.encoder,
    )  # fmt: skip
    arm = with_load(setup.arm, load)
    begin = make("with friction", setup).estimate  # the arm without a load, and no friction
    laws = {
        _LEARNERS[0]: make("with friction", setup, factor=0.0),
        _LEARNERS[1]: make("with friction", setup, factor=factor),
        _LEARNERS[2]: make("measured acceleration", setup, factor=factor),
        _LEARNERS[3]: _Behind(_FeedbackError(begin, factor), SMOOTH),
    }
    errors, estimates = [], [np.broadcast_to(begin, (len(laws), runs, len(_FULL)))]
    for extents in _drawn(1, _MOTIONS, seed=11):
        done = trial(laws, np.tile(extents, (runs, 1)), arm, effects)
        laws = done.laws
        errors.append(np.minimum(done.settled, 1e3))  # of a stopped run it is infinite
        estimates.append(
            np.stack([np.broadcast_to(x.estimate, (runs, len(_FULL))) for x in laws.values()])
        )
    errors, estimates = np.stack(errors, -1), np.stack(estimates, -2)
    shape = (2, len(speeds))
    return {
        name: {
            "errors": errors[k].reshape(*shape, -1),
            "estimates": estimates[k].reshape(*shape, _MOTIONS + 1, -1),
        }
        for k, name in enumerate(_LEARNERS)
    }


@study
def _loop_learner() -> dict:
    """Errors (mm) and estimates of all learners, by load."""
    return {"loads": {str(load): _learned(load) for load in _LOADS}}
