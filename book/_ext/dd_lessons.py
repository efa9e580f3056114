"""What pages say of lessons: their sections, exercises, objectives and times; and lectures on them.

- ``{section}`page: Heading``` links a section, ``{exercise}`page: 1, 3``` links exercises and says
  how long they take, ``{open}`words <page?widget=name:value>``` opens a widget in a state, which
  stands in the address as the widget's own button *Link* writes it, or leads to ``<page#anchor>``.
  What is not there is an error.
- ``{reading}`page page``` is the time to read some pages.
- ``{exercises} kind`` lists exercises, ``{exercise-minutes}`` says by which rule their minutes are
  estimated, ``{objectives}`` lists what readers can do after each lesson.
- ``{lecture} 1`` is a lecture of `book/lectures.yml`: a table of what to show and ask, and the
  answers in a fold. ``{lessons-at-a-glance}`` is a table of the walk, ``{answers-that-differ}`` one
  of how many different answers variants have to each exercise.
"""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

from dd_runtime import table
from docutils import nodes
from docutils.statemachine import StringList
from lessons import (
    EQUATION,
    KINDS,
    LINE,
    WORDS_A_MINUTE,
    Exercise,
    Lesson,
    Objective,
    chapters,
    entries,
    lesson,
    lessons,
    time_to_read,
    walk,
)
from sphinx.addnodes import pending_xref
from sphinx.util.docutils import SphinxDirective, SphinxRole

RULE = (
    "Minutes of an exercise are estimated by a rule: {think}; {line} for each line of code and "
    "{equation} for each equation that the solution has; and the time to read question and "
    "solution, at {pace} words a minute. The sum is rounded up to five minutes."
)
LENGTH, QUIZ = 90, 5
"""Minutes of a lecture, and those of them for *Check yourself*."""

OPEN = re.compile(
    r"(?P<words>.+?)\s*<(?P<page>[\w-]+)(?:\?(?P<key>[\w-]+)=(?P<set>[^#>]+)|#(?P<at>[^>]+))>"
)
ANSWERS = {"answer": "Expected", "wrong": "Commonest wrong answer", "say": "Say", "open": "Open"}


def rule() -> str:
    """`RULE` with its numbers."""
    kinds: dict[int, list[str]] = {}
    for kind, minutes in sorted(KINDS.items(), key=lambda entry: (entry[1], entry[0])):
        kinds.setdefault(minutes, []).append(f"a{'n' * (kind[0] in 'aeiou')} {kind}")
    think = ", ".join(f"{n} about {' or '.join(alike)}" for n, alike in kinds.items())
    think = think.replace(" about", " minutes to think about", 1)
    return RULE.format(think=think, line=LINE, equation=EQUATION, pace=WORDS_A_MINUTE)


def address(found: re.Match) -> str:
    """Where a match of `OPEN` leads, from a page beside it."""
    if found["at"]:
        return f"{found['page']}.html#{found['at']}"
    return f"{found['page']}.html?{found['key']}={found['set']}#{found['key']}-widget"


def title_of(env, page: str) -> pending_xref:
    """A link to a lesson; Sphinx puts in its title."""
    target = dict(refdomain="std", reftype="doc", refexplicit=False)
    target |= dict(reftarget=f"/book/{page}", refdoc=env.docname)
    return pending_xref("", nodes.inline(), **target)


def numbered(exercise: Exercise, of: Lesson) -> nodes.raw:
    """A link to an exercise that shows its number alone, and tells the rest to a screen reader."""
    label = escape(f"Exercise {exercise.number} of {of.headings[0]}", quote=True)
    target = f'href="{of.name}.html#exercise-{exercise.number}" aria-label="{label}"'
    link = f'<a class="reference internal" {target}>{exercise.number}</a>'
    return nodes.raw("", link, format="html")


class LessonRole(SphinxRole):
    """A role about lessons beside the page that asks; `made` raises LookupError for what is not."""

    kind = ""

    def run(self):
        try:
            return self.made(), []
        except LookupError:
            message = f"no such {self.kind}: {self.text}"
            error = self.inliner.reporter.error(message, line=self.lineno)
            return [self.inliner.problematic(self.rawtext, self.rawtext, error)], [error]

    def beside(self, name: str) -> Lesson:
        page = f"{self.env.docname.rpartition('/')[0]}/{name}"
        found = lesson(Path(self.env.srcdir), page)
        if found is None:
            raise LookupError(page)
        self.env.note_dependency(str(found.path))
        return found


