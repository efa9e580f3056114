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
OWN = "## On your own\n"
HEADING = "## Check yourself"
CALL = f"{HEADING}\n\n```{{check-yourself}}\n```\n\n"


class Tag(nodes.General, nodes.TextElement):
    """An element of HTML, by its attribute `tag`."""


class Unsearched(nodes.comment):
    """Questions, with answers that are wrong, too: to the search they are what a comment is."""


def questions(root: Path, page: str) -> list[dict]:
    """The questions of a page like "book/dynamics".

    Their answers are in an order that hangs on the words alone, and begin with a letter.
    """
    path = root / FILE
    asked = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
    return [
        {**one, "key": digest(one["question"]), "answers": lettered(one["answers"])}
        for one in asked.get(page.rpartition("/")[2], ())
    ]


def digest(text: str) -> str:
    return sha1(text.encode()).hexdigest()[:8]


def lettered(answers: list[dict]) -> list[dict]:
    mixed = sorted(answers, key=lambda answer: digest(answer["text"]))
    return [
        {**answer, "letter": letter, "verdict": f"{letter} is {'right' if right else 'wrong'}."}
        for letter, answer in zip("ABCDE", mixed)
        for right in [answer.get("right", False)]
    ]


def with_markdown(source: str, root: Path, page: str) -> str:
    """A markdown cell of a reader's notebook: where it asks for own work, questions first."""
    asked = questions(root, page) if OWN in source else []
    parts = [HEADING] if asked else []
    for k, one in enumerate(asked, 1):
        choices, whys = (
            "\n".join(f"- **{answer[first]}{dot}** {answer[then]}" for answer in one["answers"])
            for first, dot, then in (("letter", ".", "text"), ("verdict", "", "why"))
        )
        fold = f"<details>\n<summary>Answers</summary>\n\n{whys}\n\n</details>"
        parts += [f"**{k}.** {one['question']}", choices, fold]
    return source.replace(OWN, "\n\n".join([*parts, OWN]))


def call(app, page, text):
    """Put the directive before *On your own* of a notebook that has questions."""
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
    """``{check-yourself}``."""

    def run(self):
        root = Path(self.env.srcdir)
        self.env.note_dependency(str(root / FILE))
        return [self.made(*each) for each in enumerate(questions(root, self.env.docname), 1)]

    def made(self, number: int, one: dict) -> Tag:
        choices = [
            self.words("label", answer["text"], f"{answer['letter']}.", ["choice"])
            for answer in one["answers"]
        ]
        whys = [
            self.words("p", a["why"], a["verdict"], ["why", *["right"] * a.get("right", False)])
            for a in one["answers"]
        ]
        legend = self.words("legend", one["question"])
        fields = Tag("", "", legend, *choices, tag="fieldset")
        summary = Tag("", "", nodes.Text(f"Answers to question {number}"), tag="summary")
        told = Tag("", "", *whys, tag="div", classes=["whys"])
        fold = Tag("", "", summary, told, tag="details", classes=["answer"])
        name = f"quiz-{one['key']}"
        inside = Unsearched("", "", fields, fold)
        return Tag("", "", inside, tag="form", classes=["quiz"], ids=[name])

    def words(self, tag: str, text: str, begin: str = "", classes=()) -> Tag:
        """An element with a line of markdown in it."""
        inside, messages = self.state.inline_text(text.replace("'", "’"), self.lineno)
        first = [nodes.strong(text=begin), nodes.Text(" ")] if begin else []
        return Tag("", "", *first, *inside, *messages, tag=tag, classes=list(classes))


def visit(translator, node):
    translator.body.append(translator.starttag(node, node["tag"], ""))


def depart(translator, node):
    translator.body.append(f"</{node['tag']}>\n")


def passed(translator, node):
    """It has no element of its own."""


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
