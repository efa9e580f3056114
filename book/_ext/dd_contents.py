"""The lessons of the walk alone have numbers, and a strip of dots below their titles.

Figures of all pages are numbered: in optional parts of the contents as those of a chapter, on a
page of evidence on from those of its lesson. *Next* passes evidence by.
"""

from __future__ import annotations

from hashlib import sha1
from html import escape
from pathlib import Path

from docutils import nodes
from lessons import walk

EVIDENCE = "book/evidence/"
TITLE_ENDS = "</h1>"


def take_numbers_away(app, env):
    """From headings beside the walk and their entries in the contents, once all are numbered."""
    numbered = {of.page for of in walk(Path(env.srcdir))}
    for page, toc in env.tocs.items():
        if page not in numbered:
            env.toc_secnumbers.pop(page, None)
            for entry in (env.titles[page], *toc.findall(nodes.reference)):
                entry.attributes.pop("secnumber", None)


def write_all(app, env):
    """Titles and numbers stand on other pages, too: if one changed, all pages are written anew."""
    numbers = env.toc_secnumbers, env.toc_fignumbers
    shown = [
        (page, env.titles[page].astext(), *(kind.get(page) for kind in numbers))
        for page in sorted(env.found_docs)
    ]
    key = sha1(repr(shown).encode()).hexdigest()
    before, env.dd_shown = getattr(env, "dd_shown", ""), key
    return env.found_docs if before != key else ()


def neighbours(pages: list[str], page: str) -> tuple[str | None, str | None]:
    """The pages before and after one. From evidence both lead to lessons: its own, and the next."""
    at = pages.index(page)
    before = next((p for p in reversed(pages[:at]) if not p.startswith(EVIDENCE)), None)
    after = next((p for p in pages[at + 1 :] if not p.startswith(EVIDENCE)), None)
    return before, after


def lead_on(app, page, template, context, doctree):
    """Set *Previous* and *Next*; the theme draws them."""
    pages = list(app.env.collect_relations())
    if page not in pages:
        return
    for way, other in zip(("prev", "next"), neighbours(pages, page)):
        if other and context.get(way):
            title = app.env.titles[other]
            text = app.builder.render_partial(title)["title"]
            context[way] = {"link": app.builder.get_relative_uri(page, other), "title": text}


def dots(pages: dict[str, str], here: str) -> str:
    """Where one is in the walk, as links: titles by address; `here` is the address of the page."""
    items = []
    for k, (link, title) in enumerate(pages.items(), 1):
        name = f"Lesson {k}: {escape(title)}"
        at = ' aria-current="page"' if link == here else ""
        inside = f'<a href="{link}" title="{name}"{at}><span>{name}</span></a>'
        items.append(f"<li>{inside}</li>")
    place = f"<span>{list(pages).index(here) + 1} of {len(pages)}</span>"
    return f'<nav class="walk" aria-label="The walk">{place}<ol>{"".join(items)}</ol></nav>'


def show_place(app, page, template, context, doctree):
    """Put the dots below the title of a lesson of the walk."""
    walked = [of.page for of in walk(Path(app.srcdir))]
    if page in walked:
        link = {other: app.builder.get_relative_uri(page, other) or "#" for other in walked}
        titles = {link[other]: app.env.titles[other].astext() for other in walked}
        strip = dots(titles, link[page])
        context["body"] = context["body"].replace(TITLE_ENDS, TITLE_ENDS + strip, 1)


def setup(app):
    app.connect("env-get-updated", write_all, priority=900)  # when all are numbered
    app.connect("env-check-consistency", take_numbers_away)
    app.connect("html-page-context", lead_on)
    app.connect("html-page-context", show_place)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
