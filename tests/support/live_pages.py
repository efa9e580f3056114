"""Pages with the cells of lessons and nothing else, live: what tests of *Run this page* open."""

from __future__ import annotations

import gzip
import html
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import chromium
import pytest
from book_pages import ROOT
from live import cells, packages, pages
from open_cells import lesson

KEPT = ROOT / "_build" / "pyodide" / packages.VERSION
"""Where packages are kept that once were taken."""
MIRROR = os.environ.get("DDLIB_LIVE_MIRROR", "")
POLICY = f"{chromium.POLICY}; script-src 'self' 'unsafe-inline' blob: 'wasm-unsafe-eval'"
IDLE = "html[data-live=idle]"
HEADER = '<header class="article-header-buttons"></header>'


def plain(page: str) -> str:
    """A page with the cells of a notebook, and nothing else."""
    cell = '<div class="cell x"><div class="cell_input"><pre>{}</pre></div></div>'
    code = (html.escape(c.source) for c in lesson(page).cells if c.cell_type == "code")
    main = f"<main><section><h1>x</h1>{''.join(map(cell.format, code))}</section></main>"
    head = '<html lang="en"><meta charset="utf-8"><title>x</title>'
    return f"<!doctype html>{head}<body>{HEADER}{main}</body></html>"


def runs_through(tab, site: str, page: str) -> None:
    """Open a page and run it: each cell that a reader can run ends, and none complains."""
    tab.goto(f"{site}/{page}.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.locator(IDLE).wait_for(timeout=900_000)
    assert all(times := tab.locator(".live-time").all_inner_texts())
    assert len(times) == len(cells.live_cells(lesson(page)))
    assert not tab.locator(".live-error, .live-warning, .live-note:has(a)").all_inner_texts()


def code(field) -> str:
    """What stands in the editor of a cell."""
    return field.evaluate("(el) => el.closest('.live-code').value")


BESIDE = """window.Worker = class {
  async postMessage(message) {
    const all = message.start ? [{ ready: true }] : await window.runs(message);
    for (const data of all) this.onmessage({ data });
  }
  terminate() {}
}"""
"""In place of the worker with Pyodide: what the test makes of a message."""


def set_up(
    tab, given: Iterable[dict], name: str = "a.html", editor: str = "", style: str = ""
) -> str:
    """Have a tab find a page with such cells and nothing else; its address.

    Without an editor's script, cells are plain fields.
    """
    given = [{"kind": "open", "needs": "", "names": {}, **cell} for cell in given]
    about = {"cells": given, "ahead": [], "pages": ["a.html", "b.html"], "megabytes": [1, 1]}
    data = json.dumps(about | {"data": [], "notebook": ""}).replace("</", "<\\/")
    field = '<div class="cell" data-live="{id}"><div class="cell_input"></div></div>'
    field = f"<section>{field}</section>"
    shown = "".join(field.format(**cell) for cell in given)
    scripts = "".join(f'<script src="{script}.js"></script>' for script in ("follow", "live"))
    head = f'<!doctype html><html lang="en"><title>x</title><style>{style}</style>'
    text = f"{head}{HEADER}<main><h1>x</h1>{shown}</main>"
    text += f'<script type="application/json" id="live-page">{data}</script>{scripts}'

    def answer(route):
        path = packages.PAGE / route.request.url.rpartition("/")[2]
        if path.name == "editor.js":
            status = 200 if editor else 404
            return route.fulfill(status=status, body=editor, content_type="text/javascript")
        if path.suffix == ".js":
            code = path.read_text("utf-8")
            return route.fulfill(body=code, content_type="text/javascript; charset=utf-8")
        return route.fulfill(body=text, content_type="text/html; charset=utf-8")

    tab.unroute("http://page.test/**")
    tab.route("http://page.test/**", answer)
    return f"http://page.test/book/{name}"


@contextmanager
def served(folder: Path, names: Iterable[str]) -> Iterator[str]:
    """The address of such pages on a server of their own; skips where no mirror is named."""
    if not MIRROR:
        pytest.skip("set DDLIB_LIVE_MIRROR to a folder or an address with Pyodide's packages")
    (folder / "html" / "book").mkdir(parents=True)
    for name in names:
        (folder / "html" / f"{name}.html").write_text(plain(name), encoding="utf-8")
    for name in ("index.html", "favicon.ico"):
        (folder / "html" / name).touch()
    pages.write(ROOT, folder / "html", MIRROR, KEPT, folder / "out")
    started = folder / "out" / "_static" / "live" / "pyodide" / packages.STARTED
    assert os.fsencode(ROOT) not in gzip.decompress(started.read_bytes())  # it goes to strangers
    with pytest.MonkeyPatch.context() as patch, chromium.serve(folder / "out") as address:
        patch.setattr(chromium, "POLICY", POLICY)
        yield address
