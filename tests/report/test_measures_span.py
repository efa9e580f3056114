"""What is measured of the directions of the windows, on planted studies and by other means."""

import numpy as np
import pytest

from ddlib.setups import WINDOWS
from workshop.report import results
from workshop.report.measures import backpropagation, networks, windows

MEMBERS = 5


def planted(case, width):
    """A cell whose values say where it stands."""
    at = 10 * case + WINDOWS.index(width) + 1.0

    def course(factor):
        return {
            "learnt": [factor * at] * MEMBERS,
            "rmss": [factor * (5.0 - case)] * MEMBERS,
            "halves": [[10.0, 10.0, 40.0, None, 90.0 * factor, 1000.0]] * MEMBERS,
        }

    return {
        "correlation": {
            "own": [[0.1, 0.2, 0.9 + 0.001 * at]] * MEMBERS,
            "of another": [0.5] * MEMBERS,
            "of shuffled torques": [0.25] * MEMBERS,
            "of the spectrum": [0.01 * at] * MEMBERS,
        },
        "factor": [[1.1, 1.2, at]] * MEMBERS,
        "measured": course(1.0),
        "predicted": course(3.0 if width == 21 and not case else 1.0),
    }


@pytest.fixture
def plant(monkeypatch):
    """``plant(name, content)`` puts a result in place of the committed one."""
    planted = {}
    monkeypatch.setattr(results, "read", lambda name: planted[name])
    return planted.__setitem__


@pytest.fixture
def study(plant):
    cells = [planted(case, width) for case in range(3) for width in WINDOWS]
    plant("span", {"epochs": [0, 1, 1000, 20_000], "cells": cells})


def test_correlations_are_those_of_the_last_epoch(study):
    assert backpropagation.changes_predicted(21).value == pytest.approx(0.902)
    text = backpropagation.changes_predicted(41, 2).text
    assert text.startswith("0.92 ") and "0.50 of another, 0.25 of shuffled torques" in text
    found = backpropagation.changes_predicted(21, 2, "of the spectrum")
    assert found.value == pytest.approx(0.22) and "another" not in found.text


def test_factor_of_an_epoch(study):
    assert backpropagation.prediction_factor(1000).value == pytest.approx(1.2)
    assert backpropagation.prediction_factor(20_000, 41, 1).value == pytest.approx(13.0)


def test_the_window_that_is_furthest_off_counts(study):
    off = backpropagation.prediction_off("learnt")
    assert off.value == pytest.approx(3.0)
    assert off.text == "1.0 predicted, 1.0 measured at 11, 6.0 predicted, 2.0 measured at 21, " \
        "3.0 predicted, 3.0 measured at 41"  # fmt: skip
    assert backpropagation.prediction_off("learnt", 1).value == pytest.approx(1.0)


def test_halving_takes_the_geometric_mean(study):
    found = backpropagation.halved([2, 3], [5])
    assert found.value == pytest.approx(90 / 20)
    assert "predicted 14" in found.text  # 270 / 20
    assert backpropagation.halved([1], [6], 41, 1).value == pytest.approx(100.0)


def test_centring_is_the_least_gain(study):
    found = backpropagation.centred()
    assert found.value == pytest.approx(5 / 4)
    assert found.text.endswith("predicted 1.2, 3.8, 1.2")


def test_memory_by_three_ways(plant):
    def cell(error, largest):
        return {"training": [error] * MEMBERS, "largest weight": [largest] * MEMBERS}

    row = {"width": 41, **cell(0.98, 2.0), "solver": cell(0.3, 5e4), "solver, decay": cell(0.9, 7)}
    plant("memory", {"rows": [{"width": 11}, row]})
    assert networks.memory(41).value == pytest.approx(0.98)
    assert networks.memory(41, "solver").value == pytest.approx(0.3)
    assert "largest weight 7" in networks.memory(41, "solver, decay").text


def test_nothing_leaves_the_span_of_twelve_windows():
    found = windows.outside_the_span(epochs=20)
    assert found.value < 1e-12 and "12 windows of 22 inputs" in found.text


def test_directions_of_the_recording_are_pure():
    """The ninth direction is a jerk; far down the list there is nothing that has a name."""
    assert 0.8 < windows.direction_purity().value < 1
    assert windows.direction_purity(20).value < 0.2


def test_where_the_start_is_left():
    """In the directions beyond the predicted ones, and not in all of them."""
    found = windows.noise_left(41)
    assert 0.9 < found.value < 1 and " of 83 directions" in found.text
    assert np.ptp(found.replicates) > 0


def test_the_solver_moves_what_descent_leaves():
    found = windows.learnt_by_solver(41)
    assert found.value > 0.9 and "by descent 0." in found.text
