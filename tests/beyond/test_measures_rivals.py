"""Measures of rivals on planted studies: pairs by day, equal numbers, floors."""

import numpy as np
import pytest

from workshop.beyond.measures import rivals as measures
from workshop.report import results

PARTS = ("training", "trajectory 6")


def row(rival, size, count, errors, seconds=1.0, inputs="positions"):
    errors = np.asarray(errors, float)
    return {
        "rival": rival,
        "inputs": inputs,
        "size": size,
        "count": count,
        "seconds": [seconds] * len(errors),
        "errors": {part: errors.tolist() for part in PARTS},
    }


DAY = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])  # hard days are hard for all


@pytest.fixture(autouse=True)
def planted(monkeypatch):
    study = {
        "reference": "network",
        "budget": 100,
        "floor": {"positions": {part: 0.5 for part in PARTS}},
        "lines": {name: {} for name in ("network", "small", "large", "worse")},
        "rows": [
            row("network", 2, 40, 3 * DAY),
            row("network", 10, 100, DAY),
            row("small", 1, 10, 2 * DAY, 0.02),
            row("small", 2, 90, 0.5 * DAY[:5], 0.02),
            row("small", 3, 101, 0.1 * DAY),
            row("large", 1, 1000, 0.25 * DAY),
            row("large", 2, 5000, 0.01 * DAY),
            row("worse", 1, 20, 4 * DAY),
        ],
    }
    monkeypatch.setattr(results, "read", lambda name: {"rivals": study}[name])


def test_the_size_is_the_largest_that_is_as_cheap():
    assert measures.row("network")["size"] == 10
    assert measures.row("small")["size"] == 2
    assert measures.row("large")["size"] == 1  # none is: the smallest
    assert measures.row("small", size=3)["count"] == 101
    for wrong in ({"rival": "nobody"}, {"rival": "small", "inputs": "exact states"},
                  {"rival": "small", "size": 9}):  # fmt: skip
        with pytest.raises(ValueError, match="rival must be one of the study"):
            measures.row(**wrong)


def test_ratios_are_taken_day_by_day():
    found = measures.ratio("small")
    assert found.value == 0.5 and np.all(found.replicates == 0.5)
    assert "90 numbers" in found.text and "with 100" in found.text
    assert measures.ratio("small", size=1).value == 2.0
    assert measures.ratio("network", size=2, against="small", against_size=1).value == 1.5


def test_times_and_floors():
    assert measures.time("small").value == pytest.approx(0.02)
    assert measures.above_floor("network", "positions").value == pytest.approx(3.5 / 0.5)


def test_the_share_of_better_ones_counts_what_is_as_cheap():
    found = measures.better()
    assert found.value == 0.5 and found.text == "1 of 2: small"
    assert measures.better(margin=0.4).value == 0.0
