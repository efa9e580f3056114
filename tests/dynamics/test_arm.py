"""Rigid-body dynamics against two independent derivations and the laws of mechanics."""

import copy
import pickle
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM, Arm, Link

# mass, length, centre of mass, inertia: typed from the tables, not read from the module
CMU_LINKS = ((14.0, 0.50, 0.22, 0.40), (14.0, 0.40, 0.09, 0.60))
REYES_KELLY_LINKS = ((23.902, 0.45, 0.091, 1.266), (3.880, 0.45, 0.048, 0.093))
ARMS = (CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM)
by_name = pytest.mark.parametrize("arm", ARMS, ids=lambda arm: arm.name)


def random_states(n=1000, seed=0):
    """Angles within a turn, velocities within 10 rad/s, accelerations within 50 rad/s^2."""
    rng = np.random.default_rng(seed)
    return (rng.uniform(-1, 1, (n, 2)) * scale for scale in (np.pi, 10.0, 50.0))


def random_links(n=20, seed=1):
    rng = np.random.default_rng(seed)
    low, high = (0.2, 0.1, 0.02, 0.01), (30.0, 1.0, 0.6, 2.0)
    return [tuple(map(tuple, rng.uniform(low, high, (2, 4)))) for _ in range(n)]


CASES = [
    (CMU_LINKS, 0.0),
    (REYES_KELLY_LINKS, 9.81),
    *((links, (0.0, 9.81, 1.62)[i % 3]) for i, links in enumerate(random_links())),
]


def arm_of(links, gravity) -> Arm:
    return Arm.from_links("test", Link(*links[0]), Link(*links[1]), gravity)


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


def newton_euler(q, qd, qdd, links, gravity):
    """Recursive Newton-Euler with general vectors: motion outwards, forces inwards."""
    z = np.array([0.0, 0.0, 1.0])
    n = len(q)
    omega, alpha = np.zeros((n, 3)), np.zeros((n, 3))
    # the base accelerates upwards instead of a weight pulling down
    joint_acceleration = np.tile([0.0, gravity, 0.0], (n, 1))
    angle = np.zeros(n)
    bodies = []
    for i, (mass, length, com, inertia) in enumerate(links):
        angle = angle + q[:, i]
        along = np.stack([np.sin(angle), -np.cos(angle), np.zeros(n)], -1)
        omega = omega + qd[:, i, None] * z
        alpha = alpha + qdd[:, i, None] * z

        def acceleration(arm, base=joint_acceleration, w=omega, a=alpha):
            return base + np.cross(a, arm) + np.cross(w, np.cross(w, arm))

        force = mass * acceleration(com * along)
        moment = inertia * alpha + np.cross(omega, inertia * omega)
        bodies.append((length * along, com * along, force, moment))
        joint_acceleration = acceleration(length * along)
    tau = np.zeros((n, 2))
    force_out, moment_out = np.zeros((n, 3)), np.zeros((n, 3))
    for i in (1, 0):
        tip, centre, force, moment = bodies[i]
        moment_out = moment + moment_out + np.cross(centre, force) + np.cross(tip, force_out)
        force_out = force + force_out
        tau[:, i] = moment_out @ z
    return tau


def relative_gap(x, y):
    return np.abs(x - y).max() / max(1.0, np.abs(y).max())


@pytest.mark.parametrize("links, gravity", CASES)
def test_inverse_dynamics_agrees_with_lagrange_and_newton(links, gravity, euler_lagrange):
    q, qd, qdd = random_states()
    tau = arm_of(links, gravity).inverse_dynamics(q, qd, qdd)
    assert relative_gap(tau, euler_lagrange(q, qd, qdd, links, gravity)) < 1e-10
    assert relative_gap(tau, newton_euler(q, qd, qdd, links, gravity)) < 1e-10


@pytest.mark.parametrize(
    "preset, links, gravity",
    [(CMU_DD_ARM_II, CMU_LINKS, 0.0), (REYES_KELLY_ARM, REYES_KELLY_LINKS, 9.81)],
    ids=["CMU", "Reyes-Kelly"],
)
def test_presets_agree_with_both_derivations(preset, links, gravity, euler_lagrange):
    q, qd, qdd = random_states(seed=3)
    tau = preset.inverse_dynamics(q, qd, qdd)
    np.testing.assert_allclose(tau, euler_lagrange(q, qd, qdd, links, gravity), atol=1e-10, rtol=0)
    np.testing.assert_allclose(tau, newton_euler(q, qd, qdd, links, gravity), atol=1e-10, rtol=0)


