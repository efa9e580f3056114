"""A load in the hand: the same arm as one whose second link carries it."""

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM, STANDARD_GRAVITY, jacobian, with_load


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM])
def test_the_load_adds_its_kinetic_energy_and_its_weight(arm):
    q, qd = np.random.default_rng(0).uniform(-2, 2, (2, 50, 2))
    mass, loaded = 3.0, with_load(arm, 3.0)
    hand = np.einsum("nij,nj->ni", jacobian(arm, q), qd)
    more = loaded.kinetic_energy(q, qd) - arm.kinetic_energy(q, qd)
    np.testing.assert_allclose(more, 0.5 * mass * (hand**2).sum(-1), rtol=1e-12)
    down = np.array([mass * STANDARD_GRAVITY, 0.0]) if any(arm.gravity_moments) else np.zeros(2)
    weight = -np.einsum("nij,i->nj", jacobian(arm, q), down)  # angles count from hanging
    np.testing.assert_allclose(loaded.gravity(q) - arm.gravity(q), weight, atol=1e-11)


def test_no_load_changes_nothing():
    loaded = with_load(CMU_DD_ARM_II, 0)
    assert (loaded.a, loaded.b, loaded.d) == (CMU_DD_ARM_II.a, CMU_DD_ARM_II.b, CMU_DD_ARM_II.d)


@pytest.mark.parametrize("mass", [-1.0, np.nan])
def test_a_load_must_not_be_negative(mass):
    with pytest.raises(ValueError, match="mass"):
        with_load(CMU_DD_ARM_II, mass)
