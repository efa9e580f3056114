"""Every widget of every built page answers a drag, a key and a touch, with no kernel behind it."""

from __future__ import annotations

import chromium
import pytest
from book_pages import WITH_WIDGETS
from reactions import Handle, handles

pytestmark = pytest.mark.browser
FOCUSED = ":focus" if chromium.FIREFOX else ":focus-visible"  # which keys alone bring in Firefox


def all_handles(opened) -> list[Handle]:
    """One or two of each widget, at least one."""
    roots = opened.page.locator(".ddlib-widget")
    found = [handles(roots.nth(k)) for k in range(roots.count())]
    assert found and all(found)
    return [handle for one in found for handle in one]


@pytest.mark.parametrize("name", WITH_WIDGETS)
def test_mouse_and_keys_change_the_picture(name, site, visit):
    """For a reader who wants no motion: before a hand moves something, nothing moves."""
    opened = visit(f"{site}/{name}.html", reduced_motion="reduce")
    found = all_handles(opened)
    stands_still(opened, found)
    for handle in found:
        before = handle.picture()
        handle.drag()
        dragged = handle.picture()
        assert dragged != before
        handle.press()
        assert handle.picture() != dragged
        assert handle.handle.evaluate("(el, seen) => el.matches(seen)", FOCUSED)
    assert not opened.problems


def stands_still(opened, found):
    still = [handle.picture() for handle in found]
    opened.page.evaluate("() => new Promise((f) => setTimeout(f, 300))")
    assert [handle.picture() for handle in found] == still


@pytest.mark.chromium
@pytest.mark.parametrize("name", WITH_WIDGETS)
def test_touch_changes_the_picture(name, site, visit):
    opened = visit(f"{site}/{name}.html", width=400, has_touch=True, is_mobile=True)
    for handle in all_handles(opened):
        before = handle.picture()
        handle.tap()
        assert handle.picture() != before
    assert not opened.problems
