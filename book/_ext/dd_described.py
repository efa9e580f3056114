"""Alternative texts of figures say what is seen: axes, shapes, which curve is where.

Code gives a figure a short text, often with what was computed. The longer one stands in the cell's
metadata, as ``mystnb: figure: alt``, so that open code stays short; a page's figure has both.
"""

from __future__ import annotations

import json
import re
from html import escape
from pathlib import Path

from docutils import nodes
from sphinx.transforms import SphinxTransform

NAME = re.compile(r'(<svg\b[^>]*? aria-label="[^"]*)"')


def described(path: Path) -> dict[str, str]:
    """What metadata of a notebook say of its figures, by their names."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    figures = (cell["metadata"].get("mystnb", {}).get("figure", {}) for cell in cells)
    return {figure["name"]: figure["alt"] for figure in figures if "alt" in figure}


def with_words(text: str, alt: str) -> str:
    """The markup of a figure, in all its forms, with more words in its name."""
    return NAME.sub(lambda name: f'{name[1]} {escape(alt)}"', text)


class Describe(SphinxTransform):
    """Longer names for the figures of a notebook."""

    default_priority = 420

    def apply(self, **kwargs):
        path = Path(self.env.doc2path(self.env.docname))
        texts = described(path) if path.suffix == ".ipynb" else {}
        for figure in self.document.findall(nodes.figure) if texts else ():
            alt = next((texts[name] for name in figure["names"] if name in texts), "")
            for raw in list(figure.findall(nodes.raw)) if alt else ():
                raw.replace_self(nodes.raw("", with_words(raw.astext(), alt), format="html"))


def setup(app):
    app.add_transform(Describe)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
