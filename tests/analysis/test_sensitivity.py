"""What networks of states respond to: shares, transition regions, responses, shuffling."""

import numpy as np
import pytest
from scipy.optimize import brentq

from ddlib.analysis import input_shares, responses, shuffled, transition_centre, transition_range
from ddlib.learning import TorqueModel, TrainingSet, Weights
from workshop.report.exact_states import random_states, torque

STATES = random_states(4000, seed=9)


@pytest.fixture(scope="module")
def model():
    data = TrainingSet.from_arrays(STATES, torque(STATES))
    return TorqueModel(Weights.random(3, 3, 4, initial=6.0), data.inputs, data.outputs)


def activity(model, state):
    """Of the hidden units of all members in one state, by the sigmoid's formula."""
    x = (np.asarray(state) - model.inputs.low[:, None]) / (
        model.inputs.high - model.inputs.low
    )[:, None]  # fmt: skip
    net = (model.weights.hidden_weights * x).sum((-2, -1)) + model.weights.hidden_bias
    return 1 / (1 + np.exp(-net))


def test_shares_are_those_of_the_variance(model):
    """Against the variance of each part of the net input over many random states."""
    shares = input_shares(model.weights)
    assert shares.shape == (3, 4, 2, 3)
    np.testing.assert_allclose(shares.sum((-2, -1)), 1.0)
    parts = model.weights.hidden_weights[:, :, None] * model.scaled(STATES)
    whole = parts.sum((-2, -1)).var(-1)
    np.testing.assert_allclose(
        shares, parts.var(2) / whole[..., None, None], rtol=0.1, atol=0.03
    )  # fmt: skip


def test_transition_range_is_where_the_activity_changes():
    """One input after the other: from 0.1 to 0.9 by root finding on the sigmoid."""
    weights = Weights.random(1, 3, 2, initial=9.0)[0]
    found = transition_range(weights)
    for unit, joint, place in np.ndindex(2, 2, 3):
        w = weights.hidden_weights[unit, joint, place]

        def level(x, value, w=w):
            return 1 / (1 + np.exp(-w * x)) - value

        ends = [brentq(level, -50, 50, args=(value,)) for value in (0.1, 0.9)]
        np.testing.assert_allclose(found[unit, joint, place], abs(ends[1] - ends[0]), rtol=1e-6)
    assert (transition_range(weights, 0.2) < found).all()
    weights.hidden_weights[0, 0, 0] = 0.0
    assert np.isinf(transition_range(weights)[0, 0, 0])


def test_units_are_half_on_at_their_centres(model):
    centre = transition_centre(model)
    assert centre.shape == (3, 4, 2, 3)
    for member, unit, joint, place in np.ndindex(*centre.shape):
        state = np.zeros((2, 3))
        state[joint, place] = centre[member, unit, joint, place]
        assert activity(model, state)[member, unit] == pytest.approx(0.5, abs=1e-9)


def test_responses_are_activities_along_one_input(model):
    values = np.linspace(-3, 3, 5)
    found = responses(model, values)
    assert found.shape == (3, 2, 3, 5, 4)
    for joint, place, point in np.ndindex(2, 3, 5):
        state = np.zeros((2, 3))
        state[joint, place] = values[point]
        np.testing.assert_allclose(found[:, joint, place, point], activity(model, state))


def test_shuffling_what_is_linear_changes_by_twice_the_variance():
    """Two independent draws differ by sqrt(2) standard deviations."""
    matrix = np.arange(12.0).reshape(2, 6)

    def predict(states):
        return states.reshape(len(states), 6) @ matrix.T

    changes = shuffled(predict, STATES, np.ones(2)).ravel()
    wanted = np.sqrt(2 * (matrix**2).mean(0)) * np.pi / np.sqrt(3)
    np.testing.assert_allclose(changes, wanted, rtol=0.03)
