"""Conditions of findings on closed loops: parts of the study, small, against plain reckoning."""

from ddlib.setups import JOINT_DAMPING
from workshop.beyond.studies.loop.runs import conditions as study


def test_equations_need_the_copy_and_not_the_plan():
    found = study._copies(JOINT_DAMPING, range(1))
    error = {name: float(value[0]) for name, value in found.items()}
    assert error["0.1"] < 0.1 * error["0"] < error["none"]
