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
    for opener in (".search-button-field", ".dropdown-download-buttons > button"):
        opened = visit(f"{site}/{PAGES[1]}.html")
        opened.page.locator(opener).click()
        chromium.settle(opened.page)
        assert not violations(opened.page), opener


def test_faults_are_found(tmp_path, visit):
    faults = (
        '<p style="color:#666">pale</p><img src="favicon.svg"><h1>one</h1><h4>four</h4>'
        "<button></button><details><summary>more</summary><input></details>"
    )
    page = tmp_path / "page.html"
    page.write_text(f'<!doctype html><html lang="en"><title>Faulty</title><main>{faults}</main>')
    found = " ".join(violations(visit(page.as_uri()).page))
    for rule in ("image-alt", "button-name", "label", "color-contrast-enhanced", "heading-order"):
        assert f"{rule} (" in found
