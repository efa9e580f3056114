"""What a reader meets of code: pieces that teach, and plumbing by a switch."""

from __future__ import annotations

import chromium
import pytest
from book_pages import code_cells, source

browser_test = pytest.mark.browser


FULL = "book/evidence/dynamics"  # has open code and much that is hidden
BUTTON = ".btn-all-code"
# Pieces of code that a reader sees, with what the page calls a piece of code to read.
SEEN = """
() => [...document.querySelectorAll("article .cell_input pre")].filter((el) => el.checkVisibility())
  .map((el) => [el.textContent, Boolean(el.closest(".tag_to-read"))])
"""


@browser_test
@pytest.mark.parametrize("kind", ["file", "http"])
def test_one_switch_shows_all_code(kind, built, site, visit):
    """By keyboard; it is remembered, and what was looked at stays where it is."""
    name = FULL
    address = (built / f"{name}.html").as_uri() if kind == "file" else f"{site}/{name}.html"
    opened = visit(address)
    page = opened.page
    button = page.locator(BUTTON)
    assert button.count() == 1 and button.get_attribute("aria-pressed") == "false"
    taught = page.evaluate(SEEN)
    assert taught and all(to_read for _, to_read in taught)
    button.focus()
    page.keyboard.press("Enter")
    assert button.get_attribute("aria-pressed") == "true"
    seen = {code.strip() for code, _ in page.evaluate(SEEN)}
    folded = page.locator("article details:not([open]) .cell_input pre").all_text_contents()
    every = {code.strip() for code in code_cells(source(name))}
    assert seen >= every - {code.strip() for code in folded}
    assert len(seen) > 2 * len(taught)
    page.reload()
    assert button.get_attribute("aria-pressed") == "true"
    chromium.settle(page)
    button.focus()
    page.evaluate("scrollTo({top: 3000, behavior: 'instant'})")
    look = """() => {
      window.looked ??= [...document.querySelectorAll("article :is(p, h2, li)")]
        .find((el) => !el.closest("details") && el.getBoundingClientRect().top > 80);
      return window.looked.getBoundingClientRect().top;
    }"""
    before = page.evaluate(look)
    page.keyboard.press("Space")
    assert button.get_attribute("aria-pressed") == "false"
    assert abs(page.evaluate(look) - before) < 2
    assert page.evaluate(SEEN) == taught
    assert not opened.problems


@browser_test
def test_without_storage_the_switch_works_and_a_phone_has_room_for_it(site, browser):
    context = browser.new_context(viewport={"width": 390, "height": 800})
    page = context.new_page()
    faults = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.add_init_script(
        "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"
    )
    page.goto(f"{site}/{FULL}.html")
    box = page.locator(BUTTON).bounding_box()
    assert box["x"] > 0 and box["x"] + box["width"] < 390 and box["height"] >= 24
    page.locator(BUTTON).click()
    assert page.locator(BUTTON).get_attribute("aria-pressed") == "true"
    assert not [fault for fault in faults if "reading.js" in fault]
    context.close()


@browser_test
@pytest.mark.chromium
def test_paper_has_the_code_that_teaches(site, visit):
    """With its folds open, as `print.js` leaves them: no plumbing, unless all code is shown."""
    page = visit(f"{site}/{FULL}.html").page
    page.emulate_media(media="print")
    page.evaluate("document.querySelectorAll('article details').forEach((el) => (el.open = true))")
    plumbing = page.locator("article :is(.tag_plumbing, .tag_bookkeeping) .cell_input")
    seen = "(found) => found.filter((el) => el.checkVisibility()).length"
    assert plumbing.count() > 0 and plumbing.evaluate_all(seen) == 0
    assert page.locator("article .tag_to-read .cell_input").evaluate_all(seen) > 0
    page.evaluate("document.documentElement.dataset.code = 'all'")
    assert plumbing.evaluate_all(seen) == plumbing.count()
