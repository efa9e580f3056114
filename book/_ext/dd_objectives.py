"""What a reader can do after a lesson, each with a link to what tests it.

It stands in `book/objectives.yml`. A lesson gets the section *What you can do now* before *Check
yourself*, on its page and in readers' notebooks; the directive ``{objectives}`` lists all lessons.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import yaml
from dd_quiz import OWN, questions
from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective

FILE = "book/objectives.yml"
HEADING = "## What you can do now"
BEGINS = "After this lesson you can"
CALL = f"{HEADING}\n\n{BEGINS}\n\n```{{objectives}} LESSON\n```\n\n"


class Objective(NamedTuple):
    """What a reader can do, and what shows it, like "exercise 2" or "question 1"."""

    can: str
    by: list[str]


def objectives(root: Path) -> dict[str, list[Objective]]:
    """The objectives of each lesson that has some, in the file's order."""
    path = root / FILE
    found = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return {page: [Objective(**each) for each in some] for page, some in found.items()}


def anchor(root: Path, page: str, test: str) -> str:
    """Where a test stands on its page."""
    kind, number = test.split()
    if kind == "exercise":
        return f"exercise-{number}"
    return f"quiz-{questions(root, page)[int(number) - 1]['key']}"


def with_markdown(source: str, root: Path, page: str) -> str:
    """A markdown cell of a reader's notebook: objectives before its own work."""
    asked = objectives(root).get(page.rpartition("/")[2], []) if OWN in source else []
    lines = [f"- {one.can} ({', '.join(one.by)})" for one in asked]
    told = "\n\n".join([HEADING, BEGINS, "\n".join(lines), OWN]) if asked else OWN
    return source.replace(OWN, told)


def call(app, page, text):
    """Put the directive before *On your own* of a lesson's notebook."""
    lesson = page.removeprefix("book/")
    if lesson not in objectives(Path(app.srcdir)) or OWN.strip() not in text[0]:
        return
    notebook = json.loads(text[0])
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = "".join(cell["source"]).replace(
                OWN, CALL.replace("LESSON", lesson) + OWN
            )
    text[0] = json.dumps(notebook)


class Listed(SphinxDirective):
    """``{objectives} lesson``, or of all lessons, each with its name."""

    optional_arguments = 1

    def run(self):
        self.root = Path(self.env.srcdir)
        self.env.note_dependency(str(self.root / FILE))
        every = objectives(self.root)
        if self.arguments:
            return [self.items(self.arguments[0], every[self.arguments[0]], "")]
        return [
            node
            for page, some in every.items()
            for node in (self.lesson(page), self.items(page, some, f"{page}.html"))
        ]

    def lesson(self, page: str) -> nodes.paragraph:
        target = dict(refdomain="std", reftype="doc", refexplicit=False)
        target |= dict(reftarget=f"/book/{page}", refdoc=self.env.docname)
        return nodes.paragraph("", "", pending_xref("", nodes.inline(), **target))

    def items(self, page: str, some: list[Objective], at: str) -> nodes.bullet_list:
        return nodes.bullet_list("", *(self.item(page, each, at) for each in some))

    def item(self, page: str, one: Objective, at: str) -> nodes.list_item:
        links = [self.link(page, test, at) for test in one.by]
        told = [nodes.Text(one.can.replace("'", "’") + " (")]
        for link in links:
            told += [link, nodes.Text(", " if link is not links[-1] else ")")]
        return nodes.list_item("", nodes.paragraph("", "", *told))

    def link(self, page: str, test: str, at: str) -> nodes.reference:
        to = f"{at}#{anchor(self.root, page, test)}"
        return nodes.reference("", test, internal=True, refuri=to)


def setup(app):
    app.add_directive("objectives", Listed)
    app.connect("source-read", call, priority=400)  # before the questions are put there
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
