"""Measures of learners in the loop, on planted results."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import learning

SEEDS = 10
ONE = np.linspace(0.9, 1.1, SEEDS)


def planted():
    motion = {
        "practice": {"memory": [20 * ONE, 8 * ONE], "x": [20 * ONE, 5 * ONE]},
        "tests": {
            name: {
                "no feedforward": plain * ONE,
                "exact equations": 0.1 * ONE,
                "frozen": {"x": size * ONE},
                "learning": {"x": 2 * size * ONE},
            }
            for name, plain, size in (
                ("the same", 20, 5),
                ("circle", 10, 20),
                ("two harmonics", 30, 10),
            )
        },
        "forgetting": {"x": [6 * ONE, 15 * ONE]},
    }
    family = {
        "practice": {"no feedforward": [20 * ONE], "x": [90 * ONE]},
        "tests": {
            "no feedforward": [24 * ONE] * 6,
            "x": [24 * ONE, 13 * ONE, 6 * ONE, 30 * ONE, 20 * ONE, 14 * ONE],
            "y": [24 * ONE] * 3 + [30 * ONE] * 3,
        },
        "at the end": {"no feedforward": 40 * ONE, "x": 10 * ONE, "y": 31 * ONE},
        "without the load again": {"no feedforward": 24 * ONE, "x": 18 * ONE, "y": 24 * ONE},
    }
    stopped = [[False] * SEEDS, [True] * 4 + [False] * 6]
    rates = {"x": {"error": [3 * ONE, np.where(np.arange(SEEDS) < 7, 500, 3)], "stopped": stopped}}
    part = {"motion": motion, "family": family, "rates": rates}
    return {"setups": {"joint damping": part}, "rates": [1.0, 10.0], "trials": 3}


@pytest.fixture(autouse=True)
def study(monkeypatch):
    monkeypatch.setattr(learning.results, "read", lambda name: planted())


def test_ratios_on_other_motions():
    assert learning.elsewhere("x", ["the same"]).value == pytest.approx(0.25)
    both = learning.elsewhere("x", ["circle", "two harmonics"])
    assert both.value == pytest.approx(30 / 40) and both.replicates.size >= 2000
    assert learning.elsewhere("x", ["circle"], learning=True).value == pytest.approx(4.0)
    assert learning.practised("memory").value == pytest.approx(0.4)
    assert learning.forgotten("x").value == pytest.approx(3.0)
    with pytest.raises(ValueError, match="setup"):
        learning.part("motion", "nowhere")


def test_ratios_in_the_family():
    assert learning.ratio("x", "before the load").value == pytest.approx(0.25)
    assert learning.ratio("x", "with the load", "y").value == pytest.approx(1.0)
    assert learning.ratio("x", "at the end", "y").value == pytest.approx(10 / 31)
    assert learning.ratio("x", "without the load again", "y").value == pytest.approx(0.75)
    assert learning.first("x").value == pytest.approx(4.5)


def test_trials_to_half_the_error():
    errors = np.array([[9.0, 9, 9, 2], [4, 9, 9, 2], [9, 4, 9, 2], [4, 4, 9, 2]])
    np.testing.assert_array_equal(learning.trials_to_half(errors, [10.0] * 4), [3, 2, np.inf, 0])
    assert learning.halved("x").value == 2
    assert learning.halved("x", loaded=True).value == 2
    assert learning.halved("y").value == 1e3 and learning.halved("y").text == "no seed"


def test_lost_seeds_are_counted_and_stops_told():
    found = learning.lost("x", 10.0)
    assert found.value == pytest.approx(0.7) and found.text == "7 of 10, 4 stopped"
    assert learning.lost("x", 1.0).value == 0
    with pytest.raises(ValueError, match="times"):
        learning.lost("x", 2.0)


class Counted(float):
    """A number whose products are counted."""

    done = 0

    def __mul__(self, other):
        Counted.done += 1
        return Counted(float(self) * float(other))

    def __add__(self, other):
        return Counted(float(self) + float(other))

    __radd__ = __add__


def counted(rows, columns):
    """Products of a matrix and a vector."""
    Counted.done = 0
    for _ in range(rows):
        sum(Counted(1.0) * Counted(2.0) for _ in range(columns))
    return Counted.done


@pytest.mark.parametrize("hidden, window", [(10, 42), (3, 10)])
def test_multiplications_are_those_of_plain_loops(hidden, window):
    found = learning.multiplications(hidden, window, every=5, replay=4)
    forward = counted(hidden, window) + counted(2, hidden + window)
    assert found["torque"] == forward
    deltas = 2 * 2 + counted(hidden, 2) + 2 * hidden  # o (1 - o) e; through the weights; h (1 - h)
    steps = 2 + hidden + counted(2, hidden + window) + counted(hidden, window)  # rate, products
    assert found["by feedback"] == pytest.approx((deltas + steps) / 5)
    assert found["one pass"] == pytest.approx((forward + deltas + steps) / 5)
    assert found["replay"] == pytest.approx(5 * (forward + deltas + steps) / 5)
    for name, size, before in (
        ("last layer", hidden + window + 1, counted(hidden, window)),
        ("linear filter", window + 1, 0),
    ):
        seen, weight, gain = counted(size, size), counted(1, size), size
        predicted, moved = counted(2, size - 1), counted(2, size)
        covariance = counted(size, size) + size**2  # outer product, over the forgetting
        total = before + seen + weight + gain + predicted + moved + covariance
        assert found[name] == pytest.approx(total / 5)


def test_what_1986_could_afford():
    alone, least = (learning.affordable(name) for name in ("torque", "last layer"))
    assert alone.value == pytest.approx(524 / (277 * 2 / 1.2))
    assert least.value > alone.value and "2,3" in least.text
