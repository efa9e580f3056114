"""Arms in space: three formulations against each other, the planar arm, and Pinocchio."""

import sys

import numpy as np
import pytest

from ddlib.dynamics import (
    CMU_DD_ARM_II,
    DD_ARM_II_IN_SPACE,
    PUMA_560,
    PUMA_560_GEARS,
    PUMA_560_ROTORS,
    SerialArm,
    SpatialLink,
    lagrange_euler,
    locked,
    mass_matrix,
    recursive_lagrange,
    regressor,
)

if sys.platform != "win32":  # no wheels there, as requirements.txt says
    import pinocchio

READY = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])
REST = np.zeros(6)


def states(joints, n=40, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (3, n, joints)) * np.array([np.pi, 5.0, 20.0])[:, None, None]


def random_arm(joints, seed) -> SerialArm:
    """General links: any twist, offset, centre of mass and inertia; gravity askew."""
    rng = np.random.default_rng(seed)

    def link():
        root = rng.normal(size=(3, 3))
        inertia = root @ root.T
        place = rng.uniform(-180, 180), *rng.uniform(-1, 1, 2)
        return SpatialLink(*place, rng.uniform(0.1, 5), rng.normal(size=3), inertia + inertia.T)

    return SerialArm([link() for _ in range(joints)], rng.normal(size=3) * 5)


@pytest.mark.parametrize("joints", range(1, 7))
def test_newton_and_lagrange_agree_on_general_arms(joints):
    arm, motion = random_arm(joints, seed=joints), states(joints, n=20)
    newton = arm.inverse_dynamics(*motion)
    assert newton.shape == (20, joints)
    for lagrange in (lagrange_euler, recursive_lagrange):
        found = arm.inverse_dynamics(*motion, lagrange)
        np.testing.assert_allclose(found, newton, atol=1e-10 * np.abs(newton).max())


# --- the Puma 560: numbers that Corke's Robotics Toolbox tests itself with ---------------


def test_weight_of_the_puma():
    known = [0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0]
    np.testing.assert_allclose(PUMA_560.inverse_dynamics(READY, REST, REST), known, atol=6e-5)


def test_inertia_of_the_puma_with_its_rotors():
    weight = PUMA_560.inverse_dynamics(READY, REST, REST)
    links = PUMA_560.inverse_dynamics(READY, REST, np.eye(6)) - weight
    rotors = np.array(PUMA_560_ROTORS) * np.array(PUMA_560_GEARS) ** 2
    known = [
        [3.6594, -0.4044, 0.1006, -0.0025, 0.0, 0.0],
        [-0.4044, 4.4137, 0.3509, 0.0, 0.0024, 0.0],
        [0.1006, 0.3509, 0.9378, 0.0, 0.0015, 0.0],
        [-0.0025, 0.0, 0.0, 0.1925, 0.0, 0.0],
        [0.0, 0.0024, 0.0015, 0.0, 0.1713, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.1941],
    ]
    np.testing.assert_allclose(links + np.diag(rotors), known, atol=6e-5)


# --- the arm of seven joints, and tools for any number ------------------------------------

ARMS = {
    "four joints": locked(DD_ARM_II_IN_SPACE, 4),
    "seven joints": DD_ARM_II_IN_SPACE,
    "four askew": random_arm(4, seed=5),
    "seven askew": random_arm(7, seed=5),
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


def hand(arm, q):
    """End of the last link, m, by the matrices of Denavit & Hartenberg."""
    place = np.array([0.0, 0.0, 0.0, 1.0])
    for link, angle in zip(reversed(arm.links), reversed(q)):
        (c, s), (ct, st) = ((np.cos(x), np.sin(x)) for x in (angle, np.deg2rad(link.twist_deg)))
        place = [
            [c, -s * ct, s * st, link.length * c],
            [s, c * ct, -c * st, link.length * s],
            [0.0, st, ct, link.offset],
            [0.0, 0.0, 0.0, 1.0],
        ] @ place
    return place[:3]


@pytest.mark.parametrize("joints", range(1, 7))
def test_a_locked_arm_is_the_whole_one_at_rest_beyond(joints):
    motion = states(joints)
    whole = np.concatenate([motion, np.zeros((3, 40, 7 - joints))], -1)
    arm = locked(DD_ARM_II_IN_SPACE, joints)
    tau = DD_ARM_II_IN_SPACE.inverse_dynamics(*whole)[:, :joints]
    np.testing.assert_allclose(arm.inverse_dynamics(*motion), tau, atol=1e-12 * np.abs(tau).max())
    for q, wanted in zip(motion[0], whole[0]):
        np.testing.assert_allclose(hand(arm, q), hand(DD_ARM_II_IN_SPACE, wanted), atol=1e-14)


def test_what_moves_the_joints_are_few_combinations():
    """Each joint beyond the first adds up to seven base parameters (Gautier & Khalil 1990)."""
    ranks = []
    for n in (1, 2, 3, 4, 7):
        matrix = regressor(locked(DD_ARM_II_IN_SPACE, n), *states(n))
        ranks.append(np.linalg.matrix_rank(matrix.reshape(-1, 10 * n)))
    assert ranks == [1, 4, 11, 18, 39]


# --- against Pinocchio ------------------------------------------------------------------


pinocchios = pytest.mark.skipif(sys.platform == "win32", reason="no wheels for Windows")


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
    return made


@pinocchios
@pytest.mark.parametrize("name", ARMS)
def test_pinocchio_agrees(name):
    arm, motion = ARMS[name], states(ARMS[name].joints)
    library = model(arm)
    data = library.createData()
    tau, mass = arm.inverse_dynamics(*motion), mass_matrix(arm, motion[0])
    for k, (q, qd, qdd) in enumerate(np.moveaxis(motion, 1, 0)):
        wanted = pinocchio.rnea(library, data, q, qd, qdd)
        np.testing.assert_allclose(tau[k], wanted, rtol=0, atol=1e-9)
        upper = np.triu(pinocchio.crba(library, data, q))
        np.testing.assert_allclose(mass[k], upper + np.triu(upper, 1).T, rtol=0, atol=1e-9)


@pinocchios
@pytest.mark.parametrize("name", ARMS)
def test_torque_is_linear_in_ten_parameters_of_each_link(name):
    arm, motion = ARMS[name], states(ARMS[name].joints, 10)
    bodies = (pinocchio.Inertia(k.mass, np.array(k.com), np.array(k.inertia)) for k in arm.links)
    order = [0, 1, 2, 3, 4, 6, 9, 5, 7, 8]  # Pinocchio's second moments are xx, xy, yy, xz, yz, zz
    values = np.concatenate([body.toDynamicParameters()[order] for body in bodies])
    tau = arm.inverse_dynamics(*motion)
    product = regressor(arm, *motion) @ values
    np.testing.assert_allclose(product, tau, rtol=0, atol=1e-11 * np.abs(tau).max())
