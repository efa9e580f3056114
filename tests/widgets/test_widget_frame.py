"""What all widgets have: reset, the state in the address, link and code, values of charts."""

from __future__ import annotations

import pytest
from widget_pages import NEXT_FRAME, Finger, copied, page_of, phone, shown_values
from widget_samples import make, make_kinds

from ddlib.widgets import Presets

CODE = "result = {gain} * {decay} + {other}"
PRESETS = Presets({"fast": {"gain": 50, "decay": 2.0}, "slow": {"decay": 0.25}})


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


# In a page without a kernel

browser_test = pytest.mark.browser
STANDS = "([key, want]) => new URLSearchParams(location.search).get(key) === want"


def press(page, name):
    page.get_by_role("button", name=name).first.click()
    page.evaluate(NEXT_FRAME)


@browser_test
def test_address_restores_and_reset_forgets(page_with, widget):
    page = page_with(widget, query="?other=1#anchor")
    url = page.url.partition("?")[0]
    page.get_by_label("Gain").press("End")
    page.locator(".pad").press("Home")
    page.wait_for_function(STANDS, arg=["curve-widget", "gain:100,decay:0"])
    assert page.url == f"{url}?other=1&curve-widget=gain:100,decay:0#anchor"
    assert copied(page) == "result = 100 * 0 + {other}"
    assert page.locator(".said").inner_text() == "Code copied"
    link = f"{url}?other=1&curve-widget=gain:100,decay:0#curve-widget-widget"
    assert copied(page, "Link") == link
    page.reload()
    page.wait_for_selector(".pad")
    page.evaluate(NEXT_FRAME)
    assert shown_values(page) == [100, 0, 0]
    press(page, "Reset")
    assert shown_values(page) == [10, 0.5, 0]
    page.wait_for_function(STANDS, arg=["curve-widget", None])
    assert page.url == f"{url}?other=1#anchor"
    for state in ("gain:1e9", "gain:x,nothing:3", "gain:%25E0%25A4", ":,,", "gain"):  # unfit
        page.goto(f"{url}?curve-widget={state},decay:2")
        page.wait_for_selector(".pad")
        assert shown_values(page)[0] == 10 and not page.locator(".ddlib-widget-error").count()


@browser_test
def test_two_widgets_of_a_kind_have_entries_of_their_own(page_with, widget):
    def late(entry):
        """The first widget's script takes a while to load."""
        script = entry["state"]["_esm"]
        entry["state"]["_esm"] = f"await new Promise((r) => setTimeout(r, 500));{script}"

    query = "?curve-widget=gain:100&curve-widget2=decay:2"
    page = page_with(widget, framed(), query=query, change=late)
    assert shown_values(page) == [100, 0.5, 0, 10, 2, 0]
    page.locator("#curve-widget2-widget").get_by_label("Gain").press("Home")
    page.wait_for_function(STANDS, arg=["curve-widget2", "gain:1,decay:2"])


@browser_test
def test_hover_and_keys_read_values(page_with, widget):
    page = page_with(widget)
    chart, box = page.locator(".chart > svg").first, page.locator(".readout").first
    assert not box.is_visible()
    path = chart.locator(".frame").get_attribute("d")
    left, right = float(path[1:].split(" ")[0]), float(path.split("H")[1])
    chart.hover(position={"x": left + 0.252 * (right - left), "y": 60})
    exact = widget.at_grid()["position"][10]
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
    page.keyboard.press("Escape")
    assert not box.is_visible()


@browser_test
@pytest.mark.chromium
def test_fingers_drag_scroll_and_tap(tmp_path, browser, widget):
    url = page_of(tmp_path / "page.html", widget, extra="<div style='height:900px'></div>")
    with phone(browser, url) as page:
        finger = Finger(page)
        handle = page.locator(".handle circle").first.bounding_box()
        finger.swipe(handle["x"] + handle["width"] / 2, handle["y"] + handle["height"] / 2, 0, -60)
        assert page.evaluate("scrollY") == 0 and shown_values(page)[2] > 0.3

        box, values = page.locator(".pad .frame").bounding_box(), shown_values(page)
        x, y = box["x"] + 0.6 * box["width"], box["y"] + 0.9 * box["height"]
        finger.swipe(x, y, 90, 0)  # sideways
        dragged = shown_values(page)
        assert dragged != values and dragged[2] == pytest.approx(-0.8, abs=0.05)
        page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + box["height"] / 4)
        page.evaluate(NEXT_FRAME)
        assert shown_values(page)[1:] == [pytest.approx(1, abs=0.02), pytest.approx(0.5, abs=0.02)]

        values = shown_values(page)
        for where, x in ((".pad .frame", 0.65), (".pad .frame", 0.95), (".chart > svg", 0.6)):
            page.locator(where).first.scroll_into_view_if_needed()
            before, box = page.evaluate("scrollY"), page.locator(where).first.bounding_box()
            at = box["x"] + x * box["width"], box["y"] + 0.9 * box["height"]
            finger.swipe(*at, 0, -120)  # beside the handle
            page.wait_for_function("(at) => scrollY > at + 50", arg=before)
            page.evaluate("scrollTo(0, 0)")
        assert shown_values(page) == values
