"""Old addresses lead on: of pages that were moved, and of sections that stand elsewhere now.

A page that was moved leaves a small one behind. Sections that were public once are listed in
`old_anchors.yml`, by the page on which they stood; the build finds where each is now and tells
`_static/moved.js`.
"""

from __future__ import annotations

import json
import posixpath
from pathlib import Path

import yaml
from docutils import nodes

OLD = Path(__file__).with_name("old_anchors.yml")
PAGES = {  # and evidence-NAME: evidence/NAME
    "book/why-smooth-filters": "book/whose-filters",
    "book/real-two-link-arm": "book/real-arm",
    "book/joints-three-and-four": "book/evidence/joints-three-and-four",
}
STUB = (
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>This page has moved</title>'
    '<link rel="icon" href="../_static/favicon.svg">'
    '<script>location.replace("{0}" + location.hash)</script>'
    '<meta http-equiv="refresh" content="1; url={0}"><p>This page is now <a href="{0}">here</a>.'
)
EMPTY = "const MOVED = {};"


def pages(found: set[str]) -> dict[str, str]:
    """Old names of pages, and the pages that they are now, among those that there are."""
    evidence = [page for page in found if page.startswith("book/evidence/")]
    moved = {f"book/evidence-{posixpath.basename(page)}": page for page in evidence}
    return moved | {old: new for old, new in PAGES.items() if new in found}


def gather(app, doctree, page):
    """Keep the names of a page's sections and figures in Sphinx's environment until `write`."""
    names = {name for node in doctree.findall(nodes.Element) for name in node.get("ids", ())}
    app.env.dd_moved_names = {**getattr(app.env, "dd_moved_names", {}), page: names}


def sections(ids: dict[str, set[str]], found: list[str]) -> dict[str, dict[str, list[str]]]:
    """For each old page its sections that stand on another page now, by that page.

    `ids` are those of each page, and `found` are the pages in the order of the contents.
    """
    moved: dict[str, dict[str, list[str]]] = {}
    for name, anchors in yaml.safe_load(OLD.read_text(encoding="utf-8")).items():
        own = f"book/{name}"
        for anchor in sorted(set(anchors) - set(ids.get(own, ()))):
            behind = [f"book/evidence/{name}", *found]  # the page's own evidence comes first
            now = next((page for page in behind if anchor in ids.get(page, ())), None)
            if now:
                moved.setdefault(own, {}).setdefault(now, []).append(anchor)
    return {own: {p: sorted(a) for p, a in now.items()} for own, now in sorted(moved.items())}


def write(app, exception):
    """Once all pages are there."""
    if exception is not None or app.builder.format != "html":
        return
    out, found = Path(app.outdir), list(app.env.collect_relations())
    for old, new in pages(set(found)).items():
        address = posixpath.relpath(f"{new}.html", posixpath.dirname(old))
        (out / f"{old}.html").write_text(STUB.format(address), encoding="utf-8")
    script = out / "_static" / "moved.js"
    names = getattr(app.env, "dd_moved_names", {})
    told = json.dumps(sections(names, found), separators=(",", ":"))
    text = script.read_text(encoding="utf-8").replace(EMPTY, f"const MOVED = {told};")
    script.write_text(text, encoding="utf-8")


def setup(app):
    app.connect("doctree-resolved", gather, priority=900)
    app.connect("build-finished", write, priority=901)  # after pages are slim
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
