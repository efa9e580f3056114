"""The widgets' script in a browser: against Python, and in a page without a kernel."""

from __future__ import annotations

import numpy as np
import pytest
from widget_pages import (
    NEXT_FRAME,
    PATHS,
    READ,
    assert_curves,
    functions,
    settings,
    shown_values,
)
from widget_samples import make, make_kinds, parameters, wave

from ddlib.widgets import Pad

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def waves():
    return make_kinds()


SCRIPT = """([spec, baked, settings, points]) => {
  const bytes = Uint8Array.from(baked);
  const table = readTable(spec, new DataView(bytes.buffer));
  const places = (values) => spec.parameters.map((p, k) => placeOf(p, values[k]));
  const ranged = spec.parameters.map((p, k) => [p, k]).filter(([p]) => !p.options);
  return {
    curves: settings.map((values) => curvesAt(spec, table, places(values)))
      .map((curves) => Object.values(curves).flatMap((curve) => [...curve])),
    near: settings.map((values) => spec.parameters.map((p, k) => valueNear(p, values[k], true))),
    inside: points.map((p) => insidePolygon(spec.pad?.region ?? [], ...p)),
    back: settings.map((v) => ranged.map(([p, k]) => fromFraction(p, toFraction(p, v[k])))),
    ticks: [[-4, 4, 3], [0, 1, 2], [-0.35, 7.2, 4]].map((t) => ticks(...t)),
    around: [[-3.4, 8.1], [0, 0], [5, 5], [0.2, 30, true]].map((a) => around(...a)),
  };
}"""


@pytest.fixture(scope="module")
def call(browser):
    with functions(browser, "numbers.js", "parameters.js", "table.js") as call:
        yield call


def computed(call, widget, chosen, points=()):
    settings = [list(values.values()) for values in chosen]
    return call(SCRIPT, [widget.spec, list(widget.baked), settings, list(points)])


def assert_same(out, widget, chosen):
    for values, got in zip(chosen, out["curves"], strict=True):
        expected = np.concatenate(list(widget.at_grid(**values).values()))
        np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12)
    points = [p.points() for p in widget._parameters.values()]
    for values, got in zip(chosen, out["near"], strict=True):
        places = [widget._parameters[name].nearest(x) for name, x in values.items()]
        expected = [each[place] for each, place in zip(points, places)]
        assert all(x == y or x == pytest.approx(y, rel=1e-11) for x, y in zip(got, expected))


def test_script_snaps_and_reads_as_python_does(call):
    region = [(0, 0), (1, -1), (2, 1)]
    widget = make(pad=Pad("decay", "phase", (), region))
    corners = ([1, 0, -1], [100, 2, 1], [10, 1, 0])
    ends = [{p.name: x for p, x in zip(parameters(), corner)} for corner in corners]
    chosen = [*settings(widget, 30), *ends]
    points = [(1, 0), (0.1, 0.5), (2, 1), (1.9, -1)]
    out = computed(call, widget, chosen, points)
    assert_same(out, widget, chosen)
    np.testing.assert_allclose(out["back"], [list(v.values()) for v in chosen], atol=1e-9)
    assert out["inside"] == [True, False, True, False]
    assert out["ticks"][0] == [-4, -2, 0, 2, 4] and out["ticks"][1] == [0, 0.5, 1]
    assert out["around"] == [[-5, 10], [0, 0.25], [4, 6], [0.1, 100]]


def test_script_reads_choices(call, waves):
    chosen = list(settings(waves, 40))
    assert_same(computed(call, waves, chosen), waves, chosen)


# In a page without a kernel


def test_every_control_of_a_choice(page_with, waves):
    page = page_with(waves)
    drawn = [page.evaluate(PATHS)]

    def changed():
        page.evaluate(NEXT_FRAME)
        drawn.append(page.evaluate(PATHS))
        return drawn[-1] != drawn[-2]

    page.get_by_label("Shape").select_option(label="a cosine")
    assert changed()
    page.get_by_role("switch", name="Twice as much").press("Space")
    assert changed() and page.locator(".switch output").inner_text() == "on"
    encoder = page.get_by_label("Encoder")
    encoder.press("ArrowLeft")
    assert changed() and encoder.get_attribute("aria-valuetext") == "3 bits"
    page.get_by_label("Gain").press("End")
    assert changed()
    exact = wave(5, "cosine", True, 3)
    line = page.evaluate(READ, 0)
    np.testing.assert_allclose(line[1], exact["y"], atol=0.06)
    np.testing.assert_allclose(line[0], 1, atol=0.06)  # the fixed curve is drawn first
    stems = page.evaluate(READ, 1)
    np.testing.assert_allclose(stems[1], exact["taps"], atol=0.2)


def test_a_slider_without_a_kernel_steps_over_the_grid(page_with):
    widget = make()
    page = page_with(widget, query="?curve-widget=decay:0.93,gain:4")
    gain, decay = (page.get_by_role("slider", name=name) for name in ("Gain", "Decay"))
    assert shown_values(page) == [10, 0.9, 0]  # the nearest points
    assert (gain.get_attribute("max"), decay.get_attribute("max")) == ("2", "20")
    for key, place in (("ArrowRight", 10), ("End", 20), ("ArrowLeft", 19), ("Home", 0)):
        decay.press(key)
        values = {"gain": 10, "decay": place / 10, "phase": 0}
        assert shown_values(page)[1] == pytest.approx(values["decay"], abs=0.01)
        assert_curves(page, widget.at_grid(**values), 1e-12)
    page.locator(".pad").press("ArrowRight")
    page.locator(".pad").press("Shift+ArrowUp")
    assert_curves(page, widget.at_grid(gain=10, decay=0.1, phase=1), 1e-12)
