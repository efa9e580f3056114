"""Responses against filters whose output is known, gradients against differences."""

import numpy as np
import pytest

from ddlib.analysis import explained, filter_responses, gains, mean_gradient, savitzky_golay
from ddlib.learning import Scaler, TorqueModel, Weights

RNG = np.random.default_rng(0)
STEP, WIDTH = 0.01, 11
X = STEP * (np.arange(WIDTH) - WIDTH // 2)


def parabolas(cases=400):
    """Windows of parabolas and their exact states, drawn independently."""
    states = RNG.normal(size=(cases, 2, 3)) * (0.3, 0.5, 4.0)
    q, v, a = np.moveaxis(states, -1, 0)[..., None]
    return q + v * X + a * X**2 / 2, states


WINDOWS, STATES = parabolas()
TAPS = np.stack([savitzky_golay(WIDTH, k, STEP, degree=2) for k in range(3)])


def test_explained_is_the_squared_correlation():
    a, b = RNG.normal(size=(2, 500))
    target = a + 0.5 * b
    assert explained(target, a) == pytest.approx(np.corrcoef(target, a)[0, 1] ** 2)
    assert explained(target, a, b) == pytest.approx(1)
    assert explained(target, np.ones(500)) == 0


def test_shares_of_a_known_mixture():
    """Independent quantities of known size: shares are those of the variances."""
    rng = np.random.default_rng(1)
    states = rng.normal(size=(200_000, 1, 3)) * (0.3, 0.5, 4.0)
    windows = (states @ np.array([[1, 1, 1], X[:3], X[:3] ** 2 / 2])).reshape(-1, 1, 3)
    f = np.array([[[1.0, 2.0, 4.0]]])
    gain = np.array([[1, 1, 1], X[:3], X[:3] ** 2 / 2]) @ f[0, 0]
    part = (gain * (0.3, 0.5, 4.0)) ** 2
    found = filter_responses(f, windows, states)
    np.testing.assert_allclose(found.alone[0, 0], part / part.sum(), atol=5e-3)
    np.testing.assert_allclose(found.unique[0, 0], part / part.sum(), atol=5e-3)


def ensemble(members=3):
    weights = Weights.random(members, WIDTH, hidden=4, initial=1.0, seed=5)
    inputs = Scaler(np.array([-1.0, -0.5]), np.array([0.5, 1.5]))
    outputs = Scaler(np.array([-20.0, -5.0]), np.array([30.0, 4.0]), (0.2, 0.8))
    return TorqueModel(weights, inputs, outputs)


def test_the_mean_gradient_is_that_of_the_torque():
    model, windows = ensemble(), WINDOWS[:40]
    found = mean_gradient(model, windows)
    assert found.shape == (3, 2, 2, WIDTH)
    for joint, sample in ((0, 0), (0, 7), (1, 3)):
        step = np.zeros_like(windows)
        step[:, joint, sample] = 1e-5
        change = model.torque(windows + step) - model.torque(windows - step)
        np.testing.assert_allclose(found[..., joint, sample], change.mean(1) / 2e-5, rtol=1e-6)
    np.testing.assert_allclose(mean_gradient(model[1], windows), found[1])


def test_gains_of_textbook_filters_are_one():
    np.testing.assert_allclose(gains(TAPS, STEP), np.eye(3), atol=1e-9)
    assert gains(np.zeros((4, 2, 2, 21)), STEP).shape == (4, 2, 2, 3)
    np.testing.assert_allclose(gains([0.0, 0.0, 1.0], 0.5), [1.0, 0.5, 0.125])
