"""Descent with and without the products of oneDNN: both train alike."""

import numpy as np
import pytest

from ddlib.learning import Weights, _packed
from ddlib.learning.descent import Descent


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
