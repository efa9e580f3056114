"""A row of weights that folds into its parts, in Python and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import NEXT_FRAME, settings

from ddlib.simulation import LOG_STEP
from workshop.chapters.widgets.fold import FilterFold

S = np.arange(-7, 8)
ROUGH = 10 * np.random.default_rng(2).normal(size=15)
ROWS = {"line": 3.0 * S, "parabola": S**2 - (S**2).mean(), "rough": ROUGH}
PARTS = ("constant", "even", "odd")


@pytest.fixture(scope="module")
def widget():
    return FilterFold(ROWS, LOG_STEP)


def test_truths_of_any_state(widget):
    for values in settings(widget, 40, seed=1):
        f, x = ROWS[values["row"]], 0.01 * S
        shown = widget.curves_at(**values)
        size = np.abs(f).max()
        part = values["fold"] / 100
        np.testing.assert_allclose(
            shown["left"] + sum(shown[name] for name in PARTS), f, atol=1e-3 * size
        )
        odd = (f - f[::-1]) / 2
        np.testing.assert_allclose(shown["odd"], part * odd, atol=1e-3 * size)
        np.testing.assert_allclose(shown["constant"], part * f.mean(), atol=1e-3 * size)
        window = values["angle"] + values["speed"] * x + values["acceleration"] * x**2 / 2
        np.testing.assert_allclose(shown["window"], window, atol=0.01)
        answers = shown["answers"]
        reach = shown["most answer"][0]
        assert answers[3] == pytest.approx(f @ np.deg2rad(window), abs=2e-3 * reach)
        assert answers[2] == pytest.approx(odd @ np.deg2rad(window), abs=2e-3 * reach)
        assert answers[:3].sum() == pytest.approx(answers[3], abs=4e-3 * reach)


def test_a_line_hears_speed_alone_and_a_parabola_acceleration_alone(widget):
    still = {"angle": 0, "speed": 0, "acceleration": 0}
    for row, motion, part in (("line", "speed", 2), ("parabola", "acceleration", 1)):
        for moved, most in (("angle", 5), ("speed", 50), ("acceleration", 1000)):
            shown = widget.curves_at(**{**still, "row": row, moved: most})
            assert np.abs(shown["answers"]).max() <= shown["most answer"][0]
            heard = np.abs(shown["answers"]) > 0.01 * shown["most answer"]
            assert heard.tolist() == [moved == motion and k in (part, 3) for k in range(4)]


@pytest.mark.browser
def test_a_motion_by_its_button(page_with, widget):
    page = page_with(widget, calm=True)
    page.get_by_role("button", name="Speed up").click()
    page.evaluate(NEXT_FRAME)
    slider = page.get_by_role("slider", name="Acceleration")
    assert slider.get_attribute("aria-valuetext").replace(",", "").startswith("1000")
