"""Pages with the cells of lessons and nothing else, live: what tests of *Run this page* open."""

from __future__ import annotations

import html
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import chromium
import pytest
from book_pages import ROOT
from open_cells import lesson

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import live

MIRROR = os.environ.get("DDLIB_LIVE_MIRROR", "")
POLICY = f"{chromium.POLICY}; script-src 'self' 'unsafe-inline' blob: 'wasm-unsafe-eval'"
IDLE = "html[data-live=idle]"


def plain(page: str) -> str:
    """A page with the cells of a notebook, and nothing else."""
    cell = '<div class="cell x"><div class="cell_input"><pre>{}</pre></div></div>'
    code = (html.escape(c.source) for c in lesson(page).cells if c.cell_type == "code")
    main = f"<main><section><h1>x</h1>{''.join(map(cell.format, code))}</section></main>"
    head = '<html lang="en"><meta charset="utf-8"><title>x</title>'
    return f"<!doctype html>{head}<body>{main}</body></html>"


def runs_through(tab, site: str, page: str) -> None:
    """Open a page and run it: each cell that a reader can run ends, and none complains."""
    tab.goto(f"{site}/{page}.html")
    tab.get_by_role("button", name="Run this page").click()
    tab.locator(IDLE).wait_for(timeout=900_000)
    assert all(times := tab.locator(".live-time").all_inner_texts())
    assert len(times) == len(live.live_cells(lesson(page)))
    assert not tab.locator(".live-error, .live-warning, .live-note:has(a)").all_inner_texts()


@contextmanager
def served(folder: Path, pages: Iterable[str]) -> Iterator[str]:
    """The address of such pages on a server of their own; skips where no mirror is named."""
    if not MIRROR:
        pytest.skip("set DDLIB_LIVE_MIRROR to a folder or an address with Pyodide's packages")
    (folder / "html" / "book").mkdir(parents=True)
    for page in pages:
        (folder / "html" / f"{page}.html").write_text(plain(page), encoding="utf-8")
    for name in ("index.html", "favicon.ico"):
        (folder / "html" / name).touch()
    kept = live.BUILD / "pyodide" / live.VERSION
    live.write(ROOT, folder / "html", MIRROR, kept, folder / "out")
    with pytest.MonkeyPatch.context() as patch, chromium.serve(folder / "out") as address:
        patch.setattr(chromium, "POLICY", POLICY)
        yield address