def test_preset_base_parameters():
    rounded = [round(x, 3) for x in (CMU_DD_ARM_II.a, CMU_DD_ARM_II.b, CMU_DD_ARM_II.d)]
    assert rounded == [5.291, 0.63, 0.713]
    assert (IMI_ARM.a, IMI_ARM.d, IMI_ARM.b) == (3.473, 0.193, 0.242)
    assert CMU_DD_ARM_II.gravity_moments == IMI_ARM.gravity_moments == (0.0, 0.0)
    for arm in ARMS:
        assert arm.provenance and all(arm.provenance.values())


@by_name
def test_forward_and_inverse_dynamics_undo_each_other(arm):
    q, qd, qdd = random_states(seed=4)
    back = arm.forward_dynamics(q, qd, arm.inverse_dynamics(q, qd, qdd))
    np.testing.assert_allclose(back, qdd, atol=1e-10, rtol=0)
    tau = qdd
    again = arm.inverse_dynamics(q, qd, arm.forward_dynamics(q, qd, tau))
    np.testing.assert_allclose(again, tau, atol=1e-10, rtol=0)


@by_name
def test_mass_matrix_is_symmetric_positive_definite(arm):
    q, *_ = random_states(seed=5)
    m = arm.mass_matrix(q)
    np.testing.assert_array_equal(m, np.swapaxes(m, -1, -2))
    np.linalg.cholesky(m)
    assert np.linalg.eigvalsh(m).min() > 0
    # nothing but the elbow angle matters
    np.testing.assert_array_equal(m, arm.mass_matrix(np.stack([0 * q[:, 0], q[:, 1]], -1)))


@by_name
def test_columns_of_the_mass_matrix_are_torques_per_unit_acceleration(arm):
    q, *_ = random_states(seed=6)
    rest = np.zeros_like(q)
    weight = arm.inverse_dynamics(q, rest, rest)
    np.testing.assert_allclose(weight, arm.gravity(q), atol=1e-12)
    for j in range(2):
        column = arm.inverse_dynamics(q, rest, rest + np.eye(2)[j]) - weight
        np.testing.assert_allclose(arm.mass_matrix(q)[..., j], column, atol=1e-12)


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


def test_base_parameters_are_identifiable_from_random_motion():
    q, qd, qdd = random_states(seed=9)
    arm = REYES_KELLY_ARM
    y = arm.regressor(q, qd, qdd).reshape(-1, 5)
    found, _, rank, _ = np.linalg.lstsq(y, arm.inverse_dynamics(q, qd, qdd).ravel())
    assert rank == 5
    np.testing.assert_allclose(found, [arm.a, arm.b, arm.d, *arm.gravity_moments], rtol=1e-9)


def test_torque_terms_answer_to_their_own_cause_only():
    """Each term scales with the product of rates that names it, and vanishes without it."""
    arm, (q, qd, qdd) = REYES_KELLY_ARM, random_states(seed=10)
    first, second = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    full = arm.torque_terms(q, qd, qdd)
    assert set(full) == {"inertial", "coupling", "centrifugal", "coriolis", "gravity"}
    assert all(np.abs(term).max() > 0.1 for term in full.values())
    one_joint = arm.torque_terms(q, qd * first, qdd * first)
    np.testing.assert_array_equal(one_joint["coriolis"], 0)  # needs both velocities
    np.testing.assert_array_equal(one_joint["centrifugal"][:, 0], 0)  # acts on the other joint
    np.testing.assert_array_equal(one_joint["inertial"][:, 1], 0)
    np.testing.assert_array_equal(one_joint["coupling"][:, 0], 0)
    other = arm.torque_terms(q, qd * second, qdd * second)
    np.testing.assert_array_equal(other["centrifugal"][:, 1], 0)
    np.testing.assert_allclose(
        one_joint["centrifugal"] + other["centrifugal"], full["centrifugal"], atol=1e-12
    )
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


