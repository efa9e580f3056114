"""What all widgets have: reset, the state in the address, link and code, values of charts."""

from __future__ import annotations

import pytest
from axe import violations
from traitlets import TraitError
from widget_pages import LIVE, NEXT_FRAME, page_of, shown_values
from widget_samples import make, make_kinds

from ddlib import widgets
from ddlib.widgets import CurveWidget, Panel, Parameter
from ddlib.widgets.parts import common

CODE = "result = {gain} * {decay} + {other}"
PRESETS = {"fast": {"gain": 50, "decay": 2.0}, "slow": {"decay": 0.25}}


def framed(**changes):
    return make(**{"code": CODE, "presets": PRESETS, "title": "Swing", **changes})


@pytest.fixture(scope="module")
def widget():
    return framed()


# In Python


def test_code_has_the_values_as_they_stand():
    widget = framed()
    assert widget.code == "result = 10 * 0.5 + {other}"
    widget.gain = 1 / 3 + 1
    assert widget.code.startswith("result = 1.33333 * 0.5")
    kinds = make_kinds(code="{shape}, {twice}, {bits}")
    assert kinds.code == '"sine", False, 5'


def test_code_of_a_class_without_arguments_makes_it(monkeypatch):
    class Line(CurveWidget):
        def __init__(self, **options):
            gain = Parameter("gain", "Gain", 0, 10, 1, grid=2)
            panel = Panel("y", "y", "x", [0, 1, 2])
            super().__init__(lambda gain: {"y": [0, gain, 1]}, [gain], [panel], alt="a", **options)

    monkeypatch.setattr(widgets, "Line", Line, raising=False)
    Line.__module__ = "ddlib.widgets.line"
    line = Line()
    line.gain = 2.5
    assert line.spec["key"] == "line"
    found = {}
    exec(line.code.replace("import Line", "import CurveWidget"), {"Line": Line}, found)
    assert found["widget"].values == {"gain": 2.5}
    assert make().code == "" and common.key_of(widgets.TrajectoryPicker) == "trajectory-picker"


def test_presets_are_checked():
    with pytest.raises(ValueError, match=r"preset 'fast' must set some of gain, .*, got gian"):
        framed(presets={"fast": {"gian": 3}})
    with pytest.raises((ValueError, TraitError), match=r"gain must lie in \[1, 100\], got 200"):
        framed(presets={"fast": {"gain": 200}})
    with pytest.raises(ValueError, match="x_texts of 'y' must be 3 like x, got 1"):
        Panel("y", "y", "x", [0, 1, 2], x_texts=["a"])


# In a page without a kernel

browser_test = pytest.mark.browser
STANDS = "([key, want]) => new URLSearchParams(location.search).get(key) === want"


def press(page, name):
    page.get_by_role("button", name=name).first.click()
    page.evaluate(NEXT_FRAME)


@browser_test
def test_address_restores_and_reset_forgets(tmp_path, visit, widget):
    url = page_of(tmp_path / "page.html", widget)
    opened = visit(url + "?other=1#anchor")
    page = opened.page
    page.get_by_label("Gain").press("End")
    page.locator(".pad").press("Home")
    page.wait_for_function(STANDS, arg=["curve-widget", "gain:100,decay:0"])
    assert page.url == f"{url}?other=1&curve-widget=gain:100,decay:0#anchor"
    page.reload()
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page) == [100, 0, 0]
    press(page, "Reset")
    assert shown_values(page) == [10, 0.5, 0]
    page.wait_for_function(STANDS, arg=["curve-widget", None])
    assert page.url == f"{url}?other=1#anchor" and not opened.problems


@browser_test
@pytest.mark.parametrize(
    "state", ["gain:1e9", "gain:x,nothing:3", "gain:%25E0%25A4", ":,,", "gain"]
)
def test_address_that_does_not_fit_is_no_harm(state, tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget) + f"?curve-widget={state},decay:2")
    assert shown_values(opened.page)[0] == 10
    assert not opened.problems and not opened.page.locator(".ddlib-widget-error").count()


def late(entry):
    """The widget's script takes a while to load."""
    entry["state"]["_esm"] = (
        f"await new Promise((r) => setTimeout(r, 500));{entry['state']['_esm']}"
    )


@browser_test
@pytest.mark.parametrize("change", [None, late])
def test_two_widgets_of_a_kind_have_entries_of_their_own(change, tmp_path, visit, widget):
    url = page_of(tmp_path / "page.html", widget, framed(), change=change)
    page = visit(f"{url}?curve-widget=gain:100&curve-widget2=decay:2").page
    assert shown_values(page) == [100, 0.5, 0, 10, 2, 0]
    page.locator("#curve-widget2-widget").get_by_label("Gain").press("Home")
    page.wait_for_function(STANDS, arg=["curve-widget2", "gain:1,decay:2"])


REFUSE = "<script>navigator.clipboard.writeText = () => Promise.reject(new Error('no'))</script>"
KEEP = "<script>navigator.clipboard.writeText = async (text) => { window.copied = text; }</script>"


@browser_test
def test_link_and_code_are_copied(tmp_path, visit, widget):
    url = page_of(tmp_path / "page.html", widget, extra=KEEP)
    page = visit(url + "#x").page
    page.get_by_label("Decay").first.press("End")
    press(page, "Code")
    assert page.evaluate("copied") == "result = 10 * 2 + {other}"
    assert page.locator(".said").inner_text() == "Code copied"
    press(page, "Link")
    link = page.evaluate("copied")
    assert link == f"{url}?curve-widget=decay:2#curve-widget-widget"
    page.goto(link)
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page) == [10, 2, 0] and page.locator("#curve-widget-widget").count() == 1


