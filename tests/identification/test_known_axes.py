"""Terms of an arm whose axes are known: they span the torques of arms with all the rest unknown."""

import numpy as np
import pytest

from ddlib.dynamics import SerialArm, SpatialLink
from ddlib.identification import joint_columns, joint_terms

RNG = np.random.default_rng(0)
GRAVITY = (0.0, 0.0, -9.81)


def link(twist, length, offset, mass, com, moments):
    return SpatialLink(twist, length, offset, mass, com, np.diag(moments))


PAIR = SerialArm(
    (
        link(-90.0, 0.0, 0.4, 8.0, (0.0, 0.1, 0.0), (0.3, 0.2, 0.3)),
        link(0.0, 0.3, 0.0, 6.0, (-0.13, 0.02, 0.0), (0.02, 0.1, 0.09)),
        link(0.0, 0.25, 0.0, 4.0, (-0.1, -0.03, 0.0), (0.01, 0.05, 0.06)),
    ),
    GRAVITY,
)
"""Axis 1 upright, axes 2 and 3 level; every mass in the plane of the pair."""

WRIST = SerialArm(
    (
        link(-90.0, 0.0, 0.3, 5.0, (0.0, 0.0, 0.0), (0.1, 0.1, 0.1)),
        link(0.0, 0.2, 0.0, 4.0, (-0.1, 0.0, 0.0), (0.01, 0.05, 0.05)),
        link(90.0, 0.0, 0.0, 2.0, (0.0, 0.0, 0.05), (0.02, 0.02, 0.01)),
        link(-90.0, 0.0, 0.2, 1.0, (0.0, 0.05, 0.0), (0.004, 0.002, 0.004)),
        link(90.0, 0.0, 0.0, 0.3, (0.0, 0.0, 0.0), (0.001, 0.001, 0.001)),
        link(0.0, 0.0, 0.1, 0.5, (0.0, 0.0, -0.03), (0.001, 0.001, 0.0004)),
    ),
    GRAVITY,
)
"""Six joints; the wrist's weight hangs on axis 6."""


def left(columns, torque) -> float:
    fit = columns @ np.linalg.lstsq(columns, torque, rcond=1e-12)[0]
    return float(np.abs(fit - torque).max() / np.abs(torque).max())


def moving(cases=400):
    return RNG.uniform(-2, 2, (cases, 6, 3))


@pytest.mark.parametrize("joint", range(3))
def test_the_first_three_joints_of_any_such_arm(joint):
    states = moving()
    torque = PAIR.inverse_dynamics(*np.moveaxis(states[:, :3], -1, 0))[:, joint]
    assert left(joint_columns(states, joint, friction=False), torque) < 1e-9


@pytest.mark.parametrize("joint", range(1, 6))
def test_weight_at_rest_on_all_six(joint):
    states = moving()
    states[..., 1:] = 0
    torque = WRIST.inverse_dynamics(*np.moveaxis(states, -1, 0))[:, joint]
    columns = joint_columns(states, joint, friction=False)
    if joint == 5:
        np.testing.assert_allclose(torque, 0, atol=1e-12)
    elif joint > 2:
        assert left(columns, torque) < 1e-9 < np.abs(torque).max()
    else:  # the wrist's own weight is not among the terms of joints 2 and 3
        assert left(columns, torque) < 0.1


def test_friction_is_of_the_joint_and_of_motor_six():
    states = moving()
    terms, v = joint_terms(states), states[..., 1]
    for j, row in enumerate(terms):
        np.testing.assert_array_equal(row["velocity"], v[:, j])
        whole, bare = joint_columns(states, j), joint_columns(states, j, friction=False)
        assert whole.shape[1] - bare.shape[1] == (4 if j in (4, 5) else 2)
    for row in terms[4:]:
        assert (np.sign(row["sign, motor 6"]) == np.sign(v[:, 4] + v[:, 5])).all()
