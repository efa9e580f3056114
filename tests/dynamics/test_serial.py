"""Arms in space: three formulations against each other, the planar arm, and another library."""

import numpy as np
import pytest

from ddlib.dynamics import (
    CMU_DD_ARM_II,
    PUMA_560,
    PUMA_560_GEARS,
    PUMA_560_ROTORS,
    REYES_KELLY_ARM,
    Link,
    SerialArm,
    SpatialLink,
    lagrange_euler,
    newton_euler,
    recursive_lagrange,
)

CMU = (Link(14.0, 0.50, 0.22, 0.40), Link(14.0, 0.40, 0.09, 0.60))
VERTICAL = (Link(23.902, 0.45, 0.091, 1.266), Link(3.880, 0.45, 0.048, 0.093))
READY = np.array([0, np.pi / 4, np.pi, 0, np.pi / 4, 0])
REST = np.zeros(6)


def states(joints, n=200, seed=0):
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


def test_planar_arms_agree_with_the_two_link_equations():
    motion = states(2, n=1000)
    for links, plane, gravity in ((CMU, CMU_DD_ARM_II, 0.0), (VERTICAL, REYES_KELLY_ARM, 9.81)):
        tau, arm = plane.inverse_dynamics(*motion), SerialArm.planar(links, gravity)
        for formulation in (newton_euler, lagrange_euler):
            np.testing.assert_allclose(arm.inverse_dynamics(*motion, formulation), tau, atol=1e-10)


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


def test_velocity_torques_of_the_puma():
    qd = np.array([1.0, 2.0, 3.0, 1.0, 2.0, 3.0])
    known = [
        [-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001],
        [0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0.0],
        [-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0.0],
        [0.0011, 0.0005, -0.0001, 0.0002, 0.0002, -0.0001],
        [-0.0002, 0.0028, 0.0046, -0.0002, 0.0, 0.0],
        [0.0001, 0.0, 0.0, 0.0, 0.0, 0.0],
    ]
    weight = PUMA_560.inverse_dynamics(READY, REST, REST)
    moving = PUMA_560.inverse_dynamics(READY, qd, REST) - weight
    np.testing.assert_allclose(moving, np.array(known) @ qd, atol=6e-5 * np.abs(qd).sum())


# --- shapes and refusals ----------------------------------------------------------------


def test_states_in_a_block_are_states_by_themselves():
    arm = random_arm(3, seed=4)
    block = [x.reshape(5, 4, 3) for x in states(3, n=20)]
    for formulation in (newton_euler, lagrange_euler, recursive_lagrange):
        tau = arm.inverse_dynamics(*block, formulation)
        assert tau.shape == (5, 4, 3)
        for k in np.ndindex(5, 4):
            alone = arm.inverse_dynamics(*(x[k] for x in block), formulation)
            np.testing.assert_allclose(tau[k], alone, rtol=1e-9, atol=1e-9)


def test_an_arm_cut_off_is_the_arm_with_fewer_links():
    arm = random_arm(5, seed=2)
    assert arm.first(3) == SerialArm(arm.links[:3], arm.gravity) and arm.first(5) == arm
    assert arm.joints == 5 and arm.first(1).joints == 1
    for wrong in (0, 6):
        with pytest.raises(ValueError, match="joints must be"):
            arm.first(wrong)


def test_refusals():
    good = dict(twist_deg=0.0, length=1.0, offset=0.0, mass=1.0, com=(0, 0, 0), inertia=np.eye(3))
    link, flat = SpatialLink(**good), np.triu(np.ones((3, 3)))
    for name, *values in (
        ("mass", -1.0), ("length", np.nan), ("com", (0.0, 0.0)), ("inertia", np.eye(2), flat),
    ):  # fmt: skip
        for bad in values:
            with pytest.raises(ValueError, match=f"^{name} must"):
                SpatialLink(**{**good, name: bad})
    for links in ([], [CMU[0]]):
        with pytest.raises(TypeError, match="links must be"):
            SerialArm(links)
    with pytest.raises(ValueError, match="gravity must have"):
        SerialArm([link], (0.0, -9.81))
    for q, qd, words in (
        ([0.0], [np.inf], "qd must be finite"),
        ([0, 1], [0], "q must have a last"),
    ):
        with pytest.raises(ValueError, match=words):
            SerialArm([link]).inverse_dynamics(q, qd, [0.0])
