"""The loop with a learner inside: errors and estimates from motion to motion."""

from __future__ import annotations

from functools import cache

import numpy as np

from beyond.studies.page.learner import SPEEDS
from ddlib.dynamics import with_load
from ddlib.setups import JOINT_DAMPING, JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from workshop.report import results

_SHOWN = {"a": 0, "b": 1, "d": 2, "F_v1": 3, "F_c1": 5}  # estimates, by place among the parameters
_LABELS = dict(zip(_SHOWN, ("a", "b", "d", "viscous, shoulder", "Coulomb, shoulder")))
_MOST_ERROR = 20.0  # mm, the largest that is shown; a run that the guard stopped has a larger one
_BOUNDS = (-2.0, 6.0)  # smallest and largest multiple of a true value that is shown

_NOTE = (
    "Damped joints, an encoder of 12.5 bits and a tachometer. The learner begins with the numbers "
    "of an empty hand, and no friction. The error leaves out the first third of each motion. A "
    "triangle: the value is off the chart, or the guard stopped the motion."
)


@cache
def _learned(load: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Committed errors (mm) and estimates of all learners, with and without friction."""
    found = results.read("loop-learner")["loads"][str(load)]
    return {
        name: tuple(np.array(one[key], dtype=float) for key in ("errors", "estimates"))
        for name, one in found.items()
    }


class LoopLearner(CurveWidget):
    """Pick a load, friction, a learner and its rate; see the error fall, and the estimates."""

    def __init__(self, **options):
        found = results.read("loop-learner")["loads"]
        loads, learners = list(map(int, found)), list(found["0"])
        number = len(found["0"]["none"]["errors"][0][0])
        motions = np.arange(1, number + 1)
        super().__init__(
            _curves,
            [
                Choice("load", "Load", {m: f"{m} kg" for m in loads}, 5, "slider"),
                Choice("friction", "Friction", {False: "off", True: "on"}, True, "switch"),
                Choice("learner", "Learner", learners, learners[1]),
                Choice("rate", "Rate", list(SPEEDS), "as in the chapter"),
            ],
            [
                Panel(
                    "Error of the hand, mm",
                    {"error": "with the learner", "nobody": "nothing learnt"},
                    "motion, number",
                    motions,
                    y_fit=True,
                    limits=(None, _MOST_ERROR),
                ),
                Panel(
                    "Estimates over true values",
                    _LABELS,
                    "motions done, number",
                    np.arange(number + 1),
                    y_fit=True,
                    limits=_BOUNDS,
                ),
            ],
            **{
                "alt": "Error of the hand from motion to motion with Slotine and Li's learner and "
                "without; below, estimates of a, b, d and of the shoulder's viscous and Coulomb "
                "friction as multiples of the true values.",
                "title": "The loop with a learner inside",
                "note": _NOTE,
                "depends": {"nobody": ["load", "friction"]},
                **options,
            },
        )


def _truth(load: int) -> np.ndarray:
    """The parameters that an arm with a load (kg) and friction has, in the order of `FULL`."""
    arm = with_load(JOINT_DAMPING.arm, load)
    return np.array([arm.a, arm.b, arm.d, *JOINT_DAMPING_VISCOUS, *JOINT_DAMPING_COULOMB])


def _curves(load, friction, learner, rate) -> dict:
    found, k = _learned(load), list(SPEEDS).index(rate)
    errors, estimates = found[learner]
    relative = estimates[int(friction), k] / _truth(load)
    curves = {name: np.clip(relative[:, place], *_BOUNDS) for name, place in _SHOWN.items()}
    nobody = found["none"][0][int(friction), 0]
    shown = np.minimum(errors[int(friction), k], _MOST_ERROR)
    return {"error": shown, "nobody": nobody, **curves}
