"""What excerpts of search results are taken from: the pages' prose as a script.

A page opened from a folder may not read other pages, and over a network each would have to come
whole. So the prose of all sections lies in one file, which `search-order.js` loads. Sentences that
bring no long word which the page has not had before are left out, as are tables, code and outputs:
compressed, it is below 100 kB. Formulas are dots.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from docutils import nodes
from sphinx import addnodes

FILE, CALL = "search-texts.js", "searchTexts("
SENTENCE = re.compile(r"(?<=[.?!:;]) ")  # the space between two sentences
FIRST = 2  # so many sentences of a section are kept in any case; on evidence pages one
WORD = re.compile(r"[^\W\d_]{8,}")  # a long word
STEM = 7  # words that begin with the same letters, so many, count as one

ELSEWHERE = re.compile(
    "paper-and-reproduction|further-reading"
    "|what-you-can-do-now|what-each-lesson-teaches|lecture-.*|a-class-on-one-lesson.*"
)
"""Sections whose sentences the ledger, the bibliography or the lessons have as well."""

OWN = (nodes.section, addnodes.desc, nodes.table, nodes.literal_block, nodes.citation)
"""What has an entry of its own, or is no prose."""


def prose(node: nodes.Node) -> str:
    """Words of a node, without `OWN`, titles, images and comments; formulas are dots."""
    if isinstance(node, (nodes.math, nodes.math_block)):
        return "… " if isinstance(node, nodes.math_block) else "…"
    if isinstance(node, nodes.Text):
        return str(node)
    if isinstance(node, (*OWN, nodes.title, nodes.comment, nodes.raw, nodes.image)):
        return ""
    inner = "".join(prose(child) for child in node.children)
    if isinstance(node, nodes.rubric):
        return f"{inner}. "
    return inner if isinstance(node, nodes.Inline) else f"{inner} "


def shortened(text: str, known: set[str], first: int = FIRST) -> str:
    """Text on one line: its first sentences, and those with a long word that is not known yet.

    Dots stand for what is left out. The stems of what is kept are added to `known`.
    """
    kept = []
    for k, sentence in enumerate(SENTENCE.split(" ".join(text.split()))):
        stems = {word[:STEM] for word in WORD.findall(sentence.lower())}
        if k < first or stems - known:
            kept.append(sentence)
            known |= stems
        elif kept[-1] != "…":
            kept.append("…")
    return " ".join(kept)


def texts_of(doctree: nodes.document, first: int = FIRST) -> dict[str, str]:
    """Text by anchor: of sections, and of what a glossary explains."""
    found = {}
    known = set()  # stems of the words that the page has had
    for section in doctree.findall(nodes.section):
        if ELSEWHERE.fullmatch(section["ids"][0]):
            continue
        inside = "".join(prose(child) for child in section.children)
        found[section["ids"][0]] = shortened(inside, known, first)
    for item in doctree.findall(nodes.definition_list_item):
        for anchor in (term_id for term in item.findall(nodes.term) for term_id in term["ids"]):
            found[anchor] = shortened("".join(map(prose, item.findall(nodes.definition))), known)
    for glossary in doctree.findall(addnodes.glossary):  # each term has a text, so its section none
        found.pop(glossary.parent["ids"][0], None)
    return {anchor: text for anchor, text in found.items() if text}


def gather(app, doctree, page):
    """Keep a page's texts in Sphinx's environment until `write`.

    That works in parallel builds, too: Sphinx resolves all pages in its main process, and only
    writes them in others.
    """
    texts = texts_of(doctree, 1 if page.startswith("book/evidence/") else FIRST)
    app.env.dd_search_texts = {**getattr(app.env, "dd_search_texts", {}), page: texts}


def write(app, exception):
    """Write the texts of all pages, as a call of the function of `search-order.js`.

    Those of pages that were not written again are in the file that there is.
    """
    if app.builder.format == "html" and exception is None:
        path = Path(app.outdir, "_static", FILE)
        texts = json.loads(path.read_text("utf-8")[len(CALL) : -2]) if path.is_file() else {}
        texts |= getattr(app.env, "dd_search_texts", {})
        kept = {page: texts[page] for page in sorted(texts) if page in app.env.found_docs}
        as_json = json.dumps(kept, ensure_ascii=False, separators=(",", ":"))
        path.write_text(f"{CALL}{as_json})\n", encoding="utf-8")


def setup(app):
    app.connect("doctree-resolved", gather, priority=900)
    app.connect("build-finished", write)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
