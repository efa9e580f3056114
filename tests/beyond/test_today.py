"""Rivals of today: ensembles of networks on states, alone and beside the equations."""

import numpy as np
import pytest

from beyond.rivals.protocol import Cases
from beyond.rivals.today import EquationsAndNetworks, StateNetworks
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.metrics import rmss

QUICK = {"units": 16, "decay": 0.01, "epochs": 300}


@pytest.fixture(scope="module")
def known():
    """States and the torques of an arm without friction, for learning and for a test."""
    x = np.random.default_rng(0).uniform(-1.0, 1.0, (600, 2, 3))
    torque = CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(x, -1, 0))
    return Cases(x[:500], torque[:500], "states", 0.01), Cases(
        x[500:], torque[500:], "states", 0.01
    )


def test_networks_beside_exact_equations_have_nothing_to_add(known):
    training, test = known
    rival = EquationsAndNetworks(**QUICK).fit(training)
    assert rmss(rival.torque(test.x), test.torque) < 1e-6


def test_an_ensemble_answers_with_its_mean_and_disagrees_where_it_has_not_been(known):
    training, test = known
    rival = StateNetworks(**QUICK).fit(training)
    assert rmss(rival.torque(test.x), test.torque) < 0.2
    assert rival.torque(test.x) == pytest.approx(rival.each(test.x).mean(0))
    here, far = (rival.deviation(x).mean() for x in (test.x, 3.0 * test.x))
    assert 0 < here < far


def test_a_direction_is_seen(known):
    """Dry friction is learnt, too, although it jumps where a velocity changes its sign."""
    _training, _test = known
    rough = [Cases(c.x, c.torque + 5.0 * np.sign(c.x[..., 1]), "states", 0.01) for c in known]
    rival = StateNetworks(**QUICK).fit(rough[0])
    assert rmss(rival.torque(rough[1].x), rough[1].torque) < 0.25
    assert rival.count() == 3 * (9 * 16 + 17 * 16 + 17 * 2) + 2 * (8 + 2)
