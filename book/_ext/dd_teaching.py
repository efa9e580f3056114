"""Lectures of the page *Teaching*: a table of what to show and ask, and the answers in a fold.

They stand in `book/lectures.yml`. The directive ``{lecture} 1`` shows one. The role
``{open}`words <page?widget=name:value>``` is a link that opens a widget in a state, which stands in
the address as the widget's own button *Link* writes it; ``<page#anchor>`` leads to a place. The
directive ``{lessons-at-a-glance}`` is a table of all lessons of the walk, with their minutes.
"""

from __future__ import annotations

import re
from pathlib import Path

import dd_lessons
import dd_quiz
import dd_runtime
import yaml
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective, SphinxRole

FILE = "book/lectures.yml"
LENGTH, QUIZ = 90, 5
"""Minutes of a lecture, and those of them for *Check yourself*."""

OPEN = re.compile(
    r"(?P<words>.+?)\s*<(?P<page>[\w-]+)(?:\?(?P<key>[\w-]+)=(?P<set>[^#>]+)|#(?P<at>[^>]+))>"
)
ANSWERS = {"answer": "Expected", "wrong": "Commonest wrong answer", "say": "Say", "open": "Open"}


def lectures(root: Path) -> dict[str, dict]:
    """All lectures, by name; a part of the book may have none."""
    path = root / FILE
    return yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}


def address(found: re.Match) -> str:
    """Where a match of `OPEN` leads, from a page beside it."""
    if found["at"]:
        return f"{found['page']}.html#{found['at']}"
    return f"{found['page']}.html?{found['key']}={found['set']}#{found['key']}-widget"


class Open(SphinxRole):
    """``{open}`words <page?widget=name:value>```."""

    def run(self):
        found = OPEN.fullmatch(self.text)
        home = Path(self.env.doc2path(self.env.docname)).parent
        if not found or not (home / f"{found['page']}.ipynb").is_file():
            told = self.inliner.reporter.error(f"opens nothing: {self.text}", line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, told)], [told]
        return [nodes.reference("", found["words"], internal=True, refuri=address(found))], []


class Lecture(SphinxDirective):
    """``{lecture} name``."""

    required_arguments = 1

    def run(self):
        root, name = Path(self.env.srcdir), self.arguments[0]
        self.env.note_dependency(str(root / FILE))
        told = lectures(root).get(name)
        if told is None:
            raise self.error(f"{FILE} has no lecture {name!r}")
        lines = [*self.table(root, told), "", *self.answers(name, told["rows"])]
        home = nodes.container()
        self.state.nested_parse(StringList(lines, FILE), self.content_offset, home)
        return home.children

    def table(self, root: Path, told: dict) -> list[str]:
        """What to show and ask, a line a question, and the quiz."""
        lines = ["| time | show | ask |", "| --- | --- | --- |"]
        for k, row in enumerate(told["rows"], 1):
            lines.append(f"| {row['minutes']} min | {row['show']} | **{k}.** {row['ask']} |")
        quiz = [page for page in told["pages"] if dd_quiz.questions(root, page)]
        last = ", ".join(f"{{doc}}`{page}`" for page in quiz[-2:])
        shown = f"*Check yourself* of {last}"
        return [*lines, f"| {QUIZ} min | {shown} | hands first, then somebody gives the reason |"]

    def answers(self, name: str, rows: list[dict]) -> list[str]:
        """The same questions with their answers, as a fold."""
        which = f"lecture {name}" if name.isdecimal() else "the class"
        lines = ['<details class="answer">', f"<summary>Answers of {which}</summary>", ""]
        for k, row in enumerate(rows, 1):
            lines += [f"**{k}.** {row['ask']}", ""]
            for key, words in ANSWERS.items():
                text = f"{{open}}`{row[key]}`" if key == "open" else row[key]
                lines.append(f"- *{words}:* {text}")
            lines.append("")
        return [*lines, "</details>", ""]


class AtAGlance(SphinxDirective):
    """``{lessons-at-a-glance}``."""

    def run(self):
        root, rows = Path(self.env.srcdir), []
        self.env.note_dependency(str(root / dd_quiz.FILE))
        for page in walk(root):
            path = root / "book" / f"{page}.ipynb"
            self.env.note_dependency(str(path))
            asked = nodes.inline()
            for each in dd_lessons.exercises(path):
                asked += [nodes.Text(", ")] if len(asked) else []
                asked += [dd_lessons.numbered(each, path), nodes.Text(f" ({each.minutes})")]
            quiz = nodes.reference(
                *("", f"{len(dd_quiz.questions(root, page))} questions"),
                **dict(internal=True, refuri=f"{page}.html#check-yourself"),
            )
            read = dd_runtime.minutes([path])
            rows.append((dd_lessons.chapter(self.env, page), read, quiz, asked))
        head = ("lesson", "to read", "Check yourself", "exercises (minutes)")
        return [dd_runtime.table([head, *rows])]


def walk(root: Path) -> list[str]:
    """Lessons of the walk, in their order."""
    parts = yaml.safe_load((root / "_toc.yml").read_text(encoding="utf-8"))["parts"]
    walked = (part for part in parts if part["caption"].startswith("The walk"))
    return [chapter["file"].rpartition("/")[2] for part in walked for chapter in part["chapters"]]


def setup(app):
    app.add_directive("lecture", Lecture)
    app.add_directive("lessons-at-a-glance", AtAGlance)
    app.add_role("open", Open())
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
