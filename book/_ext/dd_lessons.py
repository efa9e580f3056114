"""For who teaches: sections of chapters, and the exercises of all chapters by their kind.

The role ``{section}`page: Heading``` is a link to a section; a heading that the page does not have
is an error. The directive ``{exercises} kind`` lists exercises as links. An exercise is a paragraph
that begins with ``**2. Its title** (a derivation).``
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import NamedTuple

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective, SphinxRole

KINDS = ("derivation", "design", "prediction", "experiment")
HEADING = "On your own"
TITLE = re.compile(r"^\*\*(\d+)\. (.+?)\*\*(?: \(an? (\w+)\)\.)?", re.MULTILINE)


class Exercise(NamedTuple):
    """An exercise of a chapter; `kind` is empty where the page does not say it."""

    page: str
    number: int
    title: str
    kind: str


def prose(path: Path) -> list[str]:
    """The markdown cells of a notebook."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]) for c in cells if c["cell_type"] == "markdown"]


def headings(path: Path) -> list[str]:
    """All headings of a notebook."""
    return re.findall(r"^#+ (.+)$", "\n".join(prose(path)), re.MULTILINE)


def exercises(path: Path) -> list[Exercise]:
    """All exercises of a notebook, in its order."""
    _, _, own = "\n".join(prose(path)).partition(f"## {HEADING}\n")
    found = TITLE.findall(own)
    page = path.stem if path.parent.name == "book" else f"{path.parent.name}/{path.stem}"
    return [Exercise(page, int(number), title, kind) for number, title, kind in found]


def chapters(root: Path) -> list[Path]:
    """Notebooks in the order of the table of contents."""
    toc = (root / "_toc.yml").read_text(encoding="utf-8")
    paths = (root / f"{page}.ipynb" for page in re.findall(r"file: (\S+)", toc))
    return [path for path in paths if path.is_file()]


class Section(SphinxRole):
    """``{section}`page: Heading```."""

    def run(self):
        page, _, heading = self.text.partition(": ")
        path = Path(self.env.doc2path(self.env.docname)).parent / f"{page}.ipynb"
        if not path.is_file() or heading not in headings(path):
            told = self.inliner.reporter.error(f"no such section: {self.text}", line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, told)], [told]
        self.env.note_dependency(str(path))
        target = f"{page}.html#{nodes.make_id(heading)}"
        return [nodes.reference("", heading, internal=True, refuri=target)], []


class Listed(SphinxDirective):
    """``{exercises} kind``."""

    required_arguments = 1

    def run(self):
        kind = self.arguments[0]
        if kind not in KINDS:
            raise self.error(f"kind must be among {', '.join(KINDS)}, got {kind!r}")
        paths = chapters(Path(self.env.srcdir))
        for path in paths:
            self.env.note_dependency(str(path))
        found = (each for path in paths for each in exercises(path) if each.kind == kind)
        items = [nodes.list_item("", self.line(each)) for each in found]
        return [nodes.bullet_list("", *items)]

    def line(self, each: Exercise) -> nodes.paragraph:
        """The chapter as a link, and the exercise, by number and title, as another."""
        target = dict(refdomain="std", reftype="doc", refexplicit=False)
        target |= dict(reftarget=f"/book/{each.page}", refdoc=self.env.docname)
        link = pending_xref("", nodes.inline(), **target)
        title = re.sub(r"[$`\\]", "", each.title)
        to = f"{each.page}.html#exercise-{each.number}"
        asked = nodes.reference("", f"{each.number}: {title}", internal=True, refuri=to)
        return nodes.paragraph("", "", link, nodes.Text(", "), asked)


def setup(app):
    app.add_directive("exercises", Listed)
    app.add_role("section", Section())
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
