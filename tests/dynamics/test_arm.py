"""Rigid-body dynamics against an independent derivation and the laws of mechanics."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st

from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM, Arm, Link, jacobian, with_load

# mass, length, centre of mass, inertia: typed from the tables, not read from the module
CMU_LINKS = ((14.0, 0.50, 0.22, 0.40), (14.0, 0.40, 0.09, 0.60))
REYES_KELLY_LINKS = ((23.902, 0.45, 0.091, 1.266), (3.880, 0.45, 0.048, 0.093))
ARMS = (CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM)
by_name = pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)


def random_states(n=1000, seed=0):
    """Angles within a turn, velocities within 10 rad/s, accelerations within 50 rad/s^2."""
    rng = np.random.default_rng(seed)
    return (rng.uniform(-1, 1, (n, 2)) * scale for scale in (np.pi, 10.0, 50.0))


@pytest.fixture(scope="module")
def euler_lagrange():
    """Torques from d/dt dL/dqd - dL/dq, with L written in Cartesian coordinates by sympy."""
    t, g = sp.symbols("t g")
    links = sp.symbols("m1 l1 c1 i1 m2 l2 c2 i2", positive=True)
    m1, l1, c1, i1, m2, _, c2, i2 = links
    q = [sp.Function("q1")(t), sp.Function("q2")(t)]

    def point(*rods):
        # y points up, every angle is counted from hanging straight down
        return sp.Matrix(
            [sum(r * sp.sin(a) for r, a in rods), sum(-r * sp.cos(a) for r, a in rods)]
        )

    centres = point((c1, q[0])), point((l1, q[0]), (c2, q[0] + q[1]))
    spins = q[0].diff(t), (q[0] + q[1]).diff(t)
    kinetic = potential = 0
    for mass, inertia, centre, spin in zip((m1, m2), (i1, i2), centres, spins):
        velocity = centre.diff(t)
        kinetic += (mass * velocity.dot(velocity) + inertia * spin**2) / 2
        potential += mass * g * centre[1]
    lagrangian = kinetic - potential
    torque = [lagrangian.diff(x.diff(t)).diff(t) - lagrangian.diff(x) for x in q]
    state = sp.symbols("x1 x2 v1 v2 a1 a2")
    for order in (2, 1, 0):
        replaced = {x.diff(t, order) if order else x: s for x, s in zip(q, state[2 * order :])}
        torque = [expression.subs(replaced) for expression in torque]
    torque = [expression.doit() for expression in torque]
    assert not any(expression.has(t) for expression in torque)
    compiled = sp.lambdify([*state, *links, g], torque)
    return lambda q, qd, qdd, pair, gravity: np.stack(
        compiled(*q.T, *qd.T, *qdd.T, *pair[0], *pair[1], gravity), -1
    )


def test_inverse_dynamics_is_lagranges_equation(euler_lagrange):
    """Of the preset arms, and of links of any size under any gravity."""
    low, high = (0.2, 0.1, 0.02, 0.01), (30.0, 1.0, 0.6, 2.0)
    drawn = np.random.default_rng(1).uniform(low, high, (6, 2, 4))
    cases = [
        (CMU_DD_ARM_II, CMU_LINKS, 0.0),
        (REYES_KELLY_ARM, REYES_KELLY_LINKS, 9.81),
        *((None, links, gravity) for links, gravity in zip(drawn, (0.0, 9.81, 1.62) * 2)),
    ]
    q, qd, qdd = random_states()
    for preset, links, gravity in cases:
        made = Arm.from_links("test", *(Link(*link) for link in links), gravity)
        wanted = euler_lagrange(q, qd, qdd, links, gravity)
        for arm in (made, preset or made):
            tau = arm.inverse_dynamics(q, qd, qdd)
            assert np.abs(tau - wanted).max() < 1e-10 * max(1.0, np.abs(wanted).max())


@by_name
def test_forward_and_inverse_dynamics_undo_each_other(arm):
    q, qd, qdd = random_states(seed=4)
    back = arm.forward_dynamics(q, qd, arm.inverse_dynamics(q, qd, qdd))
    np.testing.assert_allclose(back, qdd, atol=1e-10, rtol=0)


@by_name
def test_mass_matrix_is_symmetric_positive_definite(arm):
    q, *_ = random_states(seed=5)
    m = arm.mass_matrix(q)
    np.testing.assert_array_equal(m, np.swapaxes(m, -1, -2))
    assert np.linalg.eigvalsh(m).min() > 0


@by_name
def test_mass_matrix_rate_minus_twice_coriolis_is_skew_symmetric(arm):
    q, qd, _ = random_states(seed=7)
    h = 1e-4
    # fourth-order central difference along the motion
    rate = (
        8 * (arm.mass_matrix(q + h * qd) - arm.mass_matrix(q - h * qd))
        - (arm.mass_matrix(q + 2 * h * qd) - arm.mass_matrix(q - 2 * h * qd))
    ) / (12 * h)
    n = rate - 2 * arm.coriolis_matrix(q, qd)
    assert np.abs(n).max() > 1.0  # not skew by being zero
    np.testing.assert_allclose(n + np.swapaxes(n, -1, -2), 0, atol=1e-8)


@by_name
def test_three_ways_to_the_same_torque(arm):
    q, qd, qdd = random_states(seed=8)
    tau = arm.inverse_dynamics(q, qd, qdd)
    matrices = (
        np.einsum("nij,nj->ni", arm.mass_matrix(q), qdd)
        + np.einsum("nij,nj->ni", arm.coriolis_matrix(q, qd), qd)
        + arm.gravity(q)
    )
    base = np.array([arm.a, arm.b, arm.d, *arm.gravity_moments])
    np.testing.assert_allclose(matrices, tau, atol=1e-10, rtol=0)
    np.testing.assert_allclose(arm.regressor(q, qd, qdd) @ base, tau, atol=1e-10, rtol=0)
    np.testing.assert_allclose(sum(arm.torque_terms(q, qd, qdd).values()), tau, atol=1e-10, rtol=0)


def test_torque_terms_answer_to_their_own_cause_only():
    """Each term scales with the product of rates that names it, and vanishes without it."""
    arm, (q, qd, qdd) = REYES_KELLY_ARM, random_states(seed=10)
    first = np.array([1.0, 0.0])
    full = arm.torque_terms(q, qd, qdd)
    assert set(full) == {"inertial", "coupling", "centrifugal", "coriolis", "gravity"}
    assert all(np.abs(term).max() > 0.1 for term in full.values())
    one_joint = arm.torque_terms(q, qd * first, qdd * first)
    np.testing.assert_array_equal(one_joint["coriolis"], 0)  # needs both velocities
    np.testing.assert_array_equal(one_joint["centrifugal"][:, 0], 0)  # acts on the other joint
    np.testing.assert_array_equal(one_joint["inertial"][:, 1], 0)
    np.testing.assert_array_equal(one_joint["coupling"][:, 0], 0)
    twice = arm.torque_terms(q, 2 * qd, 3 * qdd)
    for name, factor in dict(inertial=3, coupling=3, centrifugal=4, coriolis=4, gravity=1).items():
        np.testing.assert_allclose(twice[name], factor * full[name], rtol=1e-12, err_msg=name)


@by_name
def test_power_at_the_joints_is_the_rate_of_energy(arm):
    rng = np.random.default_rng(11)
    phase, rate = rng.uniform(0, 6, (2, 200, 2))

    def energy(t):
        q, qd = np.sin(rate * t + phase), rate * np.cos(rate * t + phase)
        return arm.kinetic_energy(q, qd) + arm.potential_energy(q)

    h = 1e-4
    change = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h)
    q, qd, qdd = np.sin(phase), rate * np.cos(phase), -(rate**2) * np.sin(phase)
    power = (qd * arm.inverse_dynamics(q, qd, qdd)).sum(-1)
    assert np.abs(power).max() > 10.0
    np.testing.assert_allclose(change, power, atol=1e-7)


@settings(deadline=None, max_examples=50)
@given(q1=st.floats(-10, 10), q2=st.floats(-10, 10))
def test_forward_kinematics_obeys_the_law_of_cosines(q1, q2):
    l1, l2 = CMU_DD_ARM_II.lengths
    elbow, hand = CMU_DD_ARM_II.forward_kinematics([q1, q2])
    assert np.hypot(*elbow) == pytest.approx(l1, rel=1e-12)
    assert np.hypot(*(hand - elbow)) == pytest.approx(l2, rel=1e-12)
    reach = l1**2 + l2**2 - 2 * l1 * l2 * np.cos(np.pi - q2)
    assert hand @ hand == pytest.approx(reach, abs=1e-12)
    # the shoulder turns the whole figure
    np.testing.assert_allclose(elbow, [l1 * np.cos(q1), l1 * np.sin(q1)], atol=1e-12)


@by_name
def test_a_load_adds_its_kinetic_energy_and_its_weight(arm):
    q, qd = np.random.default_rng(0).uniform(-2, 2, (2, 50, 2))
    mass, loaded = 3.0, with_load(arm, 3.0)
    hand = np.einsum("nij,nj->ni", jacobian(arm, q), qd)
    more = loaded.kinetic_energy(q, qd) - arm.kinetic_energy(q, qd)
    np.testing.assert_allclose(more, 0.5 * mass * (hand**2).sum(-1), rtol=1e-12)
    down = np.array([mass * 9.81, 0.0]) if any(arm.gravity_moments) else np.zeros(2)
    weight = -np.einsum("nij,i->nj", jacobian(arm, q), down)  # angles count from hanging
    np.testing.assert_allclose(loaded.gravity(q) - arm.gravity(q), weight, atol=1e-11)


@settings(deadline=None, max_examples=100)
@given(a=st.floats(0.01, 10), b=st.floats(-5, 5), d=st.floats(-1, 5))
def test_arm_accepts_exactly_the_positive_definite_matrices(a, b, d):
    elbow = np.linspace(-np.pi, np.pi, 73)  # 0 and both ends are where it first fails
    c = np.cos(elbow)
    m = np.array([[a + 2 * b * c, d + b * c], [d + b * c, d + 0 * c]]).transpose(2, 0, 1)
    smallest = np.linalg.eigvalsh(m).min()
    if abs(smallest) < 1e-9:
        return  # too close to the border to call
    if smallest > 0:
        Arm("arm", a, b, d, (1.0, 1.0))
    else:
        with pytest.raises(ValueError, match="positive definite"):
            Arm("arm", a, b, d, (1.0, 1.0))
