"""The trial of the filters, made small: what it trains, counts and replaces."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.learning import NotConverged, surrogates
from ddlib.metrics import rmss
from workshop.report.studies import nulls as study

SMALL = replace(study.TRIAL, epochs=40, warm_up=10, hidden=3)


@pytest.fixture(scope="module")
def trial():
    return study.FilterTrial(SMALL, SMALL.record(), 7)


@pytest.fixture(scope="module")
def trained(trial):
    targets = np.stack([trial.torques, *surrogates("phases", trial.torques, 2)])
    return targets, *trial.train(targets, 5)


def test_each_network_learns_its_own_target(trial, trained):
    """The error on its own target falls; trained alone on it, a network comes out the same."""
    targets, weights, start = trained
    for k, target in enumerate(targets):
        wanted = target.reshape(-1, 2)
        before, after = (
            rmss(trial.model(w)[k].torque(trial.windows), wanted) for w in (start, weights)
        )
        assert after < before
        alone, _ = trial.train(targets[k : k + 1], 5 + k)
        assert np.allclose(alone.direct_weights[0], weights.direct_weights[k], atol=1e-5)
    found = trial.described(weights, start, targets)
    assert found["error"][2] == pytest.approx(
        rmss(trial.model(weights)[2].torque(trial.windows), targets[2].reshape(-1, 2))
    )


def test_replaced_by_themselves_filters_change_nothing(trial, trained):
    _, weights, start = trained
    own = trial.replaced(weights, weights.hidden_weights)
    assert own["at once"] == pytest.approx(trial.errors(trial.model(weights)))
    other = trial.replaced(weights, start.hidden_weights)
    hidden = replace(weights, hidden_weights=start.hidden_weights).activity(trial.data.x)[0]
    x = np.column_stack([hidden[1], trial.windows.reshape(1500, -1), np.ones(1500)])
    fit = x @ np.linalg.pinv(x) @ trial.torque
    assert other["refitted"][1, 0] == pytest.approx(rmss(fit, trial.torque), rel=1e-6)


def test_the_solver_takes_the_place_of_descent():
    setup = replace(study.JOINT_DAMPING, steps=2, hidden=2)
    trial = study.FilterTrial(setup, setup.record(), 5)
    targets = np.stack([trial.torques, *surrogates("phases", trial.torques, 1)])
    with pytest.warns(NotConverged):
        weights, start = trial.train(targets, 0)
    assert len(weights) == 2 and not np.allclose(weights.hidden_weights, start.hidden_weights)
    own = rmss(trial.model(weights)[1].torque(trial.windows), targets[1].reshape(-1, 2))
    assert own < rmss(trial.model(weights)[0].torque(trial.windows), targets[1].reshape(-1, 2))


def test_torque_per_acceleration_of_a_slow_sine_by_hand():
    """A stiffness k takes k / omega^2 from the inertia; friction and a constant take nothing."""
    omega, t = np.pi / 3, np.arange(300) / 100
    states = np.stack(
        [np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t)], -1
    )
    torque = states @ np.array([[0.0, 0.0, 6.4], [6.5, 5.0, 6.4]]).T + [3.0, -1.0]
    assert np.allclose(study._response(torque.T, states), [6.4, 6.4 - 6.5 / omega**2])
