"""The lessons: their places in the contents, their notebooks, their entries in the book's lists.

A lesson is a notebook that `_toc.yml` names. Its questions stand in `book/quizzes.yml`, its
objectives in `book/objectives.yml`, its variants in `book/variants.yml`, each below its name. A
lesson may lack any of them. An exercise is a paragraph below the heading *Try it yourself* that
begins with ``**2. Its title** (a derivation).``
"""

from __future__ import annotations

import math
import posixpath
import re
from functools import cache, cached_property
from hashlib import sha1
from pathlib import Path
from typing import NamedTuple

import nbformat
import yaml
from sphinx_external_toc.api import SiteMap, TocTree
from sphinx_external_toc.parsing import parse_toc_yaml

ON_YOUR_OWN = "Try it yourself"
OWN = f"## {ON_YOUR_OWN}\n"
CHANGE_THIS = "change-this"  # tag of the cell whose settings all open cells follow
FOLDED = ("remove-cell", "remove-input", "hide-input")  # tags of code that does not stand open

KINDS = {"derivation": 10, "design": 15, "prediction": 5, "experiment": 10}
"""Kinds of exercise, and minutes to think about one."""

WORDS_A_MINUTE = 120
"""With formulas and figures; at 200, as for plain prose, readers took twice as long and more."""

LINE, EQUATION = 2, 1
"""Minutes for a line of code and for an equation, of as many as the solution has."""

SOLUTION = "<summary>Solution</summary>"
TITLE = re.compile(r"^\*\*(\d+)\. (.+?)\*\*(?: \(an? (\w+)\)\.)?", re.MULTILINE)
CODE = re.compile(r"^```python\n(.*?)^```|`(mine = [^`]+)`", re.MULTILINE | re.DOTALL)
EQUATIONS = re.compile(r"\$[^$]*(?:=|<|>|\\[lg]e\b|\\approx)[^$]*\$")
NEXT = re.compile(r"^## ", re.MULTILINE)


class Exercise(NamedTuple):
    """An exercise of a lesson; `kind` is empty where the page does not say it."""

    number: int
    title: str
    kind: str
    minutes: int


class Objective(NamedTuple):
    """What a reader can do, and what shows it, like "exercise 2" or "question 1"."""

    can: str
    by: list[str]


@cache
def contents(root: Path) -> SiteMap:
    """The table of contents: pages in their order, each with those below it."""
    return parse_toc_yaml(root / "_toc.yml")


@cache
def entries(root: Path, name: str) -> dict:
    """One of the book's lists, like "quizzes", by lesson; a part of the book may lack it."""
    path = root / "book" / f"{name}.yml"
    return (yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else None) or {}


class Lesson:
    """A page with a notebook, like "book/feedback" or "book/evidence/feedback"."""

    def __init__(self, root: Path, page: str):
        self.root, self.page = root, page
        self.name = page.removeprefix("book/")
        self.path = root / f"{page}.ipynb"

    @cached_property
    def notebook(self) -> nbformat.NotebookNode:
        return nbformat.read(self.path, as_version=4)

    @cached_property
    def prose(self) -> str:
        """All markdown, a blank line between two cells."""
        cells = self.notebook.cells
        return "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")

    @property
    def words(self) -> int:
        """Words of the prose; a word of code or of a role counts like any other."""
        return len(re.findall(r"\w+", self.prose))

    @property
    def headings(self) -> list[str]:
        """The title, and all other headings."""
        return re.findall(r"^#+ (.+)$", self.prose, re.MULTILINE)

    @cached_property
    def exercises(self) -> list[Exercise]:
        own = NEXT.split(f"{self.prose}\n".partition(OWN)[2], maxsplit=1)[0]
        pieces = TITLE.split(own)[1:]  # number, title, kind and text of each
        return [
            Exercise(int(number), title, kind or "", minutes(kind, text))
            for number, title, kind, text in zip(*(pieces[k::4] for k in range(4)))
        ]

    @property
    def questions(self) -> list[dict]:
        return questions(self.root, self.page)

    @property
    def objectives(self) -> list[Objective]:
        """What a reader can do after it, in the order of the list."""
        listed = entries(self.root, "objectives").get(self.name, ())
        return [Objective(**objective) for objective in listed]

    def anchor(self, test: str) -> str:
        """The id, on its page, of a test like "exercise 2" or "question 1"."""
        kind, number = test.split()
        if kind == "exercise":
            return f"exercise-{number}"
        return f"quiz-{self.questions[int(number) - 1]['key']}"


