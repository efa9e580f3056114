"""Alternative texts of figures say what is seen: axes, shapes, which curve is where.

Code gives a figure a short text, often with what was computed. The longer one stands in the cell's
metadata, as ``mystnb: figure: alt``, so that open code stays short; a page's figure has both.
"""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

from docutils import nodes
from rewriter import Rewriter
from sphinx.transforms import SphinxTransform


class Pictures(Rewriter):
    """The SVG pictures of some markup, whose names get more words."""

    def __init__(self, text: str, words: str):
        self.words = words
        super().__init__(text)

    def handle_starttag(self, name, attributes):
        before, label, after = self.get_starttag_text().partition(' aria-label="')
        if name == "svg" and label:
            told, _, after = after.partition('"')
            new = f'{before}{label}{told} {escape(self.words)}"{after}'
            self.change(self.start, self.end, new)


def described(path: Path) -> dict[str, str]:
    """What metadata of a notebook say of its figures, by their names."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    told = (cell["metadata"].get("mystnb", {}).get("figure", {}) for cell in cells)
    return {one["name"]: one["alt"] for one in told if "alt" in one}


def with_words(text: str, alt: str) -> str:
    """The markup of a figure, in all its forms, with more words in its name."""
    return Pictures(text, alt).changed()


class Describe(SphinxTransform):
    """Longer names for the figures of a notebook."""

    default_priority = 420

    def apply(self, **kwargs):
        path = Path(self.env.doc2path(self.env.docname))
        told = described(path) if path.suffix == ".ipynb" else {}
        for figure in self.document.findall(nodes.figure) if told else ():
            alt = next((told[name] for name in figure["names"] if name in told), "")
            for raw in list(figure.findall(nodes.raw)) if alt else ():
                raw.replace_self(nodes.raw("", with_words(raw.astext(), alt), format="html"))


def setup(app):
    app.add_transform(Describe)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
