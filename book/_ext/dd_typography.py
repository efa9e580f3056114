"""What a typesetter does to prose: units stay with their numbers and have raised powers, minus is
no hyphen."""

from __future__ import annotations

import re

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms.post_transforms import SphinxPostTransform

NO_BREAK, MINUS, RAISED = "\u00a0", "\u2212", {"2": "²", "3": "³"}

UNITS = (
    "N m s/rad", "N m/rad", "N m", "(N m)² s", "kg m²", "kg", "mm", "ms", "µs", "mrad", "rad/s²",
    "rad/s³", "rad/s", "rad", "m/s²", "m/s", "m", "s", "min", "Hz", "kHz", "kB", "MB", "GiB", "px",
    "A", "dB", "%",
)  # fmt: skip
"""Units as the prose writes them."""

_UNIT = "|".join(map(re.escape, sorted(UNITS, key=len, reverse=True)))
_AFTER_NUMBER = re.compile(rf"(?<=\d) (?:{_UNIT})(?![\w/²³])")
_POWER = re.compile(r"(?<=\b[ms])\^([23])\b")
_HYPHEN = re.compile(r"(?<![^\s(\[,:;±≤≥<>=])-(?=\d)")

AS_WRITTEN = (
    nodes.literal, nodes.literal_block, nodes.math, nodes.math_block, nodes.raw, nodes.comment,
    addnodes.desc_signature, addnodes.desc_annotation,
)  # fmt: skip
"""Kinds of nodes that are not prose."""


def typeset(text: str, before: str = "") -> str:
    """The text with its numbers set; `before` is what stands before it on the line.

    Parameters
    ----------
    text, before : str
    """
    whole = _POWER.sub(lambda power: RAISED[power[1]], before + text)
    whole = _AFTER_NUMBER.sub(lambda unit: unit[0].replace(" ", NO_BREAK), whole)
    return _HYPHEN.sub(MINUS, whole)[len(before) :]


def blocks(node: nodes.Node):
    """Paragraphs, titles, captions and cells below a node, without those that are as written."""
    for child in node.children:
        if isinstance(child, AS_WRITTEN) or isinstance(child, nodes.Text):
            continue
        if isinstance(child, nodes.TextElement):
            yield child
        else:
            yield from blocks(child)


def prose(node: nodes.Node):
    """The pieces of a block in the order of reading: texts, and what stands between them."""
    for child in node.children:
        if isinstance(child, (nodes.Text, *AS_WRITTEN)):
            yield child
        else:
            yield from prose(child)


class SetNumbers(SphinxPostTransform):
    """`typeset` for every paragraph, title, caption and cell of a page."""

    default_priority = 900  # all references and values stand there by then
    formats = ("html",)

    def run(self, **kwargs):
        for block in blocks(self.document):
            before = ""
            for piece in list(prose(block)):
                if not isinstance(piece, nodes.Text):
                    before = "0" if isinstance(piece, nodes.math) else "x"
                    continue
                new = typeset(str(piece), before)
                before = (before + new)[-1:]
                if new != piece:
                    piece.parent.replace(piece, nodes.Text(new))


def setup(app):
    app.add_post_transform(SetNumbers)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
