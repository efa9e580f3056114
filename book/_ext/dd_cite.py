"""How to cite the book, from CITATION.cff, and what the footer of every page leads to.

The directive ``{citation}`` is an entry for BibTeX, of the book and of the report.
"""

from __future__ import annotations

from pathlib import Path

import yaml
from docutils import nodes
from sphinx.util.docutils import SphinxDirective

FILE = "CITATION.cff"
FOOTER = {
    "book/cite-reuse-report": "How to cite, reuse and report",
    "book/accessibility": "Accessibility",
}


def entry(kind: str, key: str, fields: dict[str, str]) -> str:
    """One for BibTeX."""
    lines = "".join(f"  {name} = {{{value}}},\n" for name, value in fields.items())
    return f"@{kind}{{{key},\n{lines}}}"


def people(authors: list[dict]) -> str:
    """Authors as BibTeX has them; a name of a group keeps its words together."""
    named = (
        f"{one['family-names']}, {one['given-names']}" if "family-names" in one
        else f"{{{one['name']}}}"
        for one in authors
    )  # fmt: skip
    return " and ".join(named)


def bibtex(root: Path) -> str:
    """The book, then what it refers to."""
    said = yaml.safe_load((root / FILE).read_text(encoding="utf-8"))
    year = str(said["date-released"])[:4]
    fields = {"author": people(said["authors"]), "title": f"{{{said['title']}}}", "year": year}
    found = [entry("misc", f"ddlib{year}", {**fields, "note": f"Version {said['version']}"})]
    for one in said["references"]:
        key = one["authors"][0]["family-names"] + str(one["year"])
        fields = {"author": people(one["authors"]), "title": f"{{{one['title']}}}"}
        fields |= {"institution": one["institution"]["name"], "number": one["number"]}
        found.append(entry("techreport", key, {**fields, "year": one["year"]}))
    return "\n\n".join(found)


class Citation(SphinxDirective):
    """``{citation}``."""

    def run(self):
        root = Path(self.env.srcdir)
        self.env.note_dependency(str(root / FILE))
        text = bibtex(root)
        return [nodes.literal_block(text, text, language="bibtex")]


def lead(app, page, template, context, doctree):
    """Links in the footer, to those of the pages that there are."""
    links = (
        f'<a href="{context["pathto"](name)}">{told}</a>'
        for name, told in FOOTER.items()
        if name in app.env.found_docs
    )
    context["theme_extra_footer"] = " · ".join(links)


def setup(app):
    app.add_directive("citation", Citation)
    app.connect("html-page-context", lead)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
