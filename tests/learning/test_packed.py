"""Products with a packed matrix: oneDNN and plain PyTorch against sums in double precision."""

import numpy as np
import pytest
import torch

from ddlib.learning import Weights, _packed
from ddlib.learning.descent import Descent

EPS = np.finfo(np.float32).eps


@pytest.mark.parametrize("has_onednn", [True, False])
@pytest.mark.parametrize("rows, inner, columns", [(24, 43, 1500), (24, 1500, 43), (3, 5, 7)])
def test_both_ways_are_within_single_precision_of_the_product(
    rows, inner, columns, has_onednn, monkeypatch
):
    """The bound is that of a sum of `inner` rounded products, in any order."""
    if has_onednn and not _packed._HAS_ONEDNN:
        pytest.skip("no oneDNN operators here: PyTorch's own product takes their place")
    monkeypatch.setattr(_packed, "_HAS_ONEDNN", has_onednn)
    rng = np.random.default_rng(rows + columns)
    left, right = rng.normal(size=(rows, inner)), rng.normal(size=(inner, columns))
    left, right = left.astype(np.float32), right.astype(np.float32)
    times = _packed.product_with(torch.from_numpy(right), rows)
    bound = inner * EPS * (np.abs(left).astype(float) @ np.abs(right).astype(float))
    for scale in (1.0, -0.5):  # the same packed matrix, twice
        product = times(torch.from_numpy(scale * left)).numpy()
        wanted = scale * left.astype(float) @ right.astype(float)
        assert (np.abs(product - wanted) <= bound).all()


def test_both_ways_train_alike(monkeypatch):
    """After 20 epochs weights agree to 2e-5 of the largest way that any of them went."""
    if not _packed._HAS_ONEDNN:
        pytest.skip("no oneDNN operators here: there is one way only")
    rng = np.random.default_rng(1)
    x, y = rng.uniform(size=(1500, 2, 21)), rng.uniform(0.2, 0.8, size=(1500, 2))
    start = Weights.random(3, 21, initial=0.5, seed=7)
    ends = []
    for has_onednn in (True, False):
        monkeypatch.setattr(_packed, "_HAS_ONEDNN", has_onednn)
        descent = Descent(start, x, y, 2.0 / 1500, 0.9)
        for _ in range(20):
            descent.epoch()
        ends.append(descent.first.numpy().copy())
    change = np.abs(ends[0] - Descent(start, x, y, 1.0, 0.0).first.numpy()).max()
    assert change > 0.01
    assert np.abs(ends[0] - ends[-1]).max() <= 2e-5 * change
