"""Redraw after an input, in every widget of the built pages: ``python benchmarks/redraw.py``.

A move sets a slider to another value, or drags the pointer over a drawing, through the events
that a browser sends. What counts is the time in which the page's main thread is busy because
of the move:

- the event's dispatch, in which the widget takes the new value and asks for a frame, and
- that frame, from its first callback to the first task after it: interpolation, new paths,
  numbers and labels, then style, layout and paint.

Of a widget that runs while it is pulled, what counts is its frames.

The wait for the frame between the two, up to 16.7 ms at 60 Hz, is not the widget's doing and is
left out. If 95 of 100 moves take no longer than 16 ms, the picture follows the hand.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "support"))
import chromium  # noqa: E402
from book_pages import WITH_WIDGETS  # noqa: E402

MOVES = 200
WARM_UP = 10
MOST = 16.0
"""Milliseconds that 95 of 100 moves may take."""

OPENINGS = 5
USABLE = 2.0
"""Seconds from asking for a page to when its widgets answer; half of the openings may take more."""

MOUNTED = """async () => {
  while (!document.documentElement.dataset.widgets) await new Promise(requestAnimationFrame);
  return performance.now() / 1000; // since the page was asked for
}"""

# Milliseconds for each move of one widget's sliders in turn, or of a drawing.
MEASURE = """
async ([widget, kind, moves]) => {
  const after = new MessageChannel();
  const busy = (act) => new Promise((done) => {
    let frame, dispatch;
    requestAnimationFrame(() => (frame = performance.now())); // before the widget's own
    after.port1.onmessage = () => done(dispatch + performance.now() - frame);
    const start = performance.now();
    act();
    dispatch = performance.now() - start;
    requestAnimationFrame(() => after.port2.postMessage(null)); // after the widget's own
  });
  const far = (k) => 0.5 - 0.5 * Math.cos(k * 0.7); // over the whole way, by unequal steps

  const sliders = [...widget.querySelectorAll('input[type="range"]')]
    .filter((el) => el.checkVisibility());
  const slide = (k) => {
    const el = sliders[k % sliders.length];
    const [low, high] = [Number(el.min), Number(el.max)];
    const value = Math.round(low + far(k) * (high - low));
    el.value = value === Number(el.value) ? (value < high ? value + 1 : value - 1) : value;
    el.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const drawing = widget.querySelector('svg[tabindex="0"]:not(.chart > svg)');
  const box = drawing?.getBoundingClientRect();
  const drag = (k) => {
    drawing.setPointerCapture = () => {}; // of a pointer that is not there
    drawing.hasPointerCapture = () => true;
    drawing.dispatchEvent(new PointerEvent("pointermove", {
      clientX: box.left + (0.1 + 0.8 * far(k)) * box.width,
      clientY: box.top + (0.1 + 0.8 * far(1.6 * k)) * box.height,
      buttons: 1, pointerType: "mouse", bubbles: true,
    }));
  };
  const times = [];
  if (kind === "frames") {
    return new Promise((done) => {
      let frame;
      const tick = () => {
        if (times.length === moves) return done(times);
        requestAnimationFrame(tick); // before the widget asks for the same frame
        frame = performance.now();
        after.port2.postMessage(null);
      };
      after.port1.onmessage = () => times.push(performance.now() - frame);
      requestAnimationFrame(tick);
      const run = widget.querySelector("[data-runs]"); // it runs as long as a key pulls it
      run.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowUp", bubbles: true }));
    });
  }
  const act = kind === "sliders" ? slide : drag;
  for (let k = 0; k < moves; k++) times.push(await busy(() => act(k)));
  return times;
}
"""
KINDS = {
    "sliders": 'input[type="range"]',
    "drawing": 'svg[tabindex="0"]:not(.chart > svg)',
    "frames": "[data-runs]",
}


def rows() -> list[dict]:
    """One row for each widget and way of moving it.

    Returns
    -------
    list of dict
        ``what``, ``median, ms`` and ``p95, ms``, which is to keep below `MOST`; of a widget with
        nothing to move in these ways ``what`` and why it is ``not measured``.

    Raises
    ------
    RuntimeError
        If the book is not built.
    FileNotFoundError
        If there is no Chromium.
    """
    measured = []
    for browser, name, url in _pages():
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        page.goto(url)
        chromium.settle(page)
        widgets = page.locator(".ddlib-widget")
        for number in range(widgets.count()):
            measured += of_widget(widgets.nth(number), f"{name} {number + 1}")
        page.close()
    return measured


def openings() -> list[dict]:
    """How soon a page can be used, one row for each page with widgets.

    Returns
    -------
    list of dict
        ``what`` and ``median, s``, of `OPENINGS` openings, each with nothing kept from before.

    Raises
    ------
    RuntimeError
        If the book is not built.
    FileNotFoundError
        If there is no Chromium.
    """
    measured = []
    for browser, name, url in _pages():
        times = [opening(browser, url) for _ in range(OPENINGS)]
        measured.append({"what": f"opening, {name}", "median, s": float(np.median(times))})
    return measured


def _pages():
    """A browser, the name and the address of each page with widgets."""
    if not (chromium.HTML / ".built-from").is_file():
        raise RuntimeError("there is no clean build of the book: run `make book` first")
    with chromium.serve(chromium.HTML) as site, chromium.launch() as browser:
        for name in WITH_WIDGETS:
            yield browser, Path(name).name, f"{site}/{name}.html"


def opening(browser, url: str) -> float:
    """Seconds from asking a new browser context for a page to when its widgets answer."""
    page = browser.new_page(viewport={"width": 1280, "height": 800})
    page.goto(url)
    seconds = page.evaluate(MOUNTED)
    page.context.close()
    return seconds


def of_widget(widget, name: str, moves: int = MOVES) -> list[dict]:
    """The rows of one mounted widget, a Playwright locator of an open page."""
    widget.scroll_into_view_if_needed()
    measured: list[dict] = []
    for kind, selector in KINDS.items():
        if not widget.locator(selector).locator("visible=true").count():
            continue
        element = widget.element_handle()
        times = widget.page.evaluate(MEASURE, [element, kind, WARM_UP + moves])[WARM_UP:]
        measured.append(
            {
                "what": f"redraw, {name}, {kind}",
                "median, ms": float(np.median(times)),
                "p95, ms": float(np.percentile(times, 95)),
            }
        )
    return measured or [{"what": f"redraw, {name}", "not measured": "no slider or drawing"}]


if __name__ == "__main__":
    for row in rows():
        print(*(f"{x:8.1f}" if isinstance(x, float) else x for x in row.values()), flush=True)
