"""Evidence stands under its lesson in the contents: without numbers, and *Next* passes it by.

Its figures are numbered on from those of its lesson.
"""

from __future__ import annotations

from hashlib import sha1

from docutils import nodes

EVIDENCE = "book/evidence/"


def take_numbers_away(app, env):
    """From headings of evidence and their entries in the contents, once all are numbered."""
    for page, toc in env.tocs.items():
        if page.startswith(EVIDENCE):
            env.toc_secnumbers.pop(page, None)
            for entry in toc.findall(nodes.reference):
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


def setup(app):
    app.connect("env-get-updated", write_all, priority=900)  # when all are numbered
    app.connect("env-check-consistency", take_numbers_away)
    app.connect("html-page-context", lead_on)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
