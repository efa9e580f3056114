"""For who teaches: sections of chapters, and the exercises of all chapters by their kind.

The role ``{section}`page: Heading``` is a link to a section; a heading that the page does not have
is an error. So is ``{exercise}`page: 1, 3```, which links exercises and says how long they take.
The directive ``{exercises} kind`` lists exercises as links, and ``{exercise-minutes}`` says by
which rule their minutes are estimated. An exercise is a paragraph that begins with
``**2. Its title** (a derivation).``
"""

from __future__ import annotations

import json
import math
import re
from html import escape
from pathlib import Path
from typing import NamedTuple

import dd_quiz
from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective, SphinxRole

KINDS = {"derivation": 10, "design": 15, "prediction": 5, "experiment": 10}
"""Kinds of exercise, and minutes to think about one."""

WORDS_A_MINUTE = 120
"""With formulas and figures; at 200, as for plain prose, readers took twice as long and more."""

LINE, EQUATION = 2, 1
"""Minutes for a line of code and for an equation, of as many as the solution has."""

RULE = (
    "Minutes of an exercise are estimated by a rule: {think}; {line} for each line of code and "
    "{equation} for each equation that the solution has; and the time to read question and "
    "solution, at {pace} words a minute. The sum is rounded up to five minutes."
)
SOLUTION = "<summary>Solution</summary>"
TITLE = re.compile(r"^\*\*(\d+)\. (.+?)\*\*(?: \(an? (\w+)\)\.)?", re.MULTILINE)
CODE = re.compile(r"^```python\n(.*?)^```|`(mine = [^`]+)`", re.MULTILINE | re.DOTALL)
EQUATIONS = re.compile(r"\$[^$]*(?:=|<|>|\\[lg]e\b|\\approx)[^$]*\$")
NEXT = re.compile(r"^## ", re.MULTILINE)


class Exercise(NamedTuple):
    """An exercise of a chapter; `kind` is empty where the page does not say it."""

    page: str
    number: int
    title: str
    kind: str
    minutes: int


def prose(path: Path) -> list[str]:
    """The markdown cells of a notebook."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]) for c in cells if c["cell_type"] == "markdown"]


def headings(path: Path) -> list[str]:
    """All headings of a notebook."""
    return re.findall(r"^#+ (.+)$", "\n".join(prose(path)), re.MULTILINE)


def exercises(path: Path) -> list[Exercise]:
    """All exercises of a notebook, in its order."""
    _, _, own = "\n".join(prose(path)).partition(dd_quiz.OWN)
    own = NEXT.split(own, maxsplit=1)[0]
    page = path.stem if path.parent.name == "book" else f"{path.parent.name}/{path.stem}"
    pieces = TITLE.split(own)[1:]  # number, title, kind and text of each
    return [
        Exercise(page, int(number), title, kind or "", minutes(kind, text))
        for number, title, kind, text in zip(*(pieces[k::4] for k in range(4)))
    ]


def minutes(kind: str | None, text: str) -> int:
    """How long an exercise takes by `RULE`; its text is that of question and solution."""
    lines = sum(len((block or line).strip().splitlines()) for block, line in CODE.findall(text))
    equations = len(EQUATIONS.findall(text.partition(SOLUTION)[2]))
    read = len(re.findall(r"\w+", text)) / WORDS_A_MINUTE
    return 5 * math.ceil((KINDS.get(kind, 10) + LINE * lines + EQUATION * equations + read) / 5)


def rule() -> str:
    """`RULE` with its numbers."""
    thought = sorted((number, kind) for kind, number in KINDS.items())
    alike = {
        n: [f"a{'n' * (k[0] in 'aeiou')} {k}" for m, k in thought if m == n] for n, _ in thought
    }
    think = ", ".join(f"{n} about {' or '.join(kinds)}" for n, kinds in alike.items())
    think = think.replace(" about", " minutes to think about", 1)
    return RULE.format(think=think, line=LINE, equation=EQUATION, pace=WORDS_A_MINUTE)


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
        quiz = heading == dd_quiz.HEADING[3:] and dd_quiz.questions(Path(self.env.srcdir), page)
        if not path.is_file() or not (quiz or heading in headings(path)):
            told = self.inliner.reporter.error(f"no such section: {self.text}", line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, told)], [told]
        self.env.note_dependency(str(path))
        target = f"{page}.html#{nodes.make_id(heading)}"
        return [nodes.reference("", heading, internal=True, refuri=target)], []


class Asked(SphinxRole):
    """``{exercise}`page: 1, 3```."""

    def run(self):
        page, _, numbers = self.text.partition(": ")
        path = Path(self.env.doc2path(self.env.docname)).parent / f"{page}.ipynb"
        known = {str(one.number): one for one in exercises(path)} if path.is_file() else {}
        wanted = numbers.split(", ")
        if not set(wanted) <= set(known):
            told = self.inliner.reporter.error(f"no such exercise: {self.text}", line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, told)], [told]
        self.env.note_dependency(str(path))
        found = [chapter(self.env, page), nodes.Text(f", exercise{'s' * (len(wanted) > 1)} ")]
        for k, number in enumerate(wanted):
            between = " and " if k + 1 == len(wanted) else ", "
            found += [nodes.Text(between)] if k else []
            found += [numbered(known[number], path)]
            found += [nodes.Text(f" ({known[number].minutes} min)")]
        return found, []


def chapter(env, page: str) -> pending_xref:
    """A link to a chapter, with its title."""
    target = dict(refdomain="std", reftype="doc", refexplicit=False)
    target |= dict(reftarget=f"/book/{page}", refdoc=env.docname)
    return pending_xref("", nodes.inline(), **target)


def numbered(each: Exercise, path: Path) -> nodes.raw:
    """A link to an exercise that shows its number alone, and tells the rest to a screen reader."""
    told = escape(f"Exercise {each.number} of {headings(path)[0]}", quote=True)
    to = f'href="{each.page}.html#exercise-{each.number}" aria-label="{told}"'
    link = f'<a class="reference internal" {to}>{each.number}</a>'
    return nodes.raw("", link, format="html")


class Minutes(SphinxDirective):
    """``{exercise-minutes}``."""

    def run(self):
        return [nodes.paragraph("", rule())]


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
        title = re.sub(r"[$`\\]", "", each.title)
        to = f"{each.page}.html#exercise-{each.number}"
        asked = nodes.reference("", f"{each.number}: {title}", internal=True, refuri=to)
        took = nodes.Text(f" ({each.minutes} min)")
        return nodes.paragraph("", "", chapter(self.env, each.page), nodes.Text(", "), asked, took)


def setup(app):
    app.add_directive("exercises", Listed)
    app.add_directive("exercise-minutes", Minutes)
    app.add_role("exercise", Asked())
    app.add_role("section", Section())
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
