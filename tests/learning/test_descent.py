"""Products with inputs that stay the same, and descent with them against plain sums."""

import numpy as np
import pytest
import torch

from ddlib.learning import Weights, descent
from ddlib.learning.network import FIELDS


@pytest.mark.parametrize("onednn", sorted({False, descent.ONEDNN}))
@pytest.mark.parametrize("shape", [(96, 43, 1500), (12, 83, 1500), (84, 1500, 23), (3, 5, 7)])
def test_products_are_those_of_plain_matrices(shape, onednn, monkeypatch):
    monkeypatch.setattr(descent, "ONEDNN", onednn)
    rows, inner, columns = shape
    torch.manual_seed(1)
    matrix = torch.randn(inner, columns)
    product = descent.times(matrix, rows)
    for _ in range(2):  # what is packed stays
        left = torch.randn(rows, inner)
        wanted = left.double() @ matrix.double()
        by_product = product(left)
        assert by_product.shape == wanted.shape and by_product.dtype == torch.float32
        assert by_product.is_contiguous()
        bound = 2e-7 * inner * (left.abs() @ matrix.abs()).max()
        assert (by_product - wanted).abs().max() < bound


def test_a_large_product_goes_through_onednn_where_it_can(monkeypatch):
    if not descent.ONEDNN:
        pytest.skip("oneDNN is not here")
    asked = []
    plain = torch.mm
    monkeypatch.setattr(torch, "mm", lambda *two: asked.append(two) or plain(*two))
    descent.times(torch.ones(43, 1500), 96)(torch.ones(96, 43))
    assert not asked
    descent.times(torch.ones(6, 32), 4)(torch.ones(4, 6))
    assert len(asked) == 1


def by_hand(network, x, y, epochs, eps, alpha):
    """The same rule in double precision, for one network: its weights after some epochs."""
    w = [np.array(getattr(network, name), dtype=float) for name in FIELDS]
    flat = x.reshape(len(x), -1)
    w[0], w[3] = w[0].reshape(len(w[0]), -1), w[3].reshape(len(w[3]), -1)
    steps = [np.zeros_like(part) for part in w]
    for _ in range(epochs):
        h = 1 / (1 + np.exp(-(flat @ w[0].T + w[1])))
        o = 1 / (1 + np.exp(-(h @ w[2].T + flat @ w[3].T + w[4])))
        delta = (o - y) * o * (1 - o)
        back = (delta @ w[2]) * h * (1 - h)
        slopes = [back.T @ flat, back.sum(0), delta.T @ h, delta.T @ flat, delta.sum(0)]
        steps = [alpha * s - eps * g for s, g in zip(steps, slopes)]
        w = [part + s for part, s in zip(w, steps)]
    return w


@pytest.mark.parametrize("cases", [40, 1500])
def test_many_networks_step_as_each_alone_in_double_precision(cases):
    """Small and large products; every member has a momentum of its own."""
    rng = np.random.default_rng(2)
    x, y = rng.uniform(size=(cases, 2, 21)), rng.uniform(0.2, 0.8, size=(cases, 2))
    weights, alpha = Weights.random(3, 21, initial=0.3), np.array([0.0, 0.5, 0.9])
    many = descent.Descent(weights, x, y, 1 / cases, alpha)
    for _ in range(25):
        many.epoch()
    after = many.weights()
    for k in range(3):
        wanted = by_hand(weights[k], x, y, 25, 1 / cases, alpha[k])
        for name, array in zip(FIELDS, wanted):
            own = getattr(after, name)[k].reshape(array.shape)
            np.testing.assert_allclose(own, array, atol=2e-5)
    assert np.abs(after.hidden_weights - weights.hidden_weights).max() > 1e-3
