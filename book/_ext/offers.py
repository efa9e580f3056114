"""What a site offers on its first page beside the pages: lessons that run, volumes to take along.

The page has an empty place for it. What is made after the pages (by `pdf.py`, `epub.py`, `live`)
fills that place anew, from the files that are there.
"""

from __future__ import annotations

from pathlib import Path

FIRST = "book/index.html"
PLACE = '<div id="offers">'
LIVE = "_static/live/live.js"
RUNS = (
    "<p>Lessons run where you read them. Press <em>Run this page</em> at the top of a lesson: your "
    "browser takes Python from this site, and what you write stays on your device.</p>"
)
FILES = {
    "walk.pdf": "the walk as a PDF",
    "evidence.pdf": "the evidence as a PDF",
    "book.epub": "the walk as an EPUB",
    "notebooks.zip": "all notebooks",
}


def offer(site: Path) -> None:
    """Say on the first page of a site what else is there."""
    page = site / FIRST
    text = page.read_text(encoding="utf-8")
    before, place, after = text.partition(PLACE)
    if not place:
        raise ValueError(f"{FIRST} has no place for offers: {PLACE}")
    after = after.partition("</div>")[2]
    page.write_text(f"{before}{PLACE}{offers(site)}</div>{after}", encoding="utf-8")


def offers(site: Path) -> str:
    """Paragraphs about what lies in a site; nothing of a site with pages and notebooks alone."""
    there = {name: words for name, words in FILES.items() if (site / name).is_file()}
    made = set(there) - {"notebooks.zip"}
    links = ", ".join(
        f'<a href="../{name}" download>{words}</a> ({(site / name).stat().st_size / 1e6:.0f} MB)'
        for name, words in there.items()
    )
    along = f"<p>You can take the book along: {links}.</p>" if made else ""
    return f"{RUNS if (site / LIVE).is_file() else ''}{along}"
