"""Learners in the loop: trials to half the error, and multiplications counted step by step."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import learning


def test_trials_to_half_the_error(monkeypatch):
    errors = np.array([[9.0, 9, 9, 2], [4, 9, 9, 2], [9, 4, 9, 2], [4, 4, 9, 2]])
    np.testing.assert_array_equal(learning._trials_to_half(errors, [10.0] * 4), [3, 2, np.inf, 0])
    tests = {"no feedforward": [24] * 6, "x": [24, 13, 6, 30, 20, 14], "y": [24] * 3 + [30] * 3}
    family = {
        "tests": {name: np.outer(trials, np.ones(5)) for name, trials in tests.items()},
        "at the end": {"x": np.full(5, 10.0), "y": np.full(5, 31.0)},
    }
    planted = {"setups": {"joint damping": {"family": family}}, "trials": 3}
    monkeypatch.setattr(learning.results, "read", lambda name: planted)
    assert learning.halved("x").value == 2
    assert learning.halved("x", loaded=True).value == 2
    assert learning.halved("y").text == "no seed"
    loaded = [np.median(learning.family("x", when)) for when in ("with the load", "at the end")]
    assert loaded == [30, 10]
    with pytest.raises(ValueError, match="setup"):
        learning.part("motion", "nowhere")


@pytest.mark.parametrize("hidden, window", [(10, 42), (3, 10)])
def test_multiplications_step_by_step(hidden, window):
    found = learning.multiplications(hidden, window, every=5, replay=4)
    forward = hidden * window + 2 * (hidden + window)
    assert found["torque"] == forward
    deltas = 2 * 2 + 2 * hidden + 2 * hidden  # o (1 - o) e; through the weights; h (1 - h)
    steps = 2 + hidden + forward  # the rate, products
    assert found["by feedback"] == pytest.approx((deltas + steps) / 5)
    assert found["one pass"] == pytest.approx((forward + deltas + steps) / 5)
    assert found["replay"] == pytest.approx(forward + deltas + steps)
    for name, size, before in (
        ("last layer", hidden + window + 1, hidden * window),
        ("linear filter", window + 1, 0),
    ):
        seen, weight, gain = size**2, size, size
        predicted, moved = 2 * (size - 1), 2 * size
        covariance = 2 * size**2  # outer product, over the forgetting
        total = before + seen + weight + gain + predicted + moved + covariance
        assert found[name] == pytest.approx(total / 5)
