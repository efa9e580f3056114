"""Every widget of every built page answers a drag, a key and a touch, with no kernel behind it.

What is moved and what it moves are in view together, on a laptop and on a phone.
"""

from __future__ import annotations

import chromium
import pytest
from book_pages import WITH_WIDGETS
from reactions import Handle, handles

pytestmark = pytest.mark.browser
TOUCH = not chromium.FIREFOX
FOCUSED = ":focus" if chromium.FIREFOX else ":focus-visible"  # which keys alone bring in Firefox


HEADER = 64
"""What the page keeps for itself at the top, px."""

RESULTS = (".scalars", ".chart > svg", "canvas, svg", ".sentence")
"""What shows a widget's result: its numbers, otherwise its charts, what it draws, what it says."""

LEAST = 20
"""Height from which something is a result and not the sample of a legend, px."""


def spans(root) -> list[float]:
    """For each handle the height, px, that it takes together with the nearest result."""
    for kind in RESULTS:
        boxes = [el.bounding_box() for el in root.locator(kind).locator("visible=true").all()]
        results = [box for box in boxes if box["height"] >= LEAST]
        if results:
            break
    found = []
    for handle in handles(root):
        box = handle.handle.bounding_box()
        top, bottom = box["y"], box["y"] + box["height"]
        ends = [(r["y"], r["y"] + r["height"]) for r in results]
        found.append(min(max(bottom, b) - min(top, a) for a, b in ends))
    return found


def in_view_together(page) -> bool:
    """Whether each widget has a handle that fits the screen together with a result."""
    screen = page.viewport_size["height"] - HEADER
    return all(0 < max(spans(root)) <= screen for root in page.locator(".ddlib-widget").all())


def all_handles(opened) -> list[Handle]:
    """One or two of each widget, at least one."""
    roots = opened.page.locator(".ddlib-widget")
    found = [handles(roots.nth(k)) for k in range(roots.count())]
    assert found and all(found)
    return [handle for one in found for handle in one]


@pytest.mark.parametrize("name", WITH_WIDGETS)
def test_mouse_keys_and_a_finger_change_the_picture(name, site, visit):
    """For a reader who wants no motion: before a hand moves something, nothing moves."""
    opened = visit(f"{site}/{name}.html", reduced_motion="reduce", has_touch=TOUCH)
    found = all_handles(opened)
    assert in_view_together(opened.page)
    stands_still(opened, found)
    for handle in found:
        before = handle.picture()
        handle.drag()
        dragged = handle.picture()
        assert dragged != before
        handle.press()
        assert handle.picture() != dragged
        assert handle.handle.evaluate("(el, seen) => el.matches(seen)", FOCUSED)
    opened.page.set_viewport_size({"width": 390, "height": 844})
    chromium.settle(opened.page)
    assert in_view_together(opened.page)
    for handle in found if TOUCH else ():
        before = handle.picture()
        handle.tap()
        assert handle.picture() != before
    assert not opened.problems


def stands_still(opened, found):
    still = [handle.picture() for handle in found]
    opened.page.evaluate("() => new Promise((f) => setTimeout(f, 300))")
    assert [handle.picture() for handle in found] == still