class Section(LessonRole):
    """``{section}`page: Heading```."""

    kind = "section"

    def made(self):
        page, _, heading = self.text.partition(": ")
        found = self.beside(page)
        if heading not in found.headings and not (heading == "Check yourself" and found.questions):
            raise LookupError(heading)
        target = f"{page}.html#{nodes.make_id(heading)}"
        return [nodes.reference("", heading, internal=True, refuri=target)]


class Exercises(LessonRole):
    """``{exercise}`page: 1, 3```."""

    kind = "exercise"

    def made(self):
        page, _, numbers = self.text.partition(": ")
        found = self.beside(page)
        by_number = {str(exercise.number): exercise for exercise in found.exercises}
        asked = [by_number[number] for number in numbers.split(", ")]
        parts = [title_of(self.env, page), nodes.Text(f", exercise{'s' * (len(asked) > 1)} ")]
        for exercise in asked:
            between = " and " if exercise is asked[-1] else ", "
            parts += [nodes.Text(between)] if exercise is not asked[0] else []
            parts += [numbered(exercise, found), nodes.Text(f" ({exercise.minutes} min)")]
        return parts


class Open(LessonRole):
    """``{open}`words <page?widget=name:value>```."""

    kind = "page, widget or place"

    def made(self):
        found = OPEN.fullmatch(self.text)
        if not found:
            raise LookupError(self.text)
        self.beside(found["page"])
        return [nodes.reference("", found["words"], internal=True, refuri=address(found))]


class Reading(LessonRole):
    """``{reading}`page page```."""

    kind = "page"

    def made(self):
        return [nodes.inline(text=time_to_read(list(map(self.beside, self.text.split()))))]


class LessonDirective(SphinxDirective):
    """A directive about all lessons."""

    @property
    def root(self) -> Path:
        return Path(self.env.srcdir)

    def depends_on(self, *paths: Path) -> None:
        for path in paths:
            self.env.note_dependency(str(path))


class Minutes(LessonDirective):
    """``{exercise-minutes}``."""

    def run(self):
        return [nodes.paragraph("", rule())]


class Listed(LessonDirective):
    """``{exercises} kind``."""

    required_arguments = 1

    def run(self):
        kind = self.arguments[0]
        if kind not in KINDS:
            raise self.error(f"kind must be among {', '.join(KINDS)}, got {kind!r}")
        self.depends_on(*chapters(self.root))
        lines = [
            nodes.list_item("", self.line(exercise, of))
            for of in lessons(self.root)
            for exercise in of.exercises
            if exercise.kind == kind
        ]
        return [nodes.bullet_list("", *lines)]

    def line(self, exercise: Exercise, of: Lesson) -> nodes.paragraph:
        """The lesson as a link, and the exercise, by number and title, as another."""
        title = re.sub(r"[$`\\]", "", exercise.title)
        target = f"{of.name}.html#exercise-{exercise.number}"
        link = nodes.reference("", f"{exercise.number}: {title}", internal=True, refuri=target)
        minutes = nodes.Text(f" ({exercise.minutes} min)")
        return nodes.paragraph("", "", title_of(self.env, of.name), nodes.Text(", "), link, minutes)


class Objectives(LessonDirective):
    """``{objectives}``: those of all lessons, below links to them."""

    def run(self):
        self.depends_on(self.root / "book" / "objectives.yml", self.root / "book" / "quizzes.yml")
        return [
            node
            for of in lessons(self.root)
            if of.objectives
            for node in (
                nodes.paragraph("", "", title_of(self.env, of.name)),
                self.items(of, f"{of.name}.html"),
            )
        ]

    def items(self, of: Lesson, at: str) -> nodes.bullet_list:
        """The list of a lesson's objectives; `at` is its address."""
        return nodes.bullet_list("", *(self.item(objective, of, at) for objective in of.objectives))

    def item(self, objective: Objective, of: Lesson, at: str) -> nodes.list_item:
        """An objective with links to its tests: "derive ... (exercise 1, question 2)"."""
        links = [
            nodes.reference("", test, internal=True, refuri=f"{at}#{of.anchor(test)}")
            for test in objective.by
        ]
        parts = [nodes.Text(objective.can.replace("'", "’") + " (")]
        for link in links:
            parts += [link, nodes.Text(", " if link is not links[-1] else ")")]
        return nodes.list_item("", nodes.paragraph("", "", *parts))


