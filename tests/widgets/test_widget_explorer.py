"""The filter explorer and its Hinton diagram, in Python and in a page without a kernel."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.signal import freqz
from widget_pages import NEXT_FRAME, assert_exact_table, settings

from ddlib.analysis import CLASSES, classify, savitzky_golay
from ddlib.learning import Weights
from ddlib.setups import WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.widgets.explorer import _FLOOR, FilterExplorer
from ddlib.widgets.hinton import _diagram, unit_names
from workshop.report import results

CELLS = "weights of all units"
MEMBERS = (1, 6)
REACH = max(WINDOWS) // 2
START = {"width": 21, "seed": 1, "unit": "shoulder torque", "joint": "shoulder"}


@pytest.fixture(scope="module")
def models():
    return {w: results.networks(w) for w in WINDOWS}


@pytest.fixture(scope="module")
def explorer(models):
    return FilterExplorer(models, MEMBERS)


def weights_of(models, width, seed, unit, joint) -> np.ndarray:
    weights = models[width].weights
    j = ("shoulder", "elbow").index(joint)
    kind, name = unit.split()
    if kind == "hidden":
        return weights.hidden_weights[seed, int(name), j]
    return weights.direct_weights[seed, ("shoulder", "elbow").index(kind), j]


def gain_of(f, hertz) -> np.ndarray:
    return np.abs(freqz(f, worN=hertz, fs=1 / LOG_STEP)[1])


def test_truths_of_every_filter(explorer, models):
    assert_exact_table(explorer)
    for values in settings(explorer, 60, seed=2):
        f = weights_of(models, **values)
        shown = explorer.at_grid(**values)
        step = 2e-5 * np.abs(f).max() + 2e-3  # of the table
        inside = slice(REACH - len(f) // 2, REACH + len(f) // 2 + 1)
        padded = np.zeros(2 * REACH + 1)
        padded[inside] = f
        np.testing.assert_allclose(shown["weights"], padded, atol=step)
        parts = [shown[name] for name in ("constant", "even", "odd")]
        np.testing.assert_allclose(sum(parts), padded, atol=3 * step)
        np.testing.assert_allclose(parts[1], parts[1][::-1], atol=2 * step)
        np.testing.assert_allclose(parts[2], -parts[2][::-1], atol=2 * step)
        assert parts[1][inside].mean() == pytest.approx(0, abs=step)

        x = np.linspace(-1, 1, len(f))
        rest = f - np.polynomial.Polynomial.fit(x, f, 3)(x)
        assert shown["shares"].sum() == pytest.approx(1, abs=1e-4)
        assert shown["shares"][4] == pytest.approx((rest @ rest) / (f @ f), abs=1e-4)
        assert shown["shares"][0] == pytest.approx(len(f) * f.mean() ** 2 / (f @ f), abs=1e-4)
        assert CLASSES[round(shown["class"][0])] == classify(f)
        assert shown["last"][0] == pytest.approx(10 * (len(f) // 2) + 5, abs=0.01)


def test_gains_are_scipys(explorer, models):
    (hertz,) = (np.array(p["x"]) for p in explorer.spec["panels"] if p["y_label"] == "Gain")
    assert np.diff(hertz).max() < 0.2 / LOG_STEP / 41  # a zero is no jag
    for values in settings(explorer, 40, seed=3):
        f = weights_of(models, **values)
        shown = explorer.at_grid(**values)
        lowest = _FLOOR * max(gain_of(f, hertz).max(), gain_of(f - f.mean(), hertz).max())
        for name, g in (("gain", f), ("gain, varying", f - f.mean())):
            expected = np.log10(np.maximum(gain_of(g, hertz), lowest))
            np.testing.assert_allclose(shown[name], expected, atol=1e-3)
            assert shown["lowest gain"][0] <= expected.min() + 1e-3
            assert shown["highest gain"][0] >= expected.max() - 1e-3
        order = 1 + np.argmax(shown["shares"][1:4])
        textbook = savitzky_golay(len(f), order, LOG_STEP, degree=order)
        scale = np.sqrt(shown["shares"][order] * (f @ f) / (textbook @ textbook))
        if shown["shares"][order] > 0.01:
            expected = np.log10(scale * (2 * np.pi * hertz) ** order)
            got, shown_ = shown["gain, ideal"], expected > np.log10(lowest)
            np.testing.assert_allclose(got[shown_], expected[shown_], atol=0.01)


def test_diagram_holds_every_weight_once(models):
    weights = models[11].weights[6]
    cells = _diagram(weights, 8).reshape(-1)
    fields = ("hidden_weights", "hidden_bias", "direct_weights", "output_bias")
    counted = np.concatenate([getattr(weights, name).ravel() for name in fields])
    # the weights between hidden and output units are drawn at both ends
    both = np.repeat(weights.output_weights.ravel(), 2)
    expected = np.sort(np.concatenate([counted, both]))
    np.testing.assert_array_equal(np.sort(cells[cells != 0]), expected)
    hidden = cells[2 * (1 + 10 + 34) :].reshape(10, 1 + 2 + 34)
    np.testing.assert_array_equal(hidden[:, 1:3], weights.output_weights.T)
    np.testing.assert_array_equal(hidden[3, 3 + 3 : 3 + 14], weights.hidden_weights[3, 0])


# In a page without a kernel

SHOWN = unit_names(Weights.random(1, 11)[0])  # hidden units are counted from 1
CHOSEN = "document.querySelector('.hinton [aria-selected=true]').getAttribute('aria-label')"


def assert_shown(page, explorer, models, **values):
    page.evaluate(NEXT_FRAME)
    f = weights_of(models, **values)
    assert page.evaluate(CHOSEN) == f"{SHOWN[values['unit']]}, {values['joint']}'s window"
    assert page.locator(".verdict").inner_text().endswith(f": {classify(f)}")
    cells = explorer.at_grid(**values)[CELLS]
    paths = [page.locator(f"svg.hinton .{sign}").get_attribute("d") for sign in SIGNS]
    sides = [[float(a) for a in re.findall(r"h([\d.]+)v", path)] for path in paths]
    areas = np.array([np.square(side).sum() for side in sides])
    weights = np.array([cells[cells > 0].sum(), -cells[cells < 0].sum()])
    np.testing.assert_allclose(areas / areas.sum(), weights / weights.sum(), atol=0.02)
    assert sum(map(len, sides)) >= (np.abs(cells) > 0.02 * np.abs(cells).max()).sum()


SIGNS = ("positive", "negative")
FILLS = "[...document.querySelectorAll('svg.hinton path')].map((p) => getComputedStyle(p).fill)"


@pytest.mark.browser
def test_pointer_keys_menus_and_names_choose(page_with, explorer, models):
    page, values = page_with(explorer), dict(START)

    def shows(**changes):
        values.update(changes)
        assert_shown(page, explorer, models, **values)

    def place(unit, joint):
        label = f"{SHOWN[unit]}, {joint}'s window"
        box = page.locator(f'[role=gridcell][aria-label="{label}"]').bounding_box()
        return box["x"] + 0.3 * box["width"], box["y"] + 0.6 * box["height"]

    shows()
    # the paper's: white is positive
    assert page.evaluate(FILLS) == ["rgb(255, 255, 255)", "rgb(0, 0, 0)"]
    page.mouse.click(*place("hidden 2", "elbow"))
    shows(unit="hidden 2", joint="elbow")
    page.mouse.move(*place("hidden 2", "shoulder"))
    page.mouse.down()
    page.mouse.move(*place("hidden 7", "elbow"), steps=6)
    page.mouse.up()
    shows(unit="hidden 7", joint="elbow")

    page.locator("svg.hinton").focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowLeft"):  # by hidden 7, shoulder, to hidden 5, elbow
        page.keyboard.press(key)
    shows(unit="hidden 4")
    active = page.locator("svg.hinton").get_attribute("aria-activedescendant")
    assert page.locator(f"#{active}").get_attribute("aria-selected") == "true"

    page.get_by_label("Window size").select_option(label="41 samples")
    page.get_by_label("Network").select_option(label="seed 6")
    page.get_by_label("Unit", exact=True).select_option(label="hidden 10")
    page.get_by_label("Window of").select_option(label="shoulder")
    shows(width=41, seed=6, unit="hidden 9", joint="shoulder")
    for name, named in explorer.spec["presets"]["options"]:
        page.get_by_role("button", name=name, exact=True).click()
        shows(**named)
    ticks = page.locator(".chart > svg").nth(3).locator("text.x").all_text_contents()
    assert ticks[:-1] == ["0.5", "1", "2", "5", "10", "20"]
