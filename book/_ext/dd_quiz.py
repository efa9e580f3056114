"""Questions of understanding, as a section *Check yourself* before *On your own*.

They stand in `book/quizzes.yml`: by lesson, each with answers of which one is `right`, and with a
`why` for every answer. On the page they are native fieldsets whose explanations are a fold;
`_static/quiz.js` puts buttons to them. In readers' notebooks they are markdown.
"""

from __future__ import annotations

import json
from hashlib import sha1
from pathlib import Path

import yaml
from docutils import nodes
from sphinx.util.docutils import SphinxDirective

FILE = "book/quizzes.yml"
ON_YOUR_OWN = "On your own"  # the heading before which the section is put
OWN = f"## {ON_YOUR_OWN}\n"
HEADING = "## Check yourself"

# What is put before `OWN` when a page is read
CALL = f"{HEADING}\n\n```{{check-yourself}}\n```\n\n"


class Tag(nodes.General, nodes.TextElement):
    """An element of HTML; its attribute `tag` says which."""


class Unsearched(nodes.comment):
    """A question with its answers, which the search passes over like a comment.

    Else it would find what wrong answers say.
    """


def questions(root: Path, page: str) -> list[dict]:
    """The questions of a page like "book/dynamics".

    To what the file has of a question comes its `key`, and to each answer its `letter` and its
    `verdict`. Answers are in an order that depends on their words alone, so that it tells nothing.
    """
    path = root / FILE
    by_lesson = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return [
        {**each, "key": digest(each["question"]), "answers": lettered(each["answers"])}
        for each in by_lesson.get(page.rpartition("/")[2], ())
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


def with_markdown(source: str, root: Path, page: str) -> str:
    """A markdown cell of a reader's notebook: where it asks for own work, questions first."""
    asked = questions(root, page) if OWN in source else []
    parts = [HEADING] if asked else []
    for number, question in enumerate(asked, 1):
        answers = question["answers"]
        choices = "\n".join(f"- **{answer['letter']}.** {answer['text']}" for answer in answers)
        whys = "\n".join(f"- **{answer['verdict']}** {answer['why']}" for answer in answers)
        fold = f"<details>\n<summary>Answers</summary>\n\n{whys}\n\n</details>"
        parts += [f"**{number}.** {question['question']}", choices, fold]
    return source.replace(OWN, "\n\n".join([*parts, OWN]))


def call(app, page, text):
    """Put the directive before *On your own* of a notebook that has questions.

    Sphinx gives a page's source as a list of one text, to be changed in place.
    """
    if OWN.strip() not in text[0] or not questions(Path(app.srcdir), page):
        return
    if not app.env.doc2path(page).endswith(".ipynb"):
        return
    notebook = json.loads(text[0])
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = "".join(cell["source"]).replace(OWN, CALL + OWN)
    text[0] = json.dumps(notebook)


class CheckYourself(SphinxDirective):
    """``{check-yourself}``: the page's questions, each a form."""

    def run(self):
        root = Path(self.env.srcdir)
        self.env.note_dependency(str(root / FILE))
        return [self.made(*each) for each in enumerate(questions(root, self.env.docname), 1)]

    def made(self, number: int, one: dict) -> Tag:
        """The form of a question: a fieldset of choices, and a fold that says why."""
        choices = [
            self.words("label", answer["text"], f"{answer['letter']}.", ["choice"])
            for answer in one["answers"]
        ]
        whys = [
            self.words(
                "p",
                answer["why"],
                answer["verdict"],
                ["why", "right"] if answer.get("right", False) else ["why"],
            )
            for answer in one["answers"]
        ]
        legend = self.words("legend", one["question"])
        fields = Tag("", "", legend, *choices, tag="fieldset")
        summary = Tag("", "", nodes.Text(f"Answers to question {number}"), tag="summary")
        reasons = Tag("", "", *whys, tag="div", classes=["whys"])
        fold = Tag("", "", summary, reasons, tag="details", classes=["answer"])
        form_id = f"quiz-{one['key']}"
        inside = Unsearched("", "", fields, fold)
        return Tag("", "", inside, tag="form", classes=["quiz"], ids=[form_id])

    def words(self, tag: str, text: str, begin: str = "", classes=()) -> Tag:
        """An element with a line of markdown in it, after `begin` in bold."""
        inside, messages = self.state.inline_text(text.replace("'", "’"), self.lineno)
        first = [nodes.strong(text=begin), nodes.Text(" ")] if begin else []
        return Tag("", "", *first, *inside, *messages, tag=tag, classes=list(classes))


def visit(translator, node):
    translator.body.append(translator.starttag(node, node["tag"], ""))


def depart(translator, node):
    translator.body.append(f"</{node['tag']}>\n")


def passed(translator, node):
    """Write nothing for a node itself: what is in it is written as if it were not there."""


def load(app, page, template, context, doctree):
    """Script and style, on pages that need them."""
    if doctree is not None and any("quiz" in tag["classes"] for tag in doctree.findall(Tag)):
        app.add_js_file("quiz.js", loading_method="defer")
        app.add_css_file("quiz.css")


def setup(app):
    app.add_node(Tag, html=(visit, depart))
    app.add_node(Unsearched, html=(passed, passed))
    app.add_directive("check-yourself", CheckYourself)
    app.connect("source-read", call)
    app.connect("html-page-context", load)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