def test_gravity_is_the_gradient_of_potential_energy():
    arm, (q, *_) = REYES_KELLY_ARM, random_states(seed=12)
    h = 1e-4
    for j, unit in enumerate(np.eye(2)):
        up, down = arm.potential_energy(q + h * unit), arm.potential_energy(q - h * unit)
        up2, down2 = arm.potential_energy(q + 2 * h * unit), arm.potential_energy(q - 2 * h * unit)
        slope = (8 * (up - down) - (up2 - down2)) / (12 * h)
        np.testing.assert_allclose(arm.gravity(q)[:, j], slope, atol=1e-8)
    np.testing.assert_allclose(arm.gravity([0.0, 0.0]), 0.0)  # hanging straight down
    assert arm.potential_energy([np.pi, 0.0]) > arm.potential_energy([0.0, 0.0])
    for level in (CMU_DD_ARM_II, IMI_ARM):
        assert not level.gravity(q).any() and not level.potential_energy(q).any()


@settings(deadline=None, max_examples=50)
@given(
    masses=st.tuples(st.floats(0.1, 20), st.floats(0.1, 20)),
    lengths=st.tuples(st.floats(0.1, 1), st.floats(0.1, 1)),
    q=st.tuples(st.floats(-7, 7), st.floats(-7, 7)),
    qd=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
)
def test_energy_of_two_point_masses(masses, lengths, q, qd):
    """Masses at the link ends: energies follow from where `forward_kinematics` puts them."""
    links = [Link(m, length, length, 1e-3) for m, length in zip(masses, lengths)]
    arm = Arm.from_links("pendulum", *links, gravity=9.81)
    q, qd = np.array(q), np.array(qd)
    down = arm.forward_kinematics(q)[:, 0]  # q = 0 hangs, so x points down
    np.testing.assert_allclose(
        arm.potential_energy(q), -9.81 * np.dot(masses, down), rtol=1e-9, atol=1e-9
    )
    h = 1e-4
    near = [arm.forward_kinematics(q + k * h * qd) for k in (1, -1, 2, -2)]
    velocity = (8 * (near[0] - near[1]) - (near[2] - near[3])) / (12 * h)
    spin = 0.5e-3 * (qd[0] ** 2 + qd.sum() ** 2)
    kinetic = 0.5 * np.dot(masses, (velocity**2).sum(-1)) + spin
    np.testing.assert_allclose(arm.kinetic_energy(q, qd), kinetic, rtol=1e-8, atol=1e-8)


@settings(deadline=None, max_examples=50)
@given(q1=st.floats(-10, 10), q2=st.floats(-10, 10))
def test_forward_kinematics_obeys_the_law_of_cosines(q1, q2):
    l1, l2 = CMU_DD_ARM_II.lengths
    elbow, hand = CMU_DD_ARM_II.forward_kinematics([q1, q2])
    assert np.hypot(*elbow) == pytest.approx(l1, rel=1e-12)
    assert np.hypot(*(hand - elbow)) == pytest.approx(l2, rel=1e-12)
    reach = l1**2 + l2**2 - 2 * l1 * l2 * np.cos(np.pi - q2)
    assert hand @ hand == pytest.approx(reach, abs=1e-12)
    # a turn of the shoulder turns the whole figure
    turn = np.array([[np.cos(q1), -np.sin(q1)], [np.sin(q1), np.cos(q1)]])
    still = CMU_DD_ARM_II.forward_kinematics([0.0, q2])
    np.testing.assert_allclose([elbow, hand], still @ turn.T, atol=1e-12)


def test_forward_kinematics_at_known_poses():
    arm = CMU_DD_ARM_II
    np.testing.assert_allclose(arm.forward_kinematics([0, 0]), [[0.5, 0], [0.9, 0]], atol=1e-15)
    bent = arm.forward_kinematics(np.deg2rad([90, -90]))
    np.testing.assert_allclose(bent, [[0, 0.5], [0.4, 0.5]], atol=1e-15)
    # counter-clockwise angles
    assert arm.forward_kinematics([0.1, 0.0])[1, 1] > 0


STATE_METHODS = {
    "mass_matrix": 1,
    "coriolis_matrix": 2,
    "gravity": 1,
    "inverse_dynamics": 3,
    "forward_dynamics": 3,
    "kinetic_energy": 2,
    "potential_energy": 1,
    "regressor": 3,
    "forward_kinematics": 1,
}


