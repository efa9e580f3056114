"""The built site, copied, with its lessons live."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import nbformat
from dd_reader import has_script
from lessons import chapters
from offers import FIRST as FIRST_PAGE, offer

from live.cells import imported, kind, live_cells
from live.packages import Refused, write_packages

DATA = re.compile(r"""["']data/([\w.-]+)["']""")


def live_page(
    text: str, notebook, page: str, megabytes: list[int], pages: list[str], packages: dict
) -> str:
    """A built page with its cells marked, and with the script that makes them run."""
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    before, *parts = re.split(r'(?=<div class="cell )', text)
    if len(parts) != len(code):
        raise Refused(f"{page} has {len(parts)} cells, its notebook {len(code)}: make book first")
    for k, cell in enumerate(code):
        if kind(cell):
            parts[k] = parts[k].replace("<div", f'<div data-live="{cell.id}"', 1)
    cells = live_cells(notebook)
    content = {
        "cells": cells,
        "ahead": imported(cells, packages),
        "data": sorted({name for cell in cells for name in DATA.findall(cell["source"])}),
        "megabytes": megabytes,
        "notebook": f"../_sources/{page}.ipynb",
        "pages": [f"{name.rpartition('/')[2]}.html" for name in pages],
    }
    island = json.dumps(content).replace("</", "<\\/")
    added = (
        '<link rel="stylesheet" href="../_static/live/live.css">'
        '<script defer src="../_static/live/follow.js"></script>'
        '<script defer src="../_static/live/live.js"></script>'
        f'<script type="application/json" id="live-page">{island}</script>'
    )
    return "".join([before, *parts]).replace("</body>", f"{added}\n</body>", 1)


def write(root: Path, site: Path, mirror: str, store: Path, out: Path) -> list[str]:
    """The site with its lessons live, in a folder of its own: whole, or as it was before."""
    if not (site / "index.html").is_file():
        raise Refused(f"{site} has no pages: make book first")
    part = out.with_name(f"{out.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    try:
        shutil.copytree(site, part)
        folder = part / "_static" / "live"
        megabytes, packages = write_packages(root, mirror, store, folder)
        (folder / "isolate.js").rename(part / "isolate.js")  # it reaches what is beside and below
        pages = {}
        for path in chapters(root):
            page = path.relative_to(root).with_suffix("").as_posix()
            notebook = nbformat.read(path, as_version=4)
            if (part / f"{page}.html").is_file() and has_script(notebook):
                pages[page] = notebook
        for page, notebook in pages.items():
            target = part / f"{page}.html"
            text = target.read_text("utf-8")
            text = live_page(text, notebook, page, megabytes, list(pages), packages)
            target.write_text(text, encoding="utf-8")
            for name in DATA.findall("\n".join(cell.source for cell in notebook.cells)):
                (folder / "data").mkdir(exist_ok=True)
                shutil.copyfile(root / "book" / "data" / name, folder / "data" / name)
        if (folder / "data").is_dir():  # others made them
            for path in [*(root / "book" / "data").glob("LICENSE-*"), root / "book/data/README.md"]:
                shutil.copy(path, folder / "data")
        if (part / FIRST_PAGE).is_file():
            offer(part)
        shutil.rmtree(out, ignore_errors=True)
        part.rename(out)
    finally:
        shutil.rmtree(part, ignore_errors=True)
    return list(pages)
