"""Friction: symmetry, dissipation, closed forms; what it is at rest and at speed."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.effects import (
    CoulombFriction,
    Effects,
    StickSlipFriction,
    StribeckFriction,
    ViscousFriction,
)

FRICTIONS = (
    ViscousFriction((0.5, 0.15)),
    CoulombFriction((0.5, 0.15)),
    CoulombFriction((8.45, 2.35), smoothing=0.02),
    Effects(friction=(ViscousFriction((5.3, 1.1)), CoulombFriction((8.45, 2.35)))),
)
FALLING = (
    StribeckFriction((0.5, 0.15), (0.65, 0.2)),
    StribeckFriction((0.5, 0.15), (2.0, 0.15), speed=0.5, smoothing=1e-4),
    StickSlipFriction((0.5, 0.15), (0.65, 0.2)),
    StickSlipFriction((0.0, 1.0), (0.5, 1.0), speed=1e-3),
)


def torque_of(friction):
    return friction.friction_torque if isinstance(friction, Effects) else friction.torque


@pytest.mark.parametrize("friction", FRICTIONS + FALLING, ids=repr)
@settings(deadline=None, max_examples=50)
@given(qd=st.tuples(st.floats(-50, 50), st.floats(-50, 50)))
def test_friction_is_odd_and_never_adds_energy(friction, qd):
    qd, torque = np.array(qd), torque_of(friction)
    np.testing.assert_array_equal(torque(-qd), -torque(qd))
    assert (qd * torque(qd) >= 0).all()


def test_frictions_by_numbers():
    np.testing.assert_allclose(ViscousFriction((5.3, 1.1)).torque([2.0, -3.0]), [10.6, -3.3])
    friction = CoulombFriction((8.45, 2.35))
    np.testing.assert_allclose(friction.torque(np.array([0.5, -0.5])), [8.45, -2.35], rtol=1e-12)
    # at one smoothing width, tanh(1) of it
    wide = CoulombFriction((1.0, 1.0), smoothing=0.1)
    np.testing.assert_allclose(wide.torque(np.array([0.1, 0.2])), [0.761594, 0.964028], atol=1e-6)


@pytest.mark.parametrize("kind", [StribeckFriction, StickSlipFriction])
def test_stribeck_friction_by_numbers(kind):
    friction = kind((0.5, 1.0), (1.5, 1.0), speed=0.1)
    np.testing.assert_allclose(friction.size([0.0, 0.0]), [1.5, 1.0])
    np.testing.assert_allclose(friction.size([0.1, -0.1]), [0.5 + np.exp(-1), 1.0])
    np.testing.assert_allclose(friction.torque([0.1, -0.1]), [0.8678794411714423, -1.0])
    np.testing.assert_allclose(friction.torque([3.0, -3.0]), [0.5, -1.0])
    # falls all the way from near rest to speed
    falling = friction.torque(np.linspace(0.02, 1, 99)[:, None] * np.ones(2))[:, 0]
    assert (np.diff(falling[falling > 0.5 + 1e-9]) < 0).all() and falling[0] > 1.4


@pytest.mark.parametrize("friction", FRICTIONS[:3] + FALLING[:2], ids=repr)
def test_slope_is_the_steepest_rise(friction):
    qd = np.linspace(-0.001, 0.001, 2_001)[:, None] * np.ones(2)
    rise = np.diff(friction.torque(qd), axis=0) / np.diff(qd, axis=0)
    np.testing.assert_allclose(rise.max(0), friction.slope, rtol=1e-3)


def test_refusals():
    good = dict(level=(0.1, 0.1), breakaway=(0.2, 0.2))
    for kind, name, *values in (
        (ViscousFriction, "coefficient", (-0.1, 0.1), (0.1,), (np.nan, 0.1)),
        (CoulombFriction, "level", (0.1, -0.1)),
        (CoulombFriction, "smoothing", 0.0),
        (StribeckFriction, "breakaway", (0.2, 0.05), (0.2, np.inf)),
        (StribeckFriction, "smoothing", 0.0),
        (StickSlipFriction, "level", (0.1, -0.1)),
        (StickSlipFriction, "speed", 0.0),
    ):
        fits = {k: v for k, v in good.items() if k in kind.__dataclass_fields__}
        for bad in values:
            with pytest.raises(ValueError, match=rf"^{name} must"):
                kind(**{**fits, name: bad})
