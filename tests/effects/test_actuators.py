"""Amplifier, motor and shaft: exact inverses, waves without a mean, modes in closed form."""

import control
import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM
from ddlib.effects import DeadZone, FlexibleJoint, Ripple, Saturation

ARMS = pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
PAIR = st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)).map(np.array)
SHAFT = FlexibleJoint((2e4, 6e3), (0.4, 0.05))


@settings(deadline=None, max_examples=100)
@given(x=PAIR)
def test_saturation_clips_and_clips_only_once(x):
    saturation = Saturation((100.0, 30.0))
    once = saturation.apply(x)
    assert (np.abs(once) <= [100.0, 30.0]).all()
    np.testing.assert_array_equal(saturation.apply(once), once)
    inside = np.abs(x) <= [100.0, 30.0]
    np.testing.assert_array_equal(once[inside], x[inside])
    np.testing.assert_array_equal(np.sign(once), np.sign(x))
    np.testing.assert_array_equal(np.abs(once)[~inside], np.array([100.0, 30.0])[~inside])
    np.testing.assert_array_equal(saturation.inverse(once), once)
    if not inside.all():
        with pytest.raises(ValueError, match=r"^y must"):
            saturation.inverse(x)


@settings(deadline=None)
@given(x=PAIR, width=st.floats(0, 100))
@example(x=np.array([4e-5, 0.0]), width=2.2e-309)
@example(x=np.array([4e-5, 0.0]), width=3e-10)
def test_dead_zone_is_undone_exactly_outside_the_zone(x, width):
    zone = DeadZone((width, 0.0))
    left = zone.apply(x)
    assert (left * x >= 0).all() and (np.abs(left) <= np.abs(x)).all()
    assert left[1] == x[1]  # a zone without width does nothing
    if abs(x[0]) <= width:
        assert left[0] == 0.0
    else:
        np.testing.assert_allclose(zone.inverse(left), x, rtol=1e-14)
    np.testing.assert_allclose(zone.apply(zone.inverse(x)), x, rtol=1e-14, atol=1e-13)
    np.testing.assert_allclose(DeadZone((0.1, 0.2)).apply(np.array([0.05, -0.5])), [0.0, -0.3])


@settings(deadline=None)
@given(
    cycles=st.tuples(st.integers(1, 500), st.integers(1, 500)),
    phase=st.floats(-10, 10),
    tau=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
    cogging=st.floats(0, 5),
    share=st.floats(0, 1),
)
def test_ripple_has_no_mean_over_a_turn(cycles, phase, tau, cogging, share):
    ripple = Ripple((cogging, 0.0), (0.0, share), cycles, phase)
    q = np.linspace(0, 2 * np.pi, 1201, endpoint=False)[:, None] * np.ones(2)
    torque = ripple.shaft_torque(np.array(tau), q) - tau
    np.testing.assert_allclose(torque.mean(0), 0.0, atol=1e-9)
    crest = (np.pi / 2 - phase) / np.array(cycles)
    top = ripple.shaft_torque(np.array(tau), crest) - tau
    np.testing.assert_allclose(top, [cogging, share * tau[1]], atol=1e-9)
    assert (np.abs(torque) <= np.array([cogging, share * abs(tau[1])]) + 1e-9).all()
    turned = ripple.shaft_torque(np.array(tau), q + 2 * np.pi) - tau
    np.testing.assert_allclose(turned, torque, atol=1e-8)


def test_spring_with_play_by_numbers():
    shaft = FlexibleJoint((100.0, 10.0), (0.1, 0.1), damping=(2.0, 3.0), gap=(0.2, 0.0))
    twist, rate = np.array([[0.05, 0.05], [0.3, -0.3], [-0.3, 0.3]]), np.array([1.0, 1.0])
    expected = [[0.0, 0.5 + 3.0], [20.0 + 2.0, -3.0 + 3.0], [-20.0 + 2.0, 3.0 + 3.0]]
    np.testing.assert_allclose(shaft.spring_torque(twist, rate), expected, atol=1e-12)


@ARMS
def test_links_and_motors_together_are_the_arm(arm):
    """Kinetic energy: the rigid arm's, with each rotor turning at its own speed instead."""
    shaft = FlexibleJoint((1.0, 1.0), (0.2, 0.05))
    rng = np.random.default_rng(3)
    q, qd, motor = rng.normal(size=(3, 50, 2))
    v = np.concatenate([qd, motor], -1)
    energy = 0.5 * np.einsum("ni,nij,nj->n", v, shaft.mass_matrix(arm, q), v)

    def rotors(speed):
        return 0.5 * (0.2 * speed[:, 0] ** 2 + 0.05 * (qd[:, 0] + speed[:, 1]) ** 2)

    np.testing.assert_allclose(energy, arm.kinetic_energy(q, qd) - rotors(qd) + rotors(motor))
    assert (np.linalg.eigvalsh(shaft.mass_matrix(arm, q)) > 0).all()


@ARMS
def test_modes_are_the_poles_that_python_control_finds(arm):
    for q2 in (0.0, 1.0, 2.5):
        q = np.array([0.3, q2])
        k = np.diag(SHAFT.stiffness)
        mass = SHAFT.mass_matrix(arm, q)
        lower = -np.linalg.solve(mass, np.block([[k, -k], [-k, k]]))
        A = np.block([[np.zeros((4, 4)), np.eye(4)], [lower, np.zeros((4, 4))]])
        poles = control.ss(A, np.zeros((8, 1)), np.eye(8), np.zeros((8, 1))).poles()
        swing = np.sort(poles.imag)[-2:]
        np.testing.assert_allclose(SHAFT.mode_frequencies(arm, q), swing, rtol=1e-6)
