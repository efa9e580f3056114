"""For who teaches: the exercises of all chapters by their kind.

The directive ``{exercises} kind`` lists them as links. An exercise is a paragraph that begins with
``**2. Its title.** *Derivation.*``; the test of this module asks every chapter for its kinds.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import NamedTuple

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective

KINDS = ("derivation", "design", "prediction", "experiment")
HEADING = "On your own"
TITLE = re.compile(r"^\*\*(\d+)\. (.+?)\*\*(?: \*(\w+)\.\*)?", re.MULTILINE)


class Exercise(NamedTuple):
    """An exercise of a chapter; `kind` is None where the page does not say it."""

    page: str
    number: int
    title: str
    kind: str | None


def exercises(path: Path) -> list[Exercise]:
    """All exercises of a notebook, in its order."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    texts = ["".join(c["source"]) for c in cells if c["cell_type"] == "markdown"]
    starts = [k for k, text in enumerate(texts) if f"## {HEADING}" in text]
    if not starts:
        return []
    found = TITLE.findall("\n".join(texts[starts[0] :]))
    return [
        Exercise(path.stem, int(number), title.rstrip(".?"), kind.lower() or None)
        for number, title, kind in found
    ]


class Listed(SphinxDirective):
    """``{exercises} kind``."""

    required_arguments = 1

    def run(self):
        kind = self.arguments[0]
        if kind not in KINDS:
            raise self.error(f"kind must be among {', '.join(KINDS)}, got {kind!r}")
        folder = Path(self.env.srcdir, "book")
        items = []
        for page in sorted(folder.glob("*.ipynb")):
            self.env.note_dependency(str(page))
        for page in self.pages(folder):
            for each in exercises(page):
                if each.kind == kind:
                    items.append(nodes.list_item("", self.line(each)))
        return [nodes.bullet_list("", *items)]

    def pages(self, folder: Path) -> list[Path]:
        """Chapters in the order of the table of contents."""
        listed = re.findall(r"file: book/([\w-]+)$", self.toc(), re.MULTILINE)
        paths = (folder / f"{name}.ipynb" for name in listed)
        return [path for path in paths if path.is_file()]

    def toc(self) -> str:
        path = Path(self.env.srcdir, "_toc.yml")
        self.env.note_dependency(str(path))
        return path.read_text(encoding="utf-8")

    def line(self, each: Exercise) -> nodes.paragraph:
        target = dict(refdomain="std", reftype="doc", refexplicit=False)
        target |= dict(reftarget=f"/book/{each.page}", refdoc=self.env.docname)
        link = pending_xref("", nodes.inline(), **target)
        return nodes.paragraph("", "", link, nodes.Text(f", {each.number}: {each.title}"))


def setup(app):
    app.add_directive("exercises", Listed)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
