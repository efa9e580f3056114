"""Pages with widgets are quick: soon usable, and a running arm leaves the browser idle.

What is measured is the time that the page's main thread computes. It does not grow when other
programs want the processor, as time on the clock does (`benchmarks/redraw.py`).
"""

from __future__ import annotations

import sys
from contextlib import contextmanager

import chromium
import numpy as np
import pytest
from book_pages import PAGES, ROOT, WITH_WIDGETS
from reactions import PICTURE

sys.path.insert(0, str(ROOT / "benchmarks"))
import redraw

pytestmark = pytest.mark.browser

TICKS = """(n) => new Promise((done) => {
  const tick = () => (n-- > 0 ? requestAnimationFrame(tick) : done());
  requestAnimationFrame(tick);
})"""


@contextmanager
def busy(browser):
    """A new page and a function: seconds that its main thread has computed so far."""
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def seconds() -> float:
        found = session.send("Performance.getMetrics")["metrics"]
        return next(m["value"] for m in found if m["name"] == "TaskDuration")

    yield page, seconds
    page.context.close()


def test_computing_is_seen_and_waiting_is_not(browser):
    with busy(browser) as (page, seconds):
        before = seconds()
        page.evaluate("() => new Promise((done) => setTimeout(done, 300))")
        waited = seconds()
        page.evaluate("() => { for (let k = 0; k < 1e9; k++) Math.sqrt(k); }")
        assert 5 * (waited - before) < seconds() - waited


def heaviest(built) -> str:
    return max(WITH_WIDGETS, key=lambda name: (built / f"{name}.html").stat().st_size)


@pytest.mark.parametrize("which", [lambda built: PAGES[0], heaviest], ids=["first", "heaviest"])
def test_widgets_are_soon_usable(which, built, site, browser):
    with busy(browser) as (page, seconds):
        page.goto(f"{site}/{which(built)}.html")
        assert 0 < page.evaluate(redraw.MOUNTED)
        assert 0.01 < seconds() < redraw.USABLE


def test_frames_of_the_running_arm_are_short(site, browser):
    """Groups of five frames of the first page, while the arm moves on it."""
    with busy(browser) as (page, seconds):
        page.goto(f"{site}/{PAGES[0]}.html")
        chromium.settle(page)
        widget = page.locator(".ddlib-widget").first
        widget.scroll_into_view_if_needed()
        run = widget.locator("button[data-runs]")
        run.click()
        if run.inner_text() == "Play":  # it was greeting the reader
            run.click()
        pictures, times = [], []
        for _ in range(40):
            pictures.append(widget.evaluate(PICTURE))
            before = seconds()
            page.evaluate(TICKS, 5)
            times.append((seconds() - before) / 5 * 1000)
        assert len(set(pictures)) > 30
        assert 0 < np.percentile(times, 95) < redraw.MOST
