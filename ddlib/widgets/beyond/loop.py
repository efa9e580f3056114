"""The loop with a learner inside: errors and estimates from motion to motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ddlib.control import FeedbackErrorLearning, RigidBodyTerms, pd
from ddlib.dynamics import with_load
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.experiments import JOINT_DAMPING, KD
from ddlib.experiments.setups import JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS
from ddlib.experiments.studies.loop.runs.adaptive import (
    FULL,
    SMOOTH,
    Behind,
    drawn,
    make,
    rates,
    trial,
)
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice

LOADS = (0, 5)
"""Loads in the hand, kg."""

SPEEDS = {
    "a tenth": 0.1,
    "as in the chapter": 1.0,
    "ten times": 10.0,
    "a hundred times": 100.0,
}
"""Rates of adaptation, as multiples of the chapter's."""

LEARNERS = ("none", "Slotine & Li", "Craig, Hsu & Sastry", "feedback-error learning")
"""Who learns."""

MOTIONS = 6
"""Motions one after another: the family's, with random extents."""

SHOWN = {"a": 0, "b": 1, "d": 2, "F_v1": 3, "F_c1": 5}
"""Estimates that are shown, and their places among the parameters."""

LABELS = dict(zip(SHOWN, ("a", "b", "d", "viscous, shoulder", "Coulomb, shoulder")))
"""What the chart calls them."""

MOST_ERROR = 20.0
"""Largest error that is shown, mm; a run that the guard stopped has a larger one, too."""

BOUNDS = (-2.0, 6.0)
"""Smallest and largest multiple of a true value that is shown."""

NOTE = (
    "Damped joints, an encoder of 12.5 bits, a tachometer; it begins with the base parameters of "
    "the arm without a load, and no friction. The hand's error is its root mean square over a "
    "motion, without the first third. A triangle: the error is larger, or the guard stopped the "
    "motion, or the estimate has left the chart."
)


@dataclass(frozen=True)
class _FeedbackError:
    """Feedback-error learning with the terms of the other laws; `estimate` are its weights."""

    estimate: np.ndarray
    factor: np.ndarray

    def start(self, reference, step):
        # with one gain for all joints it would be Slotine & Li's law at the desired state
        rate = rates("with friction", JOINT_DAMPING, self.factor) / KD[0]
        feedback = pd(JOINT_DAMPING.controller.kp, KD)
        learner = FeedbackErrorLearning(RigidBodyTerms(FULL), rate, self.estimate, feedback)
        return _Kept(learner.start(reference, step))


class _Kept:
    def __init__(self, law):
        self._law = law

    def __call__(self, k, q, qd):
        return self._law(k, q, qd)

    @property
    def estimate(self):
        return self._law.weights[..., -1, :]


@cache
def learned(load: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Errors (mm) and estimates of all learners, with and without friction, at all rates.

    Parameters
    ----------
    load : int
        kg.

    Returns
    -------
    dict
        By learner: errors of shape (friction, rate, motions), friction off first, and estimates
        of shape (friction, rate, motions + 1, parameters).
    """
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
    laws = {
        LEARNERS[0]: make("with friction", setup, factor=0.0),
        LEARNERS[1]: make("with friction", setup, factor=factor),
        LEARNERS[2]: make("measured acceleration", setup, factor=factor),
        LEARNERS[3]: Behind(_FeedbackError(laws_start(), factor), SMOOTH),
    }
    begin = laws_start()
    errors, estimates = [], [np.broadcast_to(begin, (len(laws), runs, len(FULL)))]
    for extents in drawn(1, MOTIONS, seed=11):
        done = trial(laws, np.tile(extents, (runs, 1)), arm, effects)
        laws = done.laws
        errors.append(np.minimum(done.settled, 1e3))  # of a stopped run it is infinite
        estimates.append(
            np.stack([np.broadcast_to(x.estimate, (runs, len(FULL))) for x in laws.values()])
        )
    errors, estimates = np.stack(errors, -1), np.stack(estimates, -2)
    shape = (2, len(speeds))
    return {
        name: (errors[k].reshape(*shape, -1), estimates[k].reshape(*shape, MOTIONS + 1, -1))
        for k, name in enumerate(LEARNERS)
    }


def laws_start() -> np.ndarray:
    """What all learners begin with: the arm without a load, and no friction."""
    return make("with friction", JOINT_DAMPING).estimate


class LoopLearner(CurveWidget):
    """Pick a load, friction, a learner and its rate; see the error fall, and the estimates.

    Parameters
    ----------
    **options
        Passed on to `CurveWidget`.
    """

    def __init__(self, **options):
        motions = np.arange(1, MOTIONS + 1)
        super().__init__(
            _curves,
            [
                Choice("load", "Load", {m: f"{m} kg" for m in LOADS}, 5, "slider"),
                Choice("friction", "Friction", {False: "off", True: "on"}, True, "switch"),
                Choice("learner", "Learner", list(LEARNERS), LEARNERS[1]),
                Choice("rate", "Rate", list(SPEEDS), "as in the chapter"),
            ],
            [
                Panel(
                    "Error of the hand, mm",
                    {"error": "with the learner", "nobody": "nothing learnt"},
                    "motion, number",
                    motions,
                    y_fit=True,
                    limits=(None, MOST_ERROR),
                ),
                Panel(
                    "Estimates over true values",
                    LABELS,
                    "motions done, number",
                    np.arange(MOTIONS + 1),
                    y_fit=True,
                    limits=BOUNDS,
                ),
            ],
            **{
                "alt": "Error of the hand from motion to motion with Slotine and Li's learner and "
                "without; below, estimates of a, b, d and of the shoulder's viscous and Coulomb "
                "friction as multiples of the true values.",
                "title": "The loop with a learner inside",
                "note": NOTE,
                "depends": {"nobody": ["load", "friction"]},
                **options,
            },
        )


def truth(load: int) -> np.ndarray:
    """The parameters that an arm with a load and friction has, in the order of `FULL`.

    Parameters
    ----------
    load : int
        kg.
    """
    arm = with_load(JOINT_DAMPING.arm, load)
    return np.array([arm.a, arm.b, arm.d, *JOINT_DAMPING_VISCOUS, *JOINT_DAMPING_COULOMB])


def _curves(load, friction, learner, rate) -> dict:
    found, k = learned(load), list(SPEEDS).index(rate)
    errors, estimates = found[learner]
    relative = estimates[int(friction), k] / truth(load)
    curves = {name: np.clip(relative[:, place], *BOUNDS) for name, place in SHOWN.items()}
    nobody = found[LEARNERS[0]][0][int(friction), 0]
    shown = np.minimum(errors[int(friction), k], MOST_ERROR)
    return {"error": shown, "nobody": nobody, **curves}