@pytest.mark.parametrize("name, count", STATE_METHODS.items())
def test_many_states_at_once_equal_one_by_one(name, count):
    rng = np.random.default_rng(13)
    states = rng.normal(size=(count, 3, 4, 2))
    method = getattr(REYES_KELLY_ARM, name)
    together = method(*states)
    for index in np.ndindex(3, 4):
        single = method(*(s[index] for s in states))
        np.testing.assert_allclose(together[index], single, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("name, count", [(n, c) for n, c in STATE_METHODS.items() if c > 1])
def test_arguments_broadcast(name, count):
    rng = np.random.default_rng(14)
    method = getattr(REYES_KELLY_ARM, name)
    for many in range(count):
        args = [rng.normal(size=(5, 2) if i == many else 2) for i in range(count)]
        full = [np.broadcast_to(x, (5, 2)) for x in args]
        np.testing.assert_array_equal(method(*args), method(*full))


@pytest.mark.parametrize("name, count", STATE_METHODS.items())
@pytest.mark.parametrize("bad", [[np.nan, 0.0], [0.0, np.inf], [0.0], [0.0, 0.0, 0.0], 0.0])
def test_bad_states_are_refused_by_name(name, count, bad):
    names = ("q", "qd", "tau" if name == "forward_dynamics" else "qdd")
    for position in range(count):
        args = [[0.1, 0.2]] * count
        args[position] = bad
        with pytest.raises(ValueError, match=rf"^{names[position]} must"):
            getattr(REYES_KELLY_ARM, name)(*args)


def test_words_are_not_angles():
    with pytest.raises(TypeError, match="qd"):
        CMU_DD_ARM_II.inverse_dynamics([0, 0], "fast", [0, 0])


GOOD = dict(name="arm", a=5.0, b=0.5, d=0.7, lengths=(0.5, 0.4))


@pytest.mark.parametrize("name", ["a", "b", "d"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_arm_refuses_parameters_that_are_not_finite(name, bad):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        Arm(**{**GOOD, name: bad})


@pytest.mark.parametrize(
    "change, words",
    [
        (dict(d=0.0), "positive definite"),
        (dict(d=-0.7), "positive definite"),
        (dict(a=0.7), "positive definite"),
        (dict(b=2.0), "positive definite"),
        (dict(b=-2.0), "positive definite"),
        (dict(lengths=(0.5, -0.4)), "lengths"),
        (dict(lengths=(0.5,)), "lengths"),
        (dict(lengths=np.ones((3, 2))), "lengths"),
        (dict(gravity_moments=(1.0, np.nan)), "gravity_moments"),
        (dict(gravity_moments=(1.0, 2.0, 3.0)), "gravity_moments"),
    ],
)
def test_arm_refuses_impossible_parameters(change, words):
    Arm(**GOOD)
    with pytest.raises(ValueError, match=words):
        Arm(**{**GOOD, **change})


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


@pytest.mark.parametrize("position, name", list(enumerate(["mass", "length", "com", "inertia"])))
@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_link_refuses_impossible_parameters(position, name, bad):
    values = [14.0, 0.5, 0.22, 0.4]
    values[position] = bad
    with pytest.raises(ValueError, match=rf"^{name} must"):
        Link(*values)


@by_name
def test_arms_survive_pickling_and_copying(arm):
    for twin in (pickle.loads(pickle.dumps(arm)), copy.deepcopy(arm), replace(arm)):
        assert twin == arm and hash(twin) == hash(arm)
        assert dict(twin.provenance) == dict(arm.provenance)
        q, qd, qdd = random_states(10)
        np.testing.assert_array_equal(
            twin.inverse_dynamics(q, qd, qdd), arm.inverse_dynamics(q, qd, qdd)
        )


def test_arms_cannot_be_changed():
    lengths, sources = [0.5, 0.4], {"a": "assumed"}
    arm = Arm("arm", 5.0, 0.5, 0.7, lengths, provenance=sources)
    for name in ("a", "lengths", "provenance", "new"):
        with pytest.raises(FrozenInstanceError):
            setattr(arm, name, 1.0)
    with pytest.raises(TypeError):
        arm.provenance["a"] = "measured"
    lengths[0], sources["a"] = 9.0, "measured"
    assert arm.lengths == (0.5, 0.4) and arm.provenance["a"] == "assumed"
    assert arm == Arm("arm", 5.0, 0.5, 0.7, (0.5, 0.4)) and arm != replace(arm, a=6.0)


def test_results_do_not_alias_the_arguments():
    q, qd, qdd = (x.copy() for x in random_states(20))
    before = q.copy(), qd.copy(), qdd.copy()
    CMU_DD_ARM_II.inverse_dynamics(q, qd, qdd)[:] = 0
    CMU_DD_ARM_II.forward_dynamics(q, qd, qdd)[:] = 0
    for now, then in zip((q, qd, qdd), before):
        np.testing.assert_array_equal(now, then)
