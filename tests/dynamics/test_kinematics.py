"""Inverse kinematics and circles, against complex numbers and numerical derivatives."""

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from ddlib.dynamics import (
    CMU_DD_ARM_II as ARM,
    ELBOWS,
    Unreachable,
    follow_hand,
    inverse_kinematics,
    jacobian,
    reach,
)

angles = st.tuples(st.floats(-3.1, 3.1), st.floats(-3.0, 3.0))
L1, L2 = ARM.lengths


def hand_of(q):
    """By complex numbers, independently of the arm's own kinematics."""
    z = L1 * np.exp(1j * q[..., 0]) + L2 * np.exp(1j * (q[..., 0] + q[..., 1]))
    return np.stack([z.real, z.imag], -1)


@given(angles)
def test_angles_come_back_from_the_hand(q):
    assume(abs(np.sin(q[1])) > 0.05 + 1e-6)
    q = np.array(q)
    found = inverse_kinematics(ARM, hand_of(q), ELBOWS[int(q[1] < 0)])
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * q), atol=1e-9)
    other = inverse_kinematics(ARM, hand_of(q), ELBOWS[int(q[1] > 0)])
    np.testing.assert_allclose(hand_of(other), hand_of(q), atol=1e-9)
    assert np.sign(other[1]) == -np.sign(q[1])


@given(angles, angles)
def test_jacobian_is_the_derivative(q, qd):
    q, qd, h = np.array(q), np.array(qd), 1e-6
    numeric = (hand_of(q + h * qd) - hand_of(q - h * qd)) / (2 * h)
    np.testing.assert_allclose(jacobian(ARM, q) @ qd, numeric, atol=1e-7)


def test_circles_of_many_kinds_at_any_pace():
    """Radii, paces and directions differ by run; derivatives by finite differences."""
    t = np.linspace(0.0, 1.0, 2001)
    pace = np.array([2 * np.pi, -3.0])[:, None]
    phase = pace * (t + 0.3 * t**2), pace * (1 + 0.6 * t), pace * 0.6 * np.ones_like(t)
    centre, radius = np.array([[0.6, 0.1], [0.3, -0.5]]), np.array([0.1, 0.05])
    angle, rate, change = (x[..., None] for x in phase)
    along = np.concatenate([np.cos(angle), np.sin(angle)], -1)
    across = np.concatenate([-np.sin(angle), np.cos(angle)], -1)
    size = radius[:, None, None]
    hand = centre[:, None] + size * along, size * rate * across
    acceleration = size * (change * across - rate**2 * along)
    q, qd, qdd = follow_hand(ARM, *hand, acceleration, "negative")
    offset = hand_of(q) - centre[:, None]
    np.testing.assert_allclose(np.hypot(*np.moveaxis(offset, -1, 0)), radius[:, None] + 0 * t)
    turned = np.unwrap(np.arctan2(offset[..., 1], offset[..., 0]))
    np.testing.assert_allclose(turned - turned[:, :1], phase[0], atol=1e-9)
    for x, rate in ((q, qd), (qd, qdd)):
        numeric = np.gradient(x, t, axis=1, edge_order=2)
        np.testing.assert_allclose(rate, numeric, atol=1e-3 * np.abs(rate).max())


@pytest.mark.parametrize("elbow", ELBOWS)
def test_reach_is_where_inverse_kinematics_ends(elbow):
    near, far = reach(ARM)
    for fine, bad in ((near + 1e-9, near - 1e-6), (far - 1e-9, far + 1e-6)):
        q = inverse_kinematics(ARM, (0.0, fine), elbow)
        assert abs(np.sin(q[1])) == pytest.approx(0.05, abs=1e-6)
        with pytest.raises(Unreachable):
            inverse_kinematics(ARM, (0.0, bad), elbow)
