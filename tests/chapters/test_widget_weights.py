"""The reader of weights: a row as squares and as a curve, with its start and without."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.stats import linregress
from widget_pages import NEXT_FRAME, settings

from ddlib.learning import Weights
from ddlib.simulation import LOG_STEP
from workshop.chapters.widgets.weights import WeightReader, _diagram

WIDTH, HIDDEN = 11, 5
SIDE = 18.0
"""Of the largest square above the curve, px."""
T = np.arange(WIDTH) - WIDTH // 2


@pytest.fixture(scope="module")
def pair():
    """A start, and the same with a smooth curve in each row."""
    start, other = Weights.random(2, WIDTH, HIDDEN, initial=0.05)
    smooth = 0.01 * (T**2 - np.mean(T**2))
    trained = Weights(
        start.hidden_weights + smooth * np.arange(1, HIDDEN + 1)[:, None, None],
        *(getattr(other, name) for name in ("hidden_bias", "output_weights")),
        start.direct_weights + 5 * smooth,
        other.output_bias,
    )
    return start, trained


@pytest.fixture(scope="module")
def widget(pair):
    return WeightReader(*pair, LOG_STEP)


def row_of(weights: Weights, unit: str, joint: str) -> np.ndarray:
    kind, name = unit.split()
    part = weights.hidden_weights if kind == "hidden" else weights.direct_weights
    number = int(name) if kind == "hidden" else ("shoulder", "elbow").index(kind)
    return part[number, ("shoulder", "elbow").index(joint)]


def test_curves_are_the_weights_less_the_start(widget, pair):
    for values in settings(widget, 40, seed=1):
        start, trained = (row_of(w, values["unit"], values["joint"]) for w in pair)
        shown, wanted = widget.at_grid(**values), trained - start * values["subtract"]
        step = 1e-3 * np.abs(trained).max() + 1e-4
        np.testing.assert_allclose(shown["weights"], wanted, atol=step)
        assert shown["largest"][0] == pytest.approx(np.abs(wanted).max(), abs=step)
        low, high = (shown[end][0] for end in ("lowest", "highest"))
        for both in (trained, trained - start):
            assert low - step <= both.min() and both.max() <= high + step
        full = pair[1].largest if values["common"] else np.abs(trained).max()
        assert shown["full"][0] == pytest.approx(full, rel=1e-3)
        cells = shown["weights of all units"]
        row, places = np.clip(wanted / full, -1, 1), range(len(cells) - WIDTH + 1)
        off = min(np.abs(cells[k : k + WIDTH] - row).max() for k in places)
        assert off < 2e-3  # it is in the diagram, too


def test_diagram_holds_every_weight_once(pair):
    weights = pair[1]
    fields = ("hidden_weights", "hidden_bias", "direct_weights", "output_bias")
    counted = [getattr(weights, name).ravel() for name in fields]
    # the weights between hidden and output units are drawn at both ends
    expected = np.sort(np.concatenate([*counted, np.repeat(weights.output_weights, 2)]))
    np.testing.assert_array_equal(np.sort(_diagram(weights)), expected)


# In a page without a kernel


def squares(page) -> np.ndarray:
    """Centre and signed area of the squares above the curve, from left to right."""
    marks = []
    for sign, name in ((1, "positive"), (-1, "negative")):
        path = page.locator(f"svg.strip .{name}").get_attribute("d") or ""
        for x, a in re.findall(r"M([\d.-]+) [\d.-]+h([\d.]+)", path):
            marks.append((float(x) + float(a) / 2, sign * float(a) ** 2))
    return np.array(sorted(marks))


def assert_shown(page, pair, unit, joint, subtract):
    page.evaluate(NEXT_FRAME)
    start, trained = (row_of(w, unit, joint) for w in pair)
    wanted = trained - start * subtract
    drawn = squares(page)
    areas = SIDE**2 * np.clip(wanted / np.abs(trained).max(), -1, 1)
    shown = np.sqrt(np.abs(areas)) > 0.2  # smaller ones are left out
    np.testing.assert_allclose(drawn[:, 1], areas[shown], atol=0.02 * SIDE**2)
    dots = page.locator(".chart > svg > path.dots").get_attribute("d")
    heights = [float(y) for y in re.findall(r"M[\d.-]+ ([\d.-]+)h0", dots)]
    assert len(heights) == WIDTH
    assert linregress(wanted, heights).rvalue == pytest.approx(-1, abs=1e-4)
    places = [float(x) for x in re.findall(r"M([\d.-]+) [\d.-]+h0", dots)]
    np.testing.assert_allclose(drawn[:, 0], np.array(places)[shown], atol=0.5)  # square over stem


CHOSEN = "document.querySelector('.hinton [aria-selected=true]').getAttribute('aria-label')"
FILLS = "(all) => all.map((path) => getComputedStyle(path).fill)"


@pytest.mark.browser
def test_press_a_row_and_subtract_the_start(page_with, widget, pair):
    page = page_with(widget, calm=True)
    assert_shown(page, pair, "shoulder torque", "shoulder", False)
    page.locator('[role=gridcell][aria-label="hidden 3, elbow\'s window"]').click(force=True)
    assert_shown(page, pair, "hidden 2", "elbow", False)
    switch = page.get_by_label("Subtract the start")
    switch.press(" ")
    assert_shown(page, pair, "hidden 2", "elbow", True)
    for key in ("ArrowUp", "ArrowUp", "ArrowLeft"):  # by hidden 3, shoulder, to hidden 1, elbow
        page.locator("svg.hinton").first.press(key)
    assert_shown(page, pair, "hidden 0", "elbow", True)
    assert page.evaluate(CHOSEN) == "hidden 1, elbow's window"
    fills = page.locator("svg.hinton path").evaluate_all(FILLS)
    assert fills == ["rgb(255, 255, 255)", "rgb(0, 0, 0)"]  # the paper's: white is positive
