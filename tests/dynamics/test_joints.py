"""An arm of up to seven joints: against the two-link arm, and against a rigid-body library."""

import sys

import numpy as np
import pytest

from ddlib.dynamics import (
    CMU_DD_ARM_II,
    DD_ARM_II_IN_SPACE,
    PUMA_560,
    SerialArm,
    SpatialLink,
    hand,
    inertial_parameters,
    locked,
    mass_matrix,
    regressor,
)
from ddlib.dynamics.joints import frames

if sys.platform != "win32":  # no wheels there, as requirements.txt says
    import pinocchio

SIZES = np.array([np.pi, 5.0, 20.0])[:, None, None]


def states(joints, n=40, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (3, n, joints)) * SIZES


def askew(joints, seed=5) -> SerialArm:
    """Links of any twist, offset, centre and inertia; gravity aslant."""
    rng = np.random.default_rng(seed)
    links = []
    for _ in range(joints):
        root = rng.normal(size=(3, 3))
        inertia = root @ root.T + (root @ root.T).T
        place = rng.uniform(-180, 180), *rng.uniform(-1, 1, 2)
        links.append(SpatialLink(*place, 1 + rng.random(), rng.normal(size=3), inertia))
    return SerialArm(links, rng.normal(size=3) * 5)


ARMS = {
    "four joints": locked(DD_ARM_II_IN_SPACE, 4),
    "seven joints": DD_ARM_II_IN_SPACE,
    "four askew": askew(4),
    "seven askew": askew(7),
    "PUMA 560": PUMA_560,
}


def test_with_the_others_locked_it_is_the_arm_of_the_book():
    motion, two = states(2, 200), locked(DD_ARM_II_IN_SPACE, 2)
    wanted = CMU_DD_ARM_II.inverse_dynamics(*motion)
    np.testing.assert_allclose(
        two.inverse_dynamics(*motion), wanted, rtol=0, atol=1e-12 * np.abs(wanted).max()
    )
    wanted = CMU_DD_ARM_II.mass_matrix(motion[0])
    np.testing.assert_allclose(mass_matrix(two, motion[0]), wanted, rtol=0, atol=1e-12)


@pytest.mark.parametrize("joints", range(1, 7))
def test_a_locked_arm_is_the_whole_one_at_rest_beyond(joints):
    motion = states(joints)
    whole = np.concatenate([motion, np.zeros((3, 40, 7 - joints))], -1)
    arm = locked(DD_ARM_II_IN_SPACE, joints)
    tau = DD_ARM_II_IN_SPACE.inverse_dynamics(*whole)[:, :joints]
    np.testing.assert_allclose(arm.inverse_dynamics(*motion), tau, atol=1e-12 * np.abs(tau).max())
    np.testing.assert_allclose(hand(arm, motion[0]), hand(DD_ARM_II_IN_SPACE, whole[0]), atol=1e-14)


def test_locking_elsewhere_and_in_vain():
    bent = np.array([0, 0, 0, 0.5, 0, 0, 0])
    with pytest.raises(ValueError, match="posture must leave the hand on the x axis of link 3"):
        locked(DD_ARM_II_IN_SPACE, 3, bent)
    assert locked(DD_ARM_II_IN_SPACE, 7) is DD_ARM_II_IN_SPACE
    with pytest.raises(ValueError, match="joints must be an integer from 1 to 7"):
        locked(DD_ARM_II_IN_SPACE, 8)


def test_gravity_acts_on_level_joints_only():
    held = DD_ARM_II_IN_SPACE.inverse_dynamics(*np.zeros((3, 7)))
    np.testing.assert_allclose(held[[0, 1, 3, 5]], 0, atol=1e-15)
    assert (held[[2, 4, 6]] > 0.05).all(), "level axes carry what lies beyond them"
    lifted = np.array([0, 0, 0.3, 0, 0, 0, 0])
    assert hand(DD_ARM_II_IN_SPACE, lifted)[2] > 0.05, "a positive angle lifts the hand"
    np.testing.assert_allclose(hand(DD_ARM_II_IN_SPACE, np.zeros(7)), [0.9, 0, 0], atol=1e-14)


@pytest.mark.parametrize("name", ARMS)
def test_torque_is_linear_in_the_inertial_parameters(name):
    arm, motion = ARMS[name], states(ARMS[name].joints, 10)
    values = np.concatenate([inertial_parameters(link) for link in arm.links])
    tau = arm.inverse_dynamics(*motion)
    found = regressor(arm, *motion) @ values
    np.testing.assert_allclose(found, tau, rtol=0, atol=1e-11 * np.abs(tau).max())


def test_what_moves_the_joints_are_few_combinations():
    """Each joint beyond the first adds up to seven base parameters (Gautier & Khalil 1990)."""
    ranks = []
    for n in (1, 2, 3, 4, 7):
        matrix = regressor(locked(DD_ARM_II_IN_SPACE, n), *states(n))
        ranks.append(np.linalg.matrix_rank(matrix.reshape(-1, 10 * n)))
    assert ranks == [1, 4, 11, 18, 39]


# --- against Pinocchio ------------------------------------------------------------------


def model(arm: SerialArm):
    """The same arm for Pinocchio: a joint about z, then the link's frame as a fixed place."""
    made = pinocchio.Model()
    made.gravity.linear = np.array(arm.gravity)
    parent, place = 0, pinocchio.SE3.Identity()
    for i, k in enumerate(arm.links):
        parent = made.addJoint(parent, pinocchio.JointModelRZ(), place, f"joint {i + 1}")
        turn = pinocchio.utils.rotate("x", np.deg2rad(k.twist_deg))
        place = pinocchio.SE3(turn, np.array([k.length, 0.0, k.offset]))
        body = pinocchio.Inertia(k.mass, np.array(k.com), np.array(k.inertia))
        made.appendBodyToJoint(parent, body, place)
    kind = pinocchio.FrameType.OP_FRAME
    return made, made.addFrame(pinocchio.Frame("hand", parent, place, kind))


@pytest.mark.skipif(sys.platform == "win32", reason="Pinocchio has no wheels for Windows")
@pytest.mark.parametrize("name", ARMS)
def test_pinocchio_agrees(name):
    arm, motion = ARMS[name], states(ARMS[name].joints)
    library, end = model(arm)
    data = library.createData()
    tau, mass = arm.inverse_dynamics(*motion), mass_matrix(arm, motion[0])
    place = frames(arm, motion[0])
    for k, (q, qd, qdd) in enumerate(np.moveaxis(motion, 1, 0)):
        wanted = pinocchio.rnea(library, data, q, qd, qdd)
        np.testing.assert_allclose(tau[k], wanted, rtol=0, atol=1e-9)
        upper = np.triu(pinocchio.crba(library, data, q))
        np.testing.assert_allclose(mass[k], upper + np.triu(upper, 1).T, rtol=0, atol=1e-9)
        pinocchio.framesForwardKinematics(library, data, q)
        np.testing.assert_allclose(place[k, -1], data.oMf[end].homogeneous, rtol=0, atol=1e-9)
