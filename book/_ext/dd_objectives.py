"""What a reader can do after a lesson, each with a link to what tests it.

The objectives stand in `book/objectives.yml`. A lesson gets the section *What you can do now*
before *Check yourself*, on its page and in readers' notebooks; the directive ``{objectives}``
without an argument lists those of all lessons.
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
BEGINS = "After this lesson you can"  # before the list, whose entries go on with it

# What is put into a lesson before `OWN`, the heading *On your own*
CALL = f"{HEADING}\n\n{BEGINS}\n\n```{{objectives}} LESSON\n```\n\n"


class Objective(NamedTuple):
    """What a reader can do, and what shows it, like "exercise 2" or "question 1"."""

    can: str
    by: list[str]


def objectives(root: Path) -> dict[str, list[Objective]]:
    """The objectives of each lesson that has some, in the file's order."""
    path = root / FILE
    by_lesson = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return {page: [Objective(**each) for each in some] for page, some in by_lesson.items()}


def anchor(root: Path, page: str, test: str) -> str:
    """The id, on its page, of a test like "exercise 2" or "question 1"."""
    kind, number = test.split()
    if kind == "exercise":
        return f"exercise-{number}"
    return f"quiz-{questions(root, page)[int(number) - 1]['key']}"


def with_markdown(source: str, root: Path, page: str) -> str:
    """A markdown cell of a reader's notebook: where it asks for own work, objectives first."""
    some = objectives(root).get(page.rpartition("/")[2], []) if OWN in source else []
    lines = [f"- {each.can} ({', '.join(each.by)})" for each in some]
    section = "\n\n".join([HEADING, BEGINS, "\n".join(lines), OWN]) if some else OWN
    return source.replace(OWN, section)


def call(app, page, text):
    """Put the directive before *On your own* of a lesson's notebook.

    Sphinx gives a page's source as a list of one text, to be changed in place.
    """
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
    """``{objectives} lesson``: its list; without an argument those of all, below links to them."""

    optional_arguments = 1

    def run(self):
        self.root = Path(self.env.srcdir)
        self.env.note_dependency(str(self.root / FILE))
        by_lesson = objectives(self.root)
        if self.arguments:
            lesson = self.arguments[0]
            return [self.items(lesson, by_lesson[lesson], "")]
        return [
            node
            for page, some in by_lesson.items()
            for node in (self.lesson(page), self.items(page, some, f"{page}.html"))
        ]

    def lesson(self, page: str) -> nodes.paragraph:
        """A link to a lesson; Sphinx puts in its title."""
        target = dict(refdomain="std", reftype="doc", refexplicit=False)
        target |= dict(reftarget=f"/book/{page}", refdoc=self.env.docname)
        return nodes.paragraph("", "", pending_xref("", nodes.inline(), **target))

    def items(self, page: str, some: list[Objective], at: str) -> nodes.bullet_list:
        """The list of a lesson's objectives; `at` is its address, "" on its own page."""
        return nodes.bullet_list("", *(self.item(page, each, at) for each in some))

    def item(self, page: str, one: Objective, at: str) -> nodes.list_item:
        """An objective with links to its tests: "derive ... (exercise 1, question 2)"."""
        links = [self.link(page, test, at) for test in one.by]
        words = [nodes.Text(one.can.replace("'", "’") + " (")]
        for link in links:
            words += [link, nodes.Text(", " if link is not links[-1] else ")")]
        return nodes.list_item("", nodes.paragraph("", "", *words))

    def link(self, page: str, test: str, at: str) -> nodes.reference:
        address = f"{at}#{anchor(self.root, page, test)}"
        return nodes.reference("", test, internal=True, refuri=address)


def setup(app):
    app.add_directive("objectives", Listed)
    app.connect("source-read", call, priority=400)  # before dd_quiz, so above it
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
