"""The paper's network as a rival: its formula, its ways of training against plain ones."""

import numpy as np
import pytest
import torch
from scipy.special import expit

from beyond.rivals.networks import ByAdam, ByDescent, BySolver, _adam
from beyond.rivals.protocol import Cases
from ddlib.learning import TrainingDiverged


def windows(n=150, width=5, seed=0):
    """Windows, and torques that no linear filter gives."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1, 1, (n, 2, width))
    first, second = rng.normal(size=(2, 2, 2 * width)) / width
    flat = x.reshape(n, -1)
    return Cases(x, np.tanh(4 * flat @ first.T) + flat @ second.T, "windows", 0.01)


RIVALS = [
    ByDescent(4, epochs=30, seed=3),
    BySolver(4, steps=5, seed=3),
    ByAdam(4, epochs=30, seed=3),
]


@pytest.mark.parametrize("rival", RIVALS, ids=repr)
def test_torques_are_those_of_the_formula(rival):
    data = windows()
    rival.fit(data)
    w = rival.model.weights
    low, high = data.x.min((0, 2)), data.x.max((0, 2))
    x = ((data.x - low[:, None]) / (high - low)[:, None]).reshape(150, -1)
    x = rival.scaling[0] + x * np.ptp(rival.scaling)
    hidden = expit(x @ w.hidden_weights.reshape(4, -1).T + w.hidden_bias)
    net = x @ w.direct_weights.reshape(2, -1).T + hidden @ w.output_weights.T + w.output_bias
    low, high = data.torque.min(0), data.torque.max(0)
    wanted = low + (high - low) * (expit(net) - 0.2) / 0.6
    np.testing.assert_allclose(rival.torque(data.x), wanted, rtol=1e-6, atol=1e-6)
    numbers = (w.hidden_weights, w.hidden_bias, w.output_weights, w.direct_weights, w.output_bias)
    assert rival.count() == sum(x.size for x in numbers) + 4
    ends = (-1.0, 1.0) if isinstance(rival, ByAdam) else (0.0, 1.0)
    assert rival.model.inputs.target == ends and rival.model.outputs.target == (0.2, 0.8)


def test_adam_steps_as_published():
    """Kingma & Ba's algorithm 1 with decoupled decay, for three steps of a linear unit."""
    x = np.array([[0.5, -1.0], [2.0, 0.3], [-0.7, 1.1]])
    y = np.array([[1.0], [0.2], [-0.4]])
    module = torch.nn.Linear(2, 1, bias=False)
    w = module.weight.detach().numpy().astype(float).copy()
    _adam(module, x, y, epochs=3, rate=0.1, decay=0.2)
    m, v = np.zeros_like(w), np.zeros_like(w)
    for t in range(1, 4):
        rate = 0.1 * 0.5 * (1 + np.cos(np.pi * (t - 1) / 3))
        gradient = 2 * ((x @ w.T - y) * x).mean(0)[None]
        m, v = 0.9 * m + 0.1 * gradient, 0.999 * v + 0.001 * gradient**2
        step = (m / (1 - 0.9**t)) / (np.sqrt(v / (1 - 0.999**t)) + 1e-8)
        w = w - rate * 0.2 * w - rate * step
    np.testing.assert_allclose(module.weight.detach().numpy(), w, atol=1e-6)
    with pytest.raises(TrainingDiverged, match="lower the rate"):
        _adam(torch.nn.Linear(2, 1), np.full((3, 2), 1e30), np.ones((3, 1)), 3, 0.1, 0.0)
