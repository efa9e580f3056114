"""A headless Chromium (with BROWSER=firefox a Firefox) and a loopback server for the pages."""

from __future__ import annotations

import os
import shutil
import threading
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import firefox

FIREFOX = os.environ.get("BROWSER") == "firefox"
ROOT = Path(__file__).resolve().parents[2]
HTML = ROOT / "_build" / "html"

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
HOW_TO_GET_ONE = "no browser found: apt-get install chromium, or set CHROMIUM=/path/to/chromium"
POLICY = "default-src 'self' 'unsafe-inline' blob:"  # nothing but the site itself
FLAGS = [
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def find() -> str | None:
    """Path of a Chromium: $CHROMIUM, else the first known name on the PATH."""
    if FIREFOX:
        return firefox.find()
    wanted = os.environ.get("CHROMIUM")
    if wanted:
        return shutil.which(wanted)
    return next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def launch():
    """A running browser; raises FileNotFoundError when there is none."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright, launched(playwright) as browser:
        yield browser


@contextmanager
def launched(playwright):
    """As `launch`, by a Playwright that runs already: of two, the second would not start."""
    if FIREFOX:
        with firefox.launched(playwright) as browser:
            yield browser
        return
    path = find()
    if path is None:
        raise FileNotFoundError(HOW_TO_GET_ONE)
    flags = [*FLAGS, "--no-sandbox"] if os.geteuid() == 0 else FLAGS
    browser = playwright.chromium.launch(executable_path=path, args=flags)
    try:
        yield browser
    finally:
        browser.close()


class QuietHandler(SimpleHTTPRequestHandler):
    def end_headers(self):
        self.send_header("Content-Security-Policy", POLICY)
        super().end_headers()

    def log_message(self, *args):
        pass


@contextmanager
def serve(folder: Path):
    """Serve a folder under the strict `POLICY` on a free loopback port; yields its address."""
    handler = partial(QuietHandler, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


def coloured(page, scheme: str) -> None:
    """Show the page in the colours of "light" or "dark"."""
    if FIREFOX:  # as the theme's own switch does
        switch = "(s) => Object.assign(document.documentElement.dataset, {theme: s, mode: s})"
        page.evaluate(switch, scheme)
    else:
        page.emulate_media(color_scheme=scheme)


SETTLED = """
async () => {
  const until = async (what, done) => {
    const end = performance.now() + 30_000;
    while (!done()) {
      if (performance.now() > end) throw new Error(`still waiting for ${what}`);
      await new Promise(requestAnimationFrame);
    }
  };
  await window.MathJax?.startup?.promise;
  const widgets = 'script[type="application/vnd.jupyter.widget-view+json"]';
  await until("widgets", () =>
    !document.querySelector(widgets) || document.documentElement.dataset.widgets);
  await document.fonts.ready;
  for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame);  // what starts, starts
  const unseen = ({ target }) => !target?.checkVisibility({ opacityProperty: true });
  const waits = (animation) => navigator.userAgent.includes("Firefox") &&
    animation.currentTime === 0 && unseen(animation.effect);
  const running = (animation) => animation.playState === "running" && !waits(animation);
  await until("animations", () => !document.getAnimations().some(running));
}
"""


def settle(page):
    """Wait until MathJax has typeset, the widgets are mounted and nothing moves any more.

    By `evaluate` alone: Playwright's own `wait_for_function` needs ``eval``, which `POLICY`
    forbids.
    """
    page.evaluate(SETTLED)
