"""What a reader's page has of a notebook's code: pieces to read, and the rest out of sight.

What becomes of a code cell depends on its tag in the notebook:

- none: it stands open, and is marked as code to read (`to-read`)
- `hide-input`: plumbing, a fold that says how many lines it has
- `remove-cell`, `remove-input`: bookkeeping, out of sight, but on the page nevertheless: one
  switch, made by `_static/reading.js`, shows all code
- `hide-cell`: an answer, a fold of its own

Plumbing and bookkeeping are not searched.
"""

from __future__ import annotations

from docutils import nodes
from myst_nb import sphinx_ as myst_nb
from nbformat import NotebookNode
from sphinx.transforms.post_transforms import SphinxPostTransform

REMOVED = {
    "remove-cell": ("hide-input", "remove-output", "bookkeeping"),
    "remove-input": ("hide-input", "bookkeeping"),
    "hide-input": ("hide-input", "plumbing"),
}
"""By tag of a notebook's cell: the tags in its place on the page.

MyST-NB would leave out removed code. So it becomes a fold, and styles keep one that has the tag
`bookkeeping` out of sight until the switch shows it.
"""

READ = ("to-read",)
"""What the page adds to the tags of a cell that stands open."""


class Plumbing(nodes.comment):
    """Code that a reader has to ask for, plumbing or bookkeeping; the search passes over it."""


def page_tags(tags: list[str]) -> list[str]:
    """The tags that a code cell has on its page, by those that it has in the notebook."""
    for tag, instead in REMOVED.items():
        if tag in tags:
            return [*instead, *(other for other in tags if other not in REMOVED)]
    return list(tags) if "hide-cell" in tags else [*READ, *tags]


def lines(source: str) -> str:
    """How much code a cell hides, in words: "3 lines of code", without blank ones."""
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
        # What stands on the fold, closed and open
        prompts = {"code_prompt_show": prompt, "code_prompt_hide": prompt}
        metadata["mystnb"] = {**prompts, **metadata.get("mystnb", {})}
    return NotebookNode({**cell, "metadata": NotebookNode(metadata)})


class LeaveOutOfSearch(SphinxPostTransform):
    """Put `Plumbing` in place of the code of hidden cells: Sphinx does not index comments."""

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
    """Write it as any code is written."""
    translator.visit_literal_block(node)


# MyST-NB 1.4 looks a notebook up in the cache by its cells and their tags, so it cannot be given
# other tags before: they change between the cache and the parser. Without this, pages show all
# bookkeeping, and say of no fold how long it is.
notebook_to_tokens = myst_nb.notebook_to_tokens


def tokens(notebook, *rest):
    """What MyST-NB makes of a notebook, with its cells as on the page."""
    cells = [as_on_the_page(cell) for cell in notebook.cells]
    return notebook_to_tokens(NotebookNode({**notebook, "cells": cells}), *rest)


def setup(app):
    myst_nb.notebook_to_tokens = tokens
    app.add_node(Plumbing, html=(visit, None))
    app.add_post_transform(LeaveOutOfSearch)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
