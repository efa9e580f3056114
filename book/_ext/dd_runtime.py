"""How long the notebooks of this build took, known once all have been executed.

The role ``{runtime}`words``` is a page's own time in prose, or the words where none was measured;
its paragraph is the grey line below the first picture. The directive ``{chapter-times}`` is a table
of all.
"""

from __future__ import annotations

from pathlib import Path

from docutils import nodes
from lessons import chapters
from myst_nb.sphinx_ import NbMetadataCollector
from sphinx.addnodes import pending_xref
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util.docutils import SphinxDirective

MEASURED = "on one core"


class RunTime(nodes.Inline, nodes.TextElement):
    """Stands for the time of its page."""


class ChapterTimes(nodes.General, nodes.Element):
    """Stands for the table."""


def chapter_times(env) -> dict[str, float]:
    """Pages with code, in the book's order, and the seconds their execution took, to a tenth.

    Rounded here, once: the table and the words of a page start from the same number.
    """
    data = NbMetadataCollector.get_doc_data(env)
    times = {page: data.get(page, {}).get("exec_data") or {} for page in env.collect_relations()}
    return {page: round(t["runtime"], 1) for page, t in times.items() if t.get("runtime")}


def spoken_time(seconds: float) -> str:
    """A time as prose has it, rounded."""
    if seconds < 1.5:
        return "about a second"
    if seconds < 90:
        return f"about {5 * round(seconds / 5) if seconds > 20 else round(seconds)} seconds"
    return f"about {seconds / 60:.0f} minutes"


def table(rows: list[tuple]) -> nodes.table:
    """A table of texts and nodes; the first row is its head."""
    lines = []
    for row in rows:
        cells = (cell if isinstance(cell, nodes.Node) else nodes.Text(cell) for cell in row)
        lines.append(nodes.row("", *(nodes.entry("", nodes.paragraph("", "", c)) for c in cells)))
    columns = [nodes.colspec(colwidth=1) for _ in rows[0]]
    parts = (nodes.thead("", lines[0]), nodes.tbody("", *lines[1:]))
    group = nodes.tgroup("", *columns, *parts, cols=len(columns))
    return nodes.table("", group, classes=["colwidths-auto"])


class InsertTimes(SphinxPostTransform):
    """Put the times where they belong; links in the table are resolved afterwards."""

    default_priority = 8

    def run(self, **kwargs):
        times = chapter_times(self.env)
        own = times.get(self.env.docname)
        for node in list(self.document.findall(RunTime)):
            words = node.astext() if own is None else f"{spoken_time(own)} {MEASURED}"
            if isinstance(node.parent, nodes.paragraph):
                node.parent["classes"].append("needs")
            node.replace_self(nodes.inline(text=words))
        for node in list(self.document.findall(ChapterTimes)):
            total = sum(times.values())
            rows = [
                (self.link(page), f"{s:.1f} s", f"{s / total:.0%}") for page, s in times.items()
            ]
            head = ("chapter", "time", "share")
            node.replace_self(table([head, *rows, ("all", f"{total:.0f} s", "100%")]))

    def link(self, page: str) -> pending_xref:
        title = self.env.titles[page].astext()
        target = dict(refdomain="std", reftype="doc", reftarget=f"/{page}", refexplicit=True)
        return pending_xref("", nodes.inline(text=title), refdoc=self.env.docname, **target)


class Directive(SphinxDirective):
    """``{chapter-times}``."""

    def run(self):
        for path in chapters(Path(self.env.srcdir)):
            self.env.note_dependency(str(path))
        return [ChapterTimes()]


def runtime(name, rawtext, text, lineno, inliner, options=None, content=None):
    """``{runtime}`words```."""
    return [RunTime(rawtext, text)], []


def setup(app):
    app.add_node(ChapterTimes)
    app.add_node(RunTime)
    app.add_directive("chapter-times", Directive)
    app.add_role("runtime", runtime)
    app.add_post_transform(InsertTimes)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
