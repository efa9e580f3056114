"""What a reader's page has of a notebook's code: pieces to read, and plumbing out of sight.

A cell without a tag stands open and is marked as code to read. `hide-input` is a fold that says
how many lines it has. What the tags remove (`remove-cell`, `remove-input`) is not seen either, but
it is on the page: one switch, made by `_static/reading.js`, shows all code. Answers (`hide-cell`)
are folds of their own. Plumbing is not searched.
"""

from __future__ import annotations

import patches
from docutils import nodes
from nbformat import NotebookNode
from sphinx.transforms.post_transforms import SphinxPostTransform

REMOVED = {
    "remove-cell": ("hide-input", "remove-output", "bookkeeping"),
    "remove-input": ("hide-input", "bookkeeping"),
    "hide-input": ("hide-input", "plumbing"),
}
"""By tag: the tags that it has on the page. `bookkeeping` shows by the switch alone."""

READ = ("to-read",)


class Plumbing(nodes.comment):
    """Code that a reader has to ask for; to the search it is what a comment is."""


def page_tags(tags: list[str]) -> list[str]:
    """The tags of a code cell as its page has them.

    Parameters
    ----------
    tags : list of str
        Those of the notebook's cell.
    """
    for tag, instead in REMOVED.items():
        if tag in tags:
            return [*instead, *(other for other in tags if other not in REMOVED)]
    return list(tags) if "hide-cell" in tags else [*READ, *tags]


def lines(source: str) -> str:
    """How much code a cell hides, in words."""
    count = len([line for line in source.splitlines() if line.strip()])
    return f"{count} line{'s' * (count != 1)} of code"


def as_on_the_page(cell: NotebookNode) -> NotebookNode:
    """A cell with the tags and the prompt of its page; markdown as it is."""
    if cell.cell_type != "code":
        return cell
    metadata = dict(cell.metadata)
    metadata["tags"] = page_tags(metadata.get("tags", []))
    if "hide-input" in metadata["tags"]:
        prompt = lines(cell.source)
        prompts = {"code_prompt_show": prompt, "code_prompt_hide": prompt}
        metadata["mystnb"] = {**prompts, **metadata.get("mystnb", {})}
    return NotebookNode({**cell, "metadata": NotebookNode(metadata)})


class LeaveOutOfSearch(SphinxPostTransform):
    """Plumbing in another kind of node, for HTML."""

    default_priority = 190
    formats = ("html",)

    def run(self, **kwargs):
        for cell in self.document.findall(nodes.container):
            if {"tag_bookkeeping", "tag_plumbing"} & set(cell.get("classes", ())):
                for code in list(cell.findall(nodes.literal_block)):
                    if "cell_input" in code.parent.get("classes", ()):
                        plumbing = Plumbing(code.rawsource, code.astext(), **code.attributes)
                        code.replace_self(plumbing)


def visit(translator, node):
    translator.visit_literal_block(node)


def setup(app):
    patches.parse_cells_as(as_on_the_page)
    app.add_node(Plumbing, html=(visit, None))
    app.add_post_transform(LeaveOutOfSearch)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
