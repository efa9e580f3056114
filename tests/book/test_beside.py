"""Handle and result of every widget are in view together, on a laptop and on a phone."""

from __future__ import annotations

import chromium
import pytest
from book_pages import WITH_WIDGETS
from reactions import handles

pytestmark = pytest.mark.browser

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


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
@pytest.mark.parametrize("name", WITH_WIDGETS)
def test_handle_and_result_are_in_view_together(name, width, height, site, browser):
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.goto(f"{site}/{name}.html")
    chromium.settle(page)
    for root in page.locator(".ddlib-widget").all():
        measured = spans(root)
        assert measured and max(measured) <= height - HEADER, measured
    context.close()
