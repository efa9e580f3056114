"""The widget of directions that are learnt: its curves are those of the study."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, assert_exact_table, settings

from ddlib.analysis import basis
from ddlib.learning import Directions
from ddlib.setups import WINDOWS
from workshop.chapters.why_smooth_filters import _SpectrumExplorer
from workshop.report import results

STUDY = results.read("span")


def directions(width):
    """Of position, velocity, acceleration and jerk of one joint, and the bias; the rest is zero."""
    axes = np.zeros((2 * width + 1, 2 * width + 1))
    for k, taps in enumerate(basis(width)):
        axes[k, (k % 2) * width : (k % 2 + 1) * width] = taps
    axes[4, -1] = 1.0
    return Directions(np.ones(len(axes)), axes, np.zeros((1, len(axes))), 2)


@pytest.fixture(scope="module")
def widget():
    return _SpectrumExplorer(STUDY, [directions(cell["width"]) for cell in STUDY["cells"]])


def test_curves_are_those_of_the_study(widget):
    assert_exact_table(widget)
    for values in settings(widget, 40, seed=1):
        cell = STUDY["cells"][3 * values["case"] + WINDOWS.index(values["width"])]
        assert cell["width"] == values["width"]
        k, row = values["direction"] - 1, STUDY["epochs"].index(values["epoch"])
        shown = widget.at_grid(**values)
        zeros = (max(WINDOWS) - values["width"]) // 2
        for joint, f in zip(("shoulder", "elbow"), directions(values["width"]).filters[k]):
            np.testing.assert_allclose(shown[f"{joint} shape"], np.pad(f, zeros), atol=2e-4)
        for who in ("measured", "predicted"):
            change = np.array(cell[who]["change over start"])[1:, k]
            powers = np.log10(np.maximum(change, 1e-8))  # less is not shown
            np.testing.assert_allclose(shown[f"change {who}"], powers, atol=2e-3)
            assert shown[f"now {who}"][0] == pytest.approx(powers[row - 1], abs=2e-3)
            error = np.array(cell[who]["error"])[1:, k]
            np.testing.assert_allclose(shown[f"error {who}"], error, atol=2e-4)
        assert shown["variance"][0] == pytest.approx(np.log10(cell["variance"][k]), abs=2e-3)


def test_shares_name_the_derivative(widget):
    for direction, share in enumerate((1, 2, 3, 4, 0), 1):  # in SHARES the bias comes first
        expected = np.eye(6)[share]
        shown = widget.at_grid(direction=direction, width=11)["shares"]
        np.testing.assert_allclose(shown, expected, atol=1e-3)


@pytest.mark.browser
def test_the_film_stands_still_between_presses_with_reduced_motion(page_with, widget):
    page = page_with(widget, calm=True)
    epochs, epoch = STUDY["epochs"][1:], "document.querySelector('.ddlib-widget').view.get('epoch')"
    for place in (0, 10):  # it stood at the end
        page.get_by_role("button", name="Play").click()
        page.wait_for_timeout(500)
        page.evaluate(NEXT_FRAME)
        assert page.evaluate(epoch) == epochs[place]
