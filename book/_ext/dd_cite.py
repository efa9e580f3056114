"""How to cite the book, from CITATION.cff, and what the footer of every page says.

The directive ``{citation}`` is an entry for BibTeX, of the book and of the report. The footer
leads to pages about the book; in a release it names the version, too, and links the newest.
"""

from __future__ import annotations

import html
import subprocess
from functools import cache
from pathlib import Path

import yaml
from dd_public import repository, site
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


def names(authors: list[dict]) -> list[str]:
    """Authors as one writes them."""
    return [a.get("name") or f"{a['given-names']} {a['family-names']}" for a in authors]


def people(authors: list[dict]) -> str:
    """Authors as BibTeX has them; a name of a group keeps its words together."""
    named = (
        f"{author['family-names']}, {author['given-names']}" if "family-names" in author
        else f"{{{author['name']}}}"
        for author in authors
    )  # fmt: skip
    return " and ".join(named)


def bibtex(root: Path) -> str:
    """The book, then what it refers to."""
    cited = yaml.safe_load((root / FILE).read_text(encoding="utf-8"))
    fields = {"author": people(cited["authors"]), "title": f"{{{cited['title']}}}"}
    if day := cited.get("date-released"):
        fields |= {"year": str(day)[:4], "note": f"Version {cited['version']}"}
    entries = [entry("misc", "ddlib", fields)]
    for reference in cited["references"]:
        key = reference["authors"][0]["family-names"] + str(reference["year"])
        fields = {"author": people(reference["authors"]), "title": f"{{{reference['title']}}}"}
        fields |= {"institution": reference["institution"]["name"], "number": reference["number"]}
        entries.append(entry("techreport", key, {**fields, "year": reference["year"]}))
    return "\n\n".join(entries)


class Citation(SphinxDirective):
    """``{citation}``."""

    def run(self):
        root = Path(self.env.srcdir)
        self.env.note_dependency(str(root / FILE))
        text = bibtex(root)
        return [nodes.literal_block(text, text, language="bibtex")]


@cache
def edition(root: Path) -> str:
    """Version and day of a release, as "1.2.0 of 2026-01-31"; nothing between two releases.

    A folder is a release if git has a tag of CITATION's version on what is checked out.
    """
    asked = ["git", "-C", str(root), "tag", "--points-at", "HEAD"]
    if not (root / FILE).is_file():  # a part of the book
        return ""
    try:
        tags = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.split()
    except OSError:  # no git here
        return ""
    cited = yaml.safe_load((root / FILE).read_text(encoding="utf-8"))
    released = f"v{cited.get('version')}" in tags
    return f"{cited['version']} of {cited['date-released']}" if released else ""


def version(root: Path, public: str) -> list[str]:
    """What the pages of a release say of it; `public` is the repository's name, or nothing."""
    if not (is_release := edition(root)):
        return []
    newest = f'. <a href="{html.escape(site(public))}">The newest version</a>' if public else ""
    return [f"This is version {is_release}{newest}"]


def lead(app, page, template, context, doctree):
    """The footer: which version this is, and links to those of the pages that there are."""
    links = (
        f'<a href="{context["pathto"](name)}">{words}</a>'
        for name, words in FOOTER.items()
        if name in app.env.found_docs
    )
    context["theme_extra_footer"] = " · ".join([*version(Path(app.srcdir), repository()), *links])


def setup(app):
    app.add_directive("citation", Citation)
    app.connect("html-page-context", lead)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