@browser_test
def test_a_field_where_the_clipboard_is_refused(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget, extra=REFUSE)).page
    field = page.locator(".copied")
    assert not field.is_visible()
    press(page, "Code")
    assert field.is_visible() and field.evaluate("(el) => el === document.activeElement")
    assert page.evaluate("getSelection().toString()") == "result = 10 * 0.5 + {other}"
    assert "Ctrl+C" in page.locator(".said").inner_text() and not violations(page)
    press(page, "Reset")
    assert not field.is_visible()


@browser_test
def test_with_a_kernel_the_address_is_left_alone(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget, extra=LIVE) + "?curve-widget=gain:50").page
    assert shown_values(page)[0] == 10 and not page.get_by_role("button", name="Link").count()
    page.get_by_label("Gain").press("End")
    page.wait_for_timeout(500)
    assert page.url.endswith("?curve-widget=gain:50")
    press(page, "Reset")
    assert shown_values(page)[0] == 10


@browser_test
def test_presets_set_and_show_what_stands(tmp_path, visit, widget):
    page = visit(page_of(tmp_path / "page.html", widget)).page
    fast, slow = (page.get_by_role("button", name=name) for name in PRESETS)
    fast.click()
    page.evaluate(NEXT_FRAME)
    assert shown_values(page) == [50, 2, 0]
    pressed = [b.get_attribute("aria-pressed") for b in (fast, slow)]
    assert pressed == ["true", "false"]
    page.get_by_label("Gain").press("End")
    page.evaluate(NEXT_FRAME)
    assert fast.get_attribute("aria-pressed") == "false"


@browser_test
def test_hover_and_keys_read_values(tmp_path, visit, widget):
    opened = visit(page_of(tmp_path / "page.html", widget))
    page = opened.page
    chart, box = page.locator(".chart > svg").first, page.locator(".readout").first
    assert not box.is_visible()
    path = chart.locator(".frame").get_attribute("d")
    left, right = float(path[1:].split(" ")[0]), float(path.split("H")[1])
    chart.hover(position={"x": left + 0.252 * (right - left), "y": 60})
    exact = widget.interpolate()["position"][10]
    read = box.locator("b").inner_text().replace("−", "-")
    assert box.locator(".where").inner_text() == "time 0.25\u00a0s"
    assert read.endswith("\u00a0m") and float(read[:-2]) == pytest.approx(exact, abs=0.01)
    page.mouse.move(1, 1)
    assert not box.is_visible()
    chart.focus()
    page.keyboard.press("Home")
    page.wait_for_function("document.querySelector('.spoken').textContent.startsWith('time 0.00')")
    page.keyboard.press("Shift+ArrowRight")
    assert box.locator(".where").inner_text() == "time 0.25\u00a0s"
    assert box.is_visible() and "Arrow keys" in chart.get_attribute("aria-label")
    before = box.locator("b").inner_text()
    page.get_by_label("Gain").evaluate(
        "(el) => { el.value = el.max; el.dispatchEvent(new Event('input')); }"
    )
    page.evaluate(NEXT_FRAME)
    assert box.locator("b").inner_text() != before  # follows the curve
    page.keyboard.press("Escape")
    assert not box.is_visible() and not violations(page) and not opened.problems


class Finger:
    """A touch, sent to the browser as a screen would."""

    def __init__(self, page):
        self.client = page.context.new_cdp_session(page)

    def send(self, kind, *points):
        where = [{"x": x, "y": y} for x, y in points]
        self.client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": where})

    def swipe(self, x, y, dx, dy):
        self.send("touchStart", (x, y))
        for part in range(1, 11):
            self.send("touchMove", (x + dx * part / 10, y + dy * part / 10))
        self.send("touchEnd")


@pytest.fixture
def phone(tmp_path, browser, widget):
    """A page on a phone, with room to scroll."""
    context = browser.new_context(
        viewport={"width": 390, "height": 700}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    page.goto(page_of(tmp_path / "page.html", widget, extra="<div style='height:900px'></div>"))
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    yield page
    context.close()


@browser_test
def test_a_finger_on_the_handle_drags_it(phone):
    handle = phone.locator(".handle circle").first.bounding_box()
    x, y = handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2
    Finger(phone).swipe(x, y, 0, -60)
    phone.evaluate(NEXT_FRAME)
    assert phone.evaluate("scrollY") == 0 and shown_values(phone)[2] > 0.3


@browser_test
@pytest.mark.parametrize(
    ("where", "x", "y"),
    [(".pad .frame", 0.65, 0.9), (".pad .frame", 0.95, 0.9), (".chart > svg", 0.6, 0.6)],
)
def test_a_vertical_swipe_beside_the_handle_scrolls(phone, where, x, y):
    values, finger = shown_values(phone), Finger(phone)
    phone.locator(where).first.scroll_into_view_if_needed()
    before, box = phone.evaluate("scrollY"), phone.locator(where).first.bounding_box()
    finger.swipe(box["x"] + x * box["width"], box["y"] + y * box["height"], 0, -120)
    phone.wait_for_function("(at) => scrollY > at + 50", arg=before)
    assert shown_values(phone) == values


@browser_test
def test_a_finger_beside_the_handle_drags_sideways_and_taps(phone):
    box, values = phone.locator(".pad .frame").bounding_box(), shown_values(phone)
    x, y = box["x"] + 0.6 * box["width"], box["y"] + 0.9 * box["height"]
    Finger(phone).swipe(x, y, 90, 0)
    phone.evaluate(NEXT_FRAME)
    dragged = shown_values(phone)
    assert dragged != values and dragged[2] == pytest.approx(-0.8, abs=0.05)
    phone.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 4)
    phone.evaluate(NEXT_FRAME)
    assert shown_values(phone)[1:] == [pytest.approx(1, abs=0.02), pytest.approx(0.5, abs=0.02)]
