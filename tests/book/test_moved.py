"""Old addresses of whole pages lead to their successors, with what follows "#"."""

import sys

import pytest
from book_pages import PAGES, ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_moved


def test_successors_are_pages_and_the_old_ones_are_not():
    assert set(dd_moved.MOVED.values()) <= set(PAGES)
    assert not set(dd_moved.MOVED) & set(PAGES)


@pytest.mark.browser
def test_a_page_that_moved_leads_on(tmp_path, browser):
    (tmp_path / "old.html").write_text(dd_moved.page("book/new"), encoding="utf-8")
    (tmp_path / "new.html").write_text("<h2 id='there'>Here</h2>", encoding="utf-8")
    page = browser.new_page()
    page.goto((tmp_path / "old.html").as_uri() + "#there")
    page.wait_for_url("**/new.html#there")
    page.close()
