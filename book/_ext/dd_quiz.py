"""What *Try it yourself* begins with: the questions of a lesson, *Check yourself*.

They come from the book's list, by `lessons.py`. A question is a native
fieldset whose explanations are a fold; `_static/quiz.js` puts buttons to it. In readers' notebooks
they are markdown. The page *Twelve questions* asks its own twice; `_static/twice.js` keeps count.
"""

from __future__ import annotations

import json
from pathlib import Path

from docutils import nodes
from lessons import OWN, Lesson, lesson, questions
from sphinx.util.docutils import SphinxDirective

HEADING = "### Check yourself"


class Tag(nodes.General, nodes.TextElement):
    """An element of HTML; its attribute `tag` says which."""


class Unsearched(nodes.comment):
    """A question with its answers, which the search passes over like a comment.

    Else it would find what wrong answers say.
    """


def with_questions(source: str, of: Lesson) -> str:
    """A markdown cell of a reader's notebook: where it asks for own work, the questions first."""
    if OWN not in source or not of.questions:
        return source
    parts = [OWN + "\n" + HEADING]
    for number, question in enumerate(of.questions, 1):
        answers = question["answers"]
        choices = "\n".join(f"- **{answer['letter']}.** {answer['text']}" for answer in answers)
        whys = "\n".join(f"- **{answer['verdict']}** {answer['why']}" for answer in answers)
        fold = f"<details>\n<summary>Answers</summary>\n\n{whys}\n\n</details>"
        parts += [f"**{number}.** {question['question']}", choices, fold]
    return source.replace(OWN, "\n\n".join(parts) + "\n")


def call(app, page, text):
    """Put the directive below *Try it yourself* of a lesson that has questions.

    Sphinx gives a page's source as a list of one text, to be changed in place.
    """
    of = lesson(Path(app.srcdir), page)
    if of is None:
        return
    path = of.root / "book" / "quizzes.yml"
    if path.is_file():  # a part of the book may lack it
        app.env.note_dependency(str(path))
    if of.questions:
        asked = f"{OWN}\n{HEADING}\n\n```{{check-yourself}}\n```\n"
        notebook = json.loads(text[0])
        for cell in notebook["cells"]:
            if cell["cell_type"] == "markdown":
                cell["source"] = "".join(cell["source"]).replace(OWN, asked)
        text[0] = json.dumps(notebook)


class CheckYourself(SphinxDirective):
    """``{check-yourself}``: the page's questions, each a form."""

    first = ""  # what a question begins with

    def run(self):
        asked = questions(Path(self.env.srcdir), self.env.docname)
        return [self.form(*numbered) for numbered in enumerate(asked, 1)]

    def form(self, number: int, question: dict) -> Tag:
        """The form of a question: a fieldset of choices, and a fold that says why."""
        choices = [
            self.words("label", answer["text"], f"{answer['letter']}.", ["choice"])
            for answer in question["answers"]
        ]
        whys = [
            self.words(
                "p",
                answer["why"],
                answer["verdict"],
                ["why", "right"] if answer.get("right", False) else ["why"],
            )
            for answer in question["answers"]
        ]
        legend = self.words("legend", question["question"], self.first.format(number))
        fields = Tag("", "", legend, *choices, tag="fieldset")
        form_id = f"quiz-{question['key']}"
        inside = Unsearched("", "", fields, self.reasons(number, question, whys))
        return Tag("", "", inside, tag="form", classes=["quiz"], ids=[form_id])

    def reasons(self, number: int, question: dict, whys: list[Tag]) -> Tag:
        """A fold that says why."""
        summary = Tag("", "", nodes.Text(f"Answers to question {number}"), tag="summary")
        reasons = Tag("", "", *whys, tag="div", classes=["whys"])
        return Tag("", "", summary, reasons, tag="details", classes=["answer"])

    def words(self, tag: str, text: str, begin: str = "", classes=()) -> Tag:
        """An element with a line of markdown in it, after `begin` in bold."""
        inside, messages = self.state.inline_text(text.replace("'", "’"), self.lineno)
        first = [nodes.strong(text=begin), nodes.Text(" ")] if begin else []
        return Tag("", "", *first, *inside, *messages, tag=tag, classes=list(classes))


class BeforeAndAfter(CheckYourself):
    """``{before-and-after}``: the page's questions, each a form that does not say what is right."""

    first = "{}."

    def run(self):
        return [Tag("", "", *super().run(), tag="div", classes=["twice"])]

    def reasons(self, number, question, whys):
        """What a page shows after the second time: a browser leaves it alone until then."""
        again = self.words("p", f"Read again: {{doc}}`{question['again']}`.")
        return Tag("", "", *whys, again, tag="template")


def visit(translator, node):
    translator.body.append(translator.starttag(node, node["tag"], ""))


def depart(translator, node):
    translator.body.append(f"</{node['tag']}>\n")


def passed(translator, node):
    """Write nothing for a node itself: what is in it is written as if it were not there."""


def load(app, page, template, context, doctree):
    """Script and style, on pages that need them."""
    tags = () if doctree is None else doctree.findall(Tag)
    classes = {name for tag in tags for name in tag["classes"]}
    if "quiz" in classes:
        app.add_js_file("twice.js" if "twice" in classes else "quiz.js", loading_method="defer")
        app.add_css_file("quiz.css")


def setup(app):
    app.add_node(Tag, html=(visit, depart))
    app.add_node(Unsearched, html=(passed, passed))
    app.add_directive("check-yourself", CheckYourself)
    app.add_directive("before-and-after", BeforeAndAfter)
    app.connect("source-read", call)
    app.connect("html-page-context", load)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
