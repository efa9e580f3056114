"""What is counted of an ensemble's filters, where all of them are known."""

import numpy as np

from ddlib.analysis import LAYERS, gains, mean_gradient, savitzky_golay
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.simulation import LOG_STEP
from workshop.report.studies.harmonics import _summary

STEP, WIDTH = 0.01, 11
X = STEP * (np.arange(WIDTH) - WIDTH // 2)


def test_a_summary_counts_network_by_network():
    states = np.random.default_rng(0).normal(size=(400, 2, 3)) * (0.3, 0.5, 4.0)
    q, v, a = np.moveaxis(states, -1, 0)[..., None]
    windows = q + v * X + a * X**2 / 2
    taps = [savitzky_golay(WIDTH, k, STEP, degree=2) for k in range(3)]
    weights = Weights.random(3, WIDTH, hidden=4, initial=1.0, seed=5)
    for unit, order in enumerate((2, 2, 1, 0)):
        weights.hidden_weights[:, unit] = taps[order]
    weights.hidden_weights[1, 0] = taps[1]  # network 1: one acceleration filter fewer
    weights.direct_weights[:] = taps[2]
    inputs = Scaler(np.array([-1.0, -0.5]), np.array([0.5, 1.5]))
    outputs = Scaler(np.array([-20.0, -5.0]), np.array([30.0, 4.0]), (0.2, 0.8))
    model = TorqueModel(weights, inputs, outputs)
    found = _summary(model, windows, states)
    np.testing.assert_allclose(found["hidden"]["classes"]["acceleration"][[0, 2]], 0.75)
    np.testing.assert_allclose(found["hidden"]["follow"]["acceleration"], [0.5, 0.25, 0.5])
    for layer in LAYERS:
        np.testing.assert_allclose(sum(found[layer]["classes"].values()), 1)
        assert found[layer]["unique"].shape == (3, 3)
    np.testing.assert_allclose(found["gains"], gains(mean_gradient(model, windows), LOG_STEP))
