"""What a list of headings and a list of folds say: exercises are headings, each fold has a name.

In a notebook an exercise is a paragraph that begins with ``**2. Its title** (a derivation).``, and
its fold is called *Solution*. On the page it is a heading with the anchor ``exercise-2``, and the
fold is the *Solution of exercise 2*. A fold of code says to a screen reader what its code makes.
"""

from __future__ import annotations

import re
from html import escape

from docutils import nodes
from lessons import ON_YOUR_OWN, SOLUTION
from myst_nb.sphinx_ import HideCodeCellNode, depart_HideCellInput
from sphinx.transforms import SphinxTransform

FIRST = "Check yourself"  # what stands before the exercises, and so above them
NUMBER = re.compile(r"(\d+)\. ")
KIND = re.compile(r"\s*(\(an? \w+\))\.\s*")
NAMED = "\n"  # in a prompt: what stands after it is not seen


class Heading(nodes.rubric):
    """Of an exercise: no section of its own, so without a number and not in the contents."""


def visit_heading(translator, node):
    translator.body.append(translator.starttag(node, "h3", "", CLASS="rubric"))


def depart_heading(translator, node):
    translator.body.append("</h3>\n")


def first(node: nodes.Element) -> nodes.Node | None:
    """The first child that is no empty text; MyST puts one before what is strong."""
    while len(node) and isinstance(node[0], nodes.Text) and not node[0].strip():
        node.pop(0)
    return node[0] if len(node) else None


def heading(asked: nodes.paragraph, number: str) -> Heading:
    """Take title and kind out of an exercise's paragraph: its heading."""
    title = asked.pop(0)
    rest = asked[0] if len(asked) else None
    title.replace(first(title), nodes.Text(NUMBER.sub("", title[0].astext(), count=1)))
    words = [nodes.Text(f"Exercise {number}: "), *title.children]
    if isinstance(rest, nodes.Text):
        kind = KIND.match(rest)
        words += [nodes.Text(f" {kind[1]}")] if kind else []
        asked.replace(rest, nodes.Text(rest[kind.end() :] if kind else rest.lstrip(" .")))
    anchor = f"exercise-{number}"
    link = f'<a class="headerlink" href="#{anchor}" title="Link to this exercise">#</a>'
    words.append(nodes.raw("", link, format="html"))
    return Heading("", "", *words, ids=[anchor])


class HeadExercises(SphinxTransform):
    """Headings for exercises, and the numbers of these for their folds."""

    default_priority = 400

    def apply(self, **kwargs):
        for section in list(self.document.findall(nodes.section)):
            if section[0].astext() in (ON_YOUR_OWN, FIRST):
                self.head(section)

    def head(self, section: nodes.section):
        number = ""
        for node in list(section.children):
            title = first(node) if isinstance(node, nodes.paragraph) else None
            found = isinstance(title, nodes.strong) and NUMBER.match(title.astext())
            if found:
                number = found[1]
                section.insert(section.index(node), heading(node, number))
                if not node.astext().strip():
                    section.remove(node)
            elif number and isinstance(node, nodes.raw):
                summary = f"<summary>Solution of exercise {number}</summary>"
                text = node.astext().replace(SOLUTION, summary)
                node.replace_self(nodes.raw("", text, format="html"))
            elif number and "prompt_show" in node:
                for prompt in ("prompt_show", "prompt_hide"):
                    joint = " of" if node[prompt] == "The check" else ","
                    node[prompt] += f"{joint} exercise {number}"


class NameFolds(SphinxTransform):
    """Folds of code that look alike have the names of their figures, or of their sections."""

    default_priority = 410

    def apply(self, **kwargs):
        known = {}
        for cell in list(self.document.findall(nodes.container)):
            if "prompt_show" not in cell or "exercise" in cell["prompt_show"]:
                continue
            caption = next(iter(cell.findall(nodes.caption)), None)
            section = cell.parent
            while section is not None and not isinstance(section, nodes.section):
                section = section.parent
            above = caption or (section and section[0])
            name = re.split(r"(?<=\w)[.:?] ", above.astext(), maxsplit=1)[0] if above else ""
            known[name] = known.get(name, 0) + 1
            again = f", part {known[name]}" if known[name] > 1 else ""
            for prompt in ("prompt_show", "prompt_hide"):
                cell[prompt] += f"{NAMED}{' '.join(name.split())}{again}"


def visit_fold(translator, node):
    """As myst-nb does, with the part of the prompt that is not seen."""
    classes = " ".join(node["classes"])
    translator.body.append(f'<details class="admonition hide {classes}">\n<summary>\n')
    for state, prompt in (("collapsed", "prompt_show"), ("expanded", "prompt_hide")):
        seen, _, name = node[prompt].partition(NAMED)
        hidden = f'<span class="visually-hidden">: {escape(name)}</span>' if name else ""
        translator.body.append(f'<p class="{state} admonition-title">{escape(seen)}{hidden}</p>\n')
    translator.body.append("</summary>\n")


def setup(app):
    app.add_node(HideCodeCellNode, override=True, html=(visit_fold, depart_HideCellInput))
    app.add_node(Heading, html=(visit_heading, depart_heading))
    app.add_transform(HeadExercises)
    app.add_transform(NameFolds)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
