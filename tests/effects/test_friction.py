"""Friction: symmetry, dissipation, closed forms; what it is at rest and at speed."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.effects import CoulombFriction, StickSlipFriction, StribeckFriction, ViscousFriction

FRICTIONS = (
    ViscousFriction((0.5, 0.15)),
    CoulombFriction((0.5, 0.15)),
    CoulombFriction((8.45, 2.35), smoothing=0.02),
)
FALLING = (
    StribeckFriction((0.5, 0.15), (0.65, 0.2)),
    StickSlipFriction((0.5, 0.15), (0.65, 0.2)),
)


@pytest.mark.parametrize("friction", FRICTIONS + FALLING, ids=repr)
@settings(deadline=None, max_examples=50)
@given(qd=st.tuples(st.floats(-50, 50), st.floats(-50, 50)))
def test_friction_is_odd_and_never_adds_energy(friction, qd):
    qd, torque = np.array(qd), friction.torque
    np.testing.assert_array_equal(torque(-qd), -torque(qd))
    assert (qd * torque(qd) >= 0).all()


@pytest.mark.parametrize("kind", [StribeckFriction, StickSlipFriction])
def test_stribeck_friction_by_numbers(kind):
    friction = kind((0.5, 1.0), (1.5, 1.0), speed=0.1)
    np.testing.assert_allclose(friction.size([0.0, 0.0]), [1.5, 1.0])
    np.testing.assert_allclose(friction.torque([0.1, -0.1]), [0.8678794411714423, -1.0])
    np.testing.assert_allclose(friction.torque([3.0, -3.0]), [0.5, -1.0])
    # falls all the way from near rest to speed
    falling = friction.torque(np.linspace(0.02, 1, 99)[:, None] * np.ones(2))[:, 0]
    assert (np.diff(falling[falling > 0.5 + 1e-9]) < 0).all() and falling[0] > 1.4


@pytest.mark.parametrize("friction", FRICTIONS + FALLING[:1], ids=repr)
def test_slope_is_the_steepest_rise(friction):
    qd = np.linspace(-0.001, 0.001, 2_001)[:, None] * np.ones(2)
    rise = np.diff(friction.torque(qd), axis=0) / np.diff(qd, axis=0)
    np.testing.assert_allclose(rise.max(0), friction.slope, rtol=1e-3)
