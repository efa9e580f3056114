"""Measures of findings under other conditions, on planted results."""

import pytest

from workshop.beyond.measures.loop import conditions
from workshop.report import results

PLANTED = {
    "copies": {"joint damping": {"0.1": [1.0, 2.0, 3.0], "network": [8.0, 4.0, 2.0]}},
    "stopped": {
        "joint damping": {
            "hands": {"circles": {"chosen": [2.0, 4.0, 6.0], "none": [8.0], "60": [8.0, 16.0, 4.0]}}
        }
    },
    "windows": {"chosen": [0.1, 0.5, 0.3]},
    "practised": {
        "joint damping": {"in step": {"circle": {"memory": [1.0, 6.0, 2.0], "none": [2.0] * 3}}}
    },
}


@pytest.fixture(autouse=True)
def planted(monkeypatch):
    monkeypatch.setattr(results, "read", {"loop-conditions": PLANTED}.__getitem__)


def test_equations_over_networks():
    found = conditions.copied(0.1)
    assert found.value == 2.0 / 4.0 and "against" in found.text
    assert found.replicates.min() < 0.5 < found.replicates.max()


def test_one_value_is_not_drawn():
    found = conditions.stopped()
    assert found.value == 4.0 / 8.0 and found.replicates.max() == 6.0 / 8.0


def test_two_groups_are_drawn_each_by_itself():
    assert conditions.stopped("chosen", "60").value == 4.0 / 8.0
    assert conditions.stopped("chosen", "60").replicates.max() == 6.0 / 4.0


def test_errors_of_four_joints():
    assert conditions.four_joints("chosen").value == 0.3


def test_ratios_are_of_the_same_draw():
    found = conditions.practised("memory", "circle")
    assert found.value == 1.0 and found.replicates.max() == 3.0
