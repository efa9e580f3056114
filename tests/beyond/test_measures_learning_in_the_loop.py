"""Learners in the loop: trials to half the error, and multiplications counted step by step."""

import numpy as np
import pytest

from beyond.chapters import learning_in_the_loop as learning

pytestmark = pytest.mark.usefixtures("planted_members")


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