@cache
def lesson(root: Path, page: str) -> Lesson | None:
    """A page's lesson, read once; None where a page has no notebook."""
    made = Lesson(root, page)
    return made if made.path.is_file() else None


def lessons(root: Path) -> list[Lesson]:
    """All notebooks in the order of the contents, after the first page's."""
    _, *pages = contents(root)
    return [found for page in pages if (found := lesson(root, page))]


def handed_out(env, page: str) -> str:
    """Where a page's notebook is handed out, without ending: "book/evidence/02-feedback".

    Its number is that of the lesson it is or belongs to, of the first page 00; the back matter has
    none, and stands behind the numbers in a list.
    """
    folder, name = posixpath.split(page)
    number = env.toc_secnumbers.get(page, {}).get("") or (0,) * (page == env.config.root_doc)
    return posixpath.join(folder, f"{number[0]:02}-{name}" if number else name)


def chapters(root: Path) -> list[Path]:
    """Their paths."""
    return [found.path for found in lessons(root)]


def parts(root: Path) -> list[TocTree]:
    """The parts of the contents: each has a caption, and its `files` without those below them."""
    return contents(root).root.subtrees


def with_below(root: Path, pages: list[str]) -> list[str]:
    """Pages, each followed by those that stand below it in the contents."""
    below = contents(root)
    return [p for page in pages for p in (page, *with_below(root, below[page].child_files()))]


def walk(root: Path) -> list[Lesson]:
    """Lessons of the walk, without the evidence that stands below them."""
    walked = (part for part in parts(root) if (part.caption or "").startswith("The walk"))
    return [lesson(root, page) for part in walked for page in part.files()]


def questions(root: Path, page: str) -> list[dict]:
    """The questions of a page like "book/dynamics".

    To what the list has of a question comes its `key`, and to each answer its `letter` and its
    `verdict`. Answers are in an order that depends on their words alone, so that it tells nothing.
    """
    return [
        {**asked, "key": digest(asked["question"]), "answers": lettered(asked["answers"])}
        for asked in entries(root, "quizzes").get(page.removeprefix("book/"), ())
    ]


def digest(text: str) -> str:
    """A short key of a text, the same in every build."""
    return sha1(text.encode()).hexdigest()[:8]


def lettered(answers: list[dict]) -> list[dict]:
    """Answers in the order of their digests, with letters and verdicts ("B is right.")."""
    shuffled = sorted(answers, key=lambda answer: digest(answer["text"]))
    return [
        {**answer, "letter": letter, "verdict": f"{letter} is {'right' if right else 'wrong'}."}
        for letter, answer in zip("ABCDE", shuffled)
        for right in [answer.get("right", False)]
    ]


def minutes(kind: str | None, text: str) -> int:
    """How long an exercise takes; its text is that of question and solution.

    `RULE` in `dd_lessons.py` tells readers how.
    """
    lines = sum(len((block or line).strip().splitlines()) for block, line in CODE.findall(text))
    equations = len(EQUATIONS.findall(text.partition(SOLUTION)[2]))
    reading = len(re.findall(r"\w+", text)) / WORDS_A_MINUTE
    thinking = KINDS.get(kind, 10)
    return 5 * math.ceil((thinking + LINE * lines + EQUATION * equations + reading) / 5)


def time_to_read(some: list[Lesson]) -> str:
    """The time to read some lessons, to five minutes."""
    words = sum(each.words for each in some)
    return f"{5 * max(1, round(words / WORDS_A_MINUTE / 5))} minutes"
