"""The built pages as plain HTML: links, prose, code and answers, each asked of every page."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

import pytest
from book_pages import (
    EVIDENCE_OF,
    PAGES,
    ROOT,
    WITH_WIDGETS,
    code_cells,
    source,
)
from bs4 import BeautifulSoup, Comment

built_test = pytest.mark.built
NOTEBOOKS = [page for page in PAGES if source(page).suffix == ".ipynb"]


# --- links --------------------------------------------------------------------------------


def broken_links(path: Path, read) -> list[str]:
    """Links and resources of a page that lead to no file or no anchor; `read` parses a file."""
    broken = []
    for tag in read(path).find_all(True):
        for link in (tag.get("href"), tag.get("src")):
            if not link or urlsplit(link).scheme or link.startswith("//"):
                continue
            target, anchor = urldefrag(link)
            target = path.parent / unquote(urlsplit(target).path) if target else path
            if not target.is_file():
                broken.append(link)
            elif anchor and target.suffix == ".html":
                searched = target.stem == "ledger" and anchor.startswith("q=")  # its own search
                broken += [link] * (not searched and unquote(anchor) not in anchors(target, read))
    return broken


ANCHORS: dict[Path, set[str]] = {}
# Of a widget in its saved state: its own, or that of its style sheet where its script has the key.
KEY = re.compile(r'(?:"key": "|\.ddlib-(?=trainer|builder))([\w-]+)')


def anchors(path: Path, read) -> set[str]:
    path = path.resolve()
    if path not in ANCHORS:
        tags = read(path).find_all(True)
        states = (tag.get_text() for tag in tags if "widget-state" in tag.get("type", ""))
        keys = (key for state in states for key in KEY.findall(state))
        ANCHORS[path] = {tag.get(key) for tag in tags for key in ("id", "name")}
        ANCHORS[path] |= {f"{key}-widget" for key in keys}  # as frame.js names them
    return ANCHORS[path]


def loaded_from_outside(page: BeautifulSoup) -> list[str]:
    tags = page.find_all(["script", "link", "img", "iframe", "source"])
    own = [tag for tag in tags if "canonical" not in tag.get("rel", [])]
    addresses = [tag.get("src") or tag.get("href") or "" for tag in own]
    return [address for address in addresses if re.match(r"(https?:)?//", address)]


@built_test
def test_links_resolve_and_nothing_comes_from_outside(built, parsed):
    def read(path):
        return parsed(path.resolve().relative_to(built.resolve()).with_suffix("").as_posix())

    names = [*PAGES, "search", "genindex"]
    assert all(parsed(name).find("a", href=True) for name in names)
    broken = {name: broken_links(built / f"{name}.html", read) for name in names}
    assert not {name: links for name, links in broken.items() if links}
    outside = {name: loaded_from_outside(parsed(name)) for name in PAGES}
    assert not {name: links for name, links in outside.items() if links}


# --- prose --------------------------------------------------------------------------------

PROSE = "article :is(p, h1, h2, h3, li, td, th, figcaption, dd)"
NOT_PROSE = "code, pre, script, style, svg, mjx-container, .math, .sig, .cell_output, .ddlib-widget"
PARTED = re.compile(r"\d (?:N m|kg|mm|rad/s|Hz|ms)(?!\w)|(?:^|[\s(])-\d[\d.]*")


def badly_set(page: BeautifulSoup) -> list[str]:
    """Numbers that a line can part from their unit, and hyphens for a minus."""
    texts = [text for text in page.find_all(string=PARTED) if not isinstance(text, Comment)]
    in_prose = [
        t for t in texts if t.parent.css.match(PROSE) and not t.parent.css.closest(NOT_PROSE)
    ]
    return [found for text in in_prose for found in PARTED.findall(text)]


@built_test
def test_numbers_are_well_set(parsed):
    assert not {name: found for name in PAGES if (found := badly_set(parsed(name)))}


# --- code and answers ---------------------------------------------------------------------


def open_code(page: BeautifulSoup) -> list[str]:
    """What stands in the open without a script or a click."""
    cells = page.select("article .cell:not(.tag_bookkeeping)")
    found = [pre for cell in cells for pre in cell.select(".cell_input pre")]
    return [pre.get_text() for pre in found if not pre.find_parent("details")]


@built_test
def test_no_code_is_lost(parsed):
    wrong = {}
    for name in NOTEBOOKS:
        shown, own = open_code(parsed(name)), [code.strip() for code in code_cells(source(name))]
        all_code = {pre.get_text().strip() for pre in parsed(name).select("pre")}
        wrong[name] = [code for code in shown if code.strip() not in own]
        wrong[name] += [cell for cell in own if cell not in all_code]
    assert not {name: found for name, found in wrong.items() if found}


@built_test
def test_a_lesson_links_the_evidence_behind_it(parsed):
    for lesson, behind in EVIDENCE_OF.items():
        for page in behind:
            address = f"{page.removeprefix('book/')}.html"
            assert parsed(lesson).select_one(f'article a[href^="{address}"]'), (lesson, page)


# --- weight -------------------------------------------------------------------------------


@built_test
def test_pages_with_widgets_are_known_and_light(parsed):
    """At most 400 kB of baked values for a widget; where the page computes, what it starts from."""
    kind = "application/vnd.jupyter.widget-"
    assert [p for p in PAGES if parsed(p).find(type=f"{kind}view+json")] == WITH_WIDGETS
    heavy = []
    for name in WITH_WIDGETS:
        saved = json.loads(parsed(name).find(type=f"{kind}state+json").string)["state"]
        for model, entry in saved.items():
            sizes = {
                buffer["path"][0]: len(base64.b64decode(buffer["data"]))
                for buffer in entry.get("buffers", ())
            }
            spec = entry["state"].get("spec") or {}
            stored = any(curve.get("axes") is not None for curve in spec.get("curves", ()))
            live = (spec.get("live") or "kind" in spec) and not stored
            tables = live and {"baked", "exact"} & {part for part, size in sizes.items() if size}
            if tables or sum(sizes.values()) > (32_000 if live else 400_000):
                heavy.append((name, model, sizes))
    assert not heavy


def test_text_on_canvases_can_be_read():
    """They are drawn in pixels of the page, so their sizes are those of the scripts."""
    folders = "ddlib/widgets/static", "book/*/chapters/widgets"
    scripts = [path for folder in folders for path in ROOT.glob(f"{folder}/*.js")]
    text = "".join(path.read_text("utf-8") for path in scripts)
    sizes = re.findall(r'\.font = "(?:bold |italic )?([\d.]+)px', text)
    assert len(sizes) == len(re.findall(r"\.font = ", text)) > 0
    assert min(map(float, sizes)) >= 9
