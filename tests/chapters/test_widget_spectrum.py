"""The widget of directions that are learnt: its curves are those of the study."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import assert_exact_table, settings

from ddlib.analysis import basis
from ddlib.learning import Directions
from workshop.chapters.why_smooth_filters import _FLOOR, _WHO, _SpectrumExplorer

EPOCHS = (0, 1, 10, 100, 1000, 20_000)
WIDTHS, SHOWN = (7, 11), 5
READINGS = [("quiet", (0.0, 1.0)), ("quiet", (-1.0, 1.0))]


def directions(width):
    """Five directions: of position, velocity, acceleration and jerk of one joint, and the bias."""
    axes = np.zeros((2 * width + 1, 2 * width + 1))
    for k, taps in enumerate(basis(width)):
        axes[k, (k % 2) * width : (k % 2 + 1) * width] = taps
    axes[4, -1] = 1.0
    values = 10.0 ** -np.arange(len(axes))
    return Directions(values, axes, np.zeros((1, len(axes))), 2)


def cell(setup, scaling, width, rng):
    def course():
        grows = np.cumprod(rng.uniform(1, 30, (len(EPOCHS), SHOWN)), 0) * 1e-6
        return {
            "change over start": (grows * (np.arange(len(EPOCHS)) > 0)[:, None]).tolist(),
            "error": rng.uniform(0, 1, (len(EPOCHS), SHOWN)).tolist(),
        }

    return {
        "setup": setup,
        "scaling": list(scaling),
        "width": width,
        "variance": (10.0 ** (-2 * np.arange(2 * width + 1))).tolist(),
        **{who: course() for who in _WHO},
    }


@pytest.fixture(scope="module")
def study():
    rng = np.random.default_rng(4)
    cells = [cell(*reading, width, rng) for reading in READINGS for width in WIDTHS]
    return {"epochs": list(EPOCHS), "cells": cells}


@pytest.fixture(scope="module")
def along(study):
    return [directions(cell["width"]) for cell in study["cells"]]


@pytest.fixture(scope="module")
def widget(study, along):
    return _SpectrumExplorer(study, along)


def test_curves_are_those_of_the_study(widget, study, along):
    assert_exact_table(widget)
    for values in settings(widget, 40, seed=1):
        at = 2 * values["case"] + WIDTHS.index(values["width"])
        cell, k = study["cells"][at], values["direction"] - 1
        row, shown = EPOCHS.index(values["epoch"]), widget.at_grid(**values)
        zeros = (max(WIDTHS) - values["width"]) // 2
        for joint, f in zip(("shoulder", "elbow"), along[at].filters[k]):
            np.testing.assert_allclose(shown[f"{joint} shape"], np.pad(f, zeros), atol=2e-4)
        for who in _WHO:
            change = np.array(cell[who]["change over start"])[1:, k]
            logs = np.maximum(np.log10(change), _FLOOR)
            np.testing.assert_allclose(shown[f"change {who}"], logs, atol=2e-3)
            assert shown[f"now {who}"][0] == pytest.approx(logs[row - 1], abs=2e-3)
            error = np.array(cell[who]["error"])[1:, k]
            np.testing.assert_allclose(shown[f"error {who}"], error, atol=2e-4)
        assert shown["variance"][0] == pytest.approx(-2 * k, abs=2e-3)


def test_shares_name_the_derivative(widget):
    for direction, share in enumerate((1, 2, 3, 4, 0), 1):  # in SHARES the bias comes first
        expected = np.eye(6)[share]
        shown = widget.at_grid(direction=direction, width=11)["shares"]
        np.testing.assert_allclose(shown, expected, atol=1e-3)
