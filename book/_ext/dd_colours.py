"""``{colours}``: the legend of the book, a table of the roles that colours have in all figures."""

from __future__ import annotations

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective

from ddlib.figures import MEANINGS, Illustration, illustrate, looks


class Colours(SphinxDirective):
    """A row for each role: how it is drawn, and what it means."""

    def run(self):
        table = nodes.table(classes=["colours"])
        group = nodes.tgroup("", *(nodes.colspec(colwidth=w) for w in (1, 3)), cols=2)
        head = nodes.row("", *(nodes.entry("", nodes.paragraph("", w)) for w in ("drawn", "means")))
        rows = [self.row(role, meaning) for role, meaning in MEANINGS.items()]
        table += group
        group += [nodes.thead("", head), nodes.tbody("", *rows)]
        return [table]

    def row(self, role: str, meaning: str) -> nodes.row:
        words = nodes.entry()
        lines = StringList([f"**{role}**: {meaning}"], self.get_source_info()[0])
        self.state.nested_parse(lines, self.content_offset, words)
        return nodes.row("", nodes.entry("", nodes.raw("", sample(role).svg, format="html")), words)


def sample(role: str) -> Illustration:
    """A line and a patch of a role, as figures draw them."""
    look = looks([role])[role]

    def draw(figure):
        axis = figure.subplots()
        axis.plot([0, 6], [0, 0], lw=2.2, **look.line)
        axis.barh(0, 3, 0.8, 7, color=look.colour)
        axis.set(xlim=(0, 10), ylim=(-0.6, 0.6))
        axis.axis("off")

    return illustrate(draw, f"A line and a patch: {role}.", 1.4, 0.22)


def setup(app):
    app.add_directive("colours", Colours)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
