"""Old addresses of whole pages: at each stands a page that leads to its successor.

The part after "#" goes along; `_static/moved.js` knows where old sections are now.
"""

from __future__ import annotations

from pathlib import Path

MOVED = {"book/why-smooth-filters": "book/whose-filters"}  # old: new, in the same folder


def page(new: str) -> str:
    """A page that leads to another one beside it, with script and without."""
    there = f"{new.rpartition('/')[2]}.html"
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Moved</title>'
        f'<link rel="canonical" href="{there}"><meta name="robots" content="noindex">'
        f'<script>location.replace("{there}" + location.hash)</script>'
        f'<noscript><meta http-equiv="refresh" content="0; url={there}"></noscript></head>'
        f'<body><p>This page is now <a href="{there}">here</a>.</p></body></html>\n'
    )


def write(app, exception):
    """Put the pages beside the others, once these are written."""
    if exception or app.builder.format != "html":
        return
    for old, new in MOVED.items():
        path = Path(app.outdir) / f"{old}.html"
        if path.parent.is_dir():
            path.write_text(page(new), encoding="utf-8")


def setup(app):
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
