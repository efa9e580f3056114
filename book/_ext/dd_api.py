"""The API pages: no field twice, no private type, constants in short; source beside measures.

Every claim leads to the lines that measure it. A page for every other module as well would take
more time than all chapters' pages together.
"""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass

from docutils import nodes
from sphinx import addnodes
from sphinx.pycode import ModuleAnalyzer

SHOWN = (
    "workshop.report.measures",
    "workshop.chapters",
    "workshop.report.evidence.expressions",
    "beyond.measures",
    "beyond.chapters",
)
"""Packages and modules whose source has pages."""


def skip_field(app, what, name, obj, skip, options):
    """Whether autodoc leaves a member out; None where it decides by itself."""
    return True if type(obj).__name__ == "_tuplegetter" else None


PRIVATE = re.compile(r"(?<![\w\"'])_[A-Za-z]\w*")


def forget_types(app, what, name, obj, options, signature, returned):
    """Of the types that autodoc lists below a class or function, leave out what says nothing.

    That are a dataclass's fields, which have an entry each with type and text, and names that a
    reader cannot look up.
    """
    types = app.env.temp_data.get("annotations", {}).get(name, {})
    own = set()
    if isinstance(obj, type) and is_dataclass(obj):
        texts = ModuleAnalyzer.for_module(obj.__module__).find_attr_docs()
        own = {field.name for field in fields(obj) if (obj.__qualname__, field.name) in texts}
    for key in [key for key, kind in types.items() if key in own or PRIVATE.search(kind)]:
        del types[key]


COLON = "\u2236"
"""Stands for a colon while napoleon looks for one."""


def hide_colon(app, what, name, obj, options, lines):
    """What the docstring of a value says before a colon is no type, as napoleon has it."""
    if what in ("data", "attribute"):
        lines[:1] = [line.replace(":", COLON) for line in lines[:1]]


def show_colon(app, what, name, obj, options, lines):
    """After napoleon."""
    lines[:] = [line.replace(COLON, ":") for line in lines]


LONGEST = 160
"""Letters of a constant's value that a page shows."""


def shorten_values(app, doctree):
    """Of a longer value the beginning is shown, without names of private types."""
    for node in doctree.findall(addnodes.desc_annotation):
        value = node.astext().strip()
        short = re.sub(rf"{PRIVATE.pattern}\(", "(", value)
        if len(short) > LONGEST:
            short = f"{short[:LONGEST].rpartition(' ')[0]} …"
        if value.startswith("= ") and short != value:
            node.clear()
            node += nodes.Text(f" {short}")


def leave_sources(app, doctree):
    """Name no module to `sphinx.ext.viewcode`, which comes next, whose source has no page."""
    for signature in doctree.findall(addnodes.desc_signature):
        if not (signature.get("module") or "").startswith(SHOWN):
            signature["module"] = ""


def setup(app):
    app.connect("autodoc-skip-member", skip_field)
    app.connect("autodoc-process-signature", forget_types, priority=900)
    app.connect("autodoc-process-docstring", hide_colon, priority=100)
    app.connect("autodoc-process-docstring", show_colon, priority=900)
    app.connect("doctree-read", shorten_values)
    app.connect("doctree-read", leave_sources, priority=400)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