class Lecture(LessonDirective):
    """``{lecture} name``."""

    required_arguments, final_argument_whitespace = 1, True

    def run(self):
        name = self.arguments[0]
        self.depends_on(self.root / "book" / "lectures.yml", self.root / "book" / "quizzes.yml")
        lecture = entries(self.root, "lectures").get(name)
        if lecture is None:
            raise self.error(f"book/lectures.yml has no lecture {name!r}")
        which = "the class" if name in lecture["pages"] else f"lecture {name}"
        lines = [*self.table(lecture), "", *self.answers(which, lecture["rows"])]
        home = nodes.container()
        self.state.nested_parse(StringList(lines, "lectures.yml"), self.content_offset, home)
        return home.children

    def table(self, lecture: dict) -> list[str]:
        """What to show and ask, a line a question, and the quiz."""
        lines = ["| time | show | ask |", "| --- | --- | --- |"]
        for k, row in enumerate(lecture["rows"], 1):
            lines.append(f"| {row['minutes']} min | {row['show']} | **{k}.** {row['ask']} |")
        pages = [p for p in lecture["pages"] if lesson(self.root, f"book/{p}").questions]
        shown = f"*Check yourself* of {', '.join(f'{{doc}}`{page}`' for page in pages[-2:])}"
        return [*lines, f"| {QUIZ} min | {shown} | hands first, then somebody gives the reason |"]

    def answers(self, which: str, rows: list[dict]) -> list[str]:
        """The same questions with their answers, as a fold."""
        lines = ['<details class="answer">', f"<summary>Answers of {which}</summary>", ""]
        for k, row in enumerate(rows, 1):
            lines += [f"**{k}.** {row['ask']}", ""]
            for key, words in ANSWERS.items():
                text = f"{{open}}`{row[key]}`" if key == "open" else row[key]
                lines.append(f"- *{words}:* {text}")
            lines.append("")
        return [*lines, "</details>", ""]


class AtAGlance(LessonDirective):
    """``{lessons-at-a-glance}``."""

    def run(self):
        self.depends_on(self.root / "book" / "quizzes.yml", *chapters(self.root))
        rows = [("lesson", "to read", "Check yourself", "exercises (minutes)")]
        for of in walk(self.root):
            links = nodes.inline()
            for exercise in of.exercises:
                links += [nodes.Text(", ")] if len(links) else []
                links += [numbered(exercise, of), nodes.Text(f" ({exercise.minutes})")]
            quiz = nodes.reference(
                "",
                f"{len(of.questions)} questions",
                internal=True,
                refuri=f"{of.name}.html#check-yourself",
            )
            rows.append((title_of(self.env, of.name), time_to_read([of]), quiz, links))
        return [table(rows)]


class Differ(LessonDirective):
    """``{answers-that-differ}``."""

    def run(self):
        self.depends_on(self.root / "book" / "variants.yml", *chapters(self.root))
        rows = [("lesson", "exercises (different answers of the variants)")]
        for name, counts in entries(self.root, "variants")["differ"].items():
            of, links = lesson(self.root, f"book/{name}"), nodes.inline()
            for exercise, count in zip(of.exercises, counts.split(", "), strict=True):
                links += [nodes.Text(", ")] if len(links) else []
                links += [numbered(exercise, of), nodes.Text(f" ({count})")]
            rows.append((title_of(self.env, name), links))
        return [table(rows)]


def setup(app):
    for name, role in (
        ("section", Section), ("exercise", Exercises), ("open", Open), ("reading", Reading)
    ):  # fmt: skip
        app.add_role(name, role())
    for name, directive in (
        ("exercises", Listed), ("exercise-minutes", Minutes), ("objectives", Objectives),
        ("lecture", Lecture), ("lessons-at-a-glance", AtAGlance), ("answers-that-differ", Differ),
    ):  # fmt: skip
        app.add_directive(name, directive)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
