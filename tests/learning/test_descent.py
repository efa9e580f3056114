"""Descent with momentum: products, steps and blocks against plain sums in double precision."""

import numpy as np
import pytest
from small_networks import WIDTH, close, parts

from ddlib.learning import (
    TrainingSet,
    Weights,
    WindowNetwork,
    descent,
    train,
    train_ensemble,
)


def by_hand(network, x, y, momenta, eps):
    """Weights of one network after a step for each momentum, in double precision.

    ``dw(t) = -eps dE/dw + alpha dw(t-1)``, the rule of 1988.
    """
    w = [np.array(part, dtype=float) for part in parts(network)]
    flat = x.reshape(len(x), -1)
    w[0], w[3] = w[0].reshape(len(w[0]), -1), w[3].reshape(len(w[3]), -1)
    steps = [np.zeros_like(part) for part in w]
    for alpha in momenta:
        h = 1 / (1 + np.exp(-(flat @ w[0].T + w[1])))
        o = 1 / (1 + np.exp(-(h @ w[2].T + flat @ w[3].T + w[4])))
        delta = (o - y) * o * (1 - o)
        back = (delta @ w[2]) * h * (1 - h)
        slopes = [back.T @ flat, back.sum(0), delta.T @ h, delta.T @ flat, delta.sum(0)]
        steps = [alpha * s - eps * g for s, g in zip(steps, slopes)]
        w = [part + s for part, s in zip(w, steps)]
    return [part.reshape(own.shape) for part, own in zip(w, parts(network))]


@pytest.mark.parametrize(
    "cases, warm_up, workers, block",
    [(40, 0, 1, 8), (40, 3, 2, 1), (1500, 0, 5, 8), (1500, 3, 2, 1)],
)
def test_every_network_steps_by_the_rule_of_1988(cases, warm_up, workers, block, monkeypatch):
    """In one to three blocks; the warm-up limits the momentum of the first steps to 0.5."""
    monkeypatch.setattr(descent, "WORKERS", workers)
    monkeypatch.setattr(descent, "_BLOCK", block)
    rng = np.random.default_rng(2)
    windows, torque = rng.uniform(size=(cases, 2, 21)), rng.normal(size=(cases, 2))
    data = TrainingSet.from_arrays(windows, torque)
    start, momenta = Weights.random(3, 21, initial=0.5, seed=7), [0.9, 0.3, 0.0]
    before, options = [p.copy() for p in parts(start)], dict(rate=4.0, epochs=12, progress=False)
    model, *_ = train_ensemble(start, data, momentum=momenta, warm_up=warm_up, **options)
    network = WindowNetwork(21, initial=0.5, seed=7)
    train(network, data.x, data.y, momentum=0.9, **options)
    for k, momentum in enumerate(momenta):
        course = [min(momentum, 0.5)] * warm_up + [momentum] * (12 - warm_up)
        wanted = by_hand(start[k], data.x, data.y, course, 4.0 / cases)
        moved = max(np.abs(a - b).max() for a, b in zip(wanted, parts(start[k])))
        assert moved > 0.05
        close(model.weights[k], wanted, rtol=0, atol=1e-4 * moved)
        if k == 0 and not warm_up:
            close(network.weights(), wanted, rtol=0, atol=1e-4 * moved)
    close(start, before, rtol=0)  # initial weights are not touched


def test_members_may_have_their_own_rate_momentum_and_targets(data, other):
    """Together as alone; the errors are relative to the spread of the shared targets."""
    start, rates, momenta = Weights.random(4, WIDTH), [1.0, 2.0, 4.0, 3.0], [0.0, 0.5, 0.9, 0.95]
    noise = np.random.default_rng(3).normal(size=(4, *data.y.shape))
    targets = data.y + np.array([0.0, 0.01, 0.02, 0.05])[:, None, None] * noise
    options = dict(epochs=30, test=other, progress=False)
    together, errors, _ = train_ensemble(
        start, data, rate=rates, momentum=momenta, targets=targets, **options
    )
    for k in range(4):
        own = TrainingSet(data.x, targets[k], data.inputs, data.outputs)
        alone, history, _ = train_ensemble(
            start[k : k + 1], own, rate=rates[k], momentum=momenta[k], **options
        )
        close(together.weights[k], [p[0] for p in parts(alone.weights)], rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(errors.test[:, k], history.test[:, 0], rtol=1e-5)
        out = together.weights[k].activity(data.x)[1]
        wanted = np.sqrt((((out - targets[k]) / data.y.std(0)) ** 2).mean())
        assert errors.training[-1, k] == pytest.approx(wanted, rel=1e-5)
