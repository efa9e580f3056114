"""What axe-core finds: all pages are asked in test_pages.py, here narrow ones and what opens."""

from __future__ import annotations

import chromium
import pytest
from axe import violations, violations_in
from book_pages import PAGES

pytestmark = pytest.mark.browser


def test_narrow_page_breaks_no_rule(site, visit):
    opened = visit(f"{site}/{PAGES[1]}.html", "light", 400)
    assert not violations_in(opened.page, "light", "dark")


def test_what_opens_breaks_no_rule(site, visit):
    for opener in (
        ".search-button",
        ".dropdown-download-buttons > button",
        ".primary-toggle",
        ".secondary-toggle",
    ):
        opened = visit(f"{site}/{PAGES[1]}.html")
        opened.page.locator(opener).click()
        chromium.settle(opened.page)
        assert not violations(opened.page), opener


ROWS = "".join(f"<tr><td>row {k}</td></tr>" for k in range(9))
PALE = {
    "a word": ".pale { color: #999 }",
    "a row in the dark": "@media (prefers-color-scheme: dark) { tr:nth-child(7) { color: #333 } }",
}
CSS = """
  body { background: #fff }
  @media (prefers-color-scheme: dark) { body { background: #000; color: #fff } }
"""


@pytest.mark.chromium
@pytest.mark.parametrize("rule", PALE.values(), ids=PALE)
def test_of_many_rows_the_one_that_is_pale_is_found(tmp_path, visit, rule):
    page = tmp_path / "page.html"
    words = "".join(f"<p{' class=pale' * (k == 5)}>words</p>" for k in range(9))
    head = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>x</title><style>{CSS}'
    body = f"</style><main><h1>One</h1>{words}<table>{ROWS}</table></main>"
    found = []
    for style in ("", rule):
        page.write_text(head + style + body)
        faults = violations_in(visit(page.as_uri()).page, "light", "dark")
        found.append(any("color-contrast" in fault for fault in faults))
    assert found == [False, True]
