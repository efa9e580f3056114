"""The search page: chapters before the package's reference, and excerpts that can be read."""

from __future__ import annotations

import gzip
import re
import sys

import pytest
from book_pages import API, CHAPTERS, ROOT
from docutils.core import publish_doctree

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_search

browser_test = pytest.mark.browser

WORDS = ("friction", "overfitting", "jerk")

HITS = """() => [...document.querySelectorAll("#search-results li")].map((hit) => ({
  page: hit.querySelector("a").getAttribute("href").replace(/\\.html.*/, ""),
  title: hit.querySelector("a").innerText,
  excerpt: hit.querySelector("p.context")?.innerText ?? "",
}))"""


def hits(opened) -> list[dict]:
    """What the search page lists, once it has listed all."""
    opened.page.wait_for_selector(".search-summary:not(:empty)", timeout=60_000)
    opened.page.wait_for_load_state("networkidle", timeout=60_000)
    return opened.page.evaluate(HITS)


@browser_test
@pytest.mark.parametrize("word", WORDS)
def test_chapters_come_before_the_reference(word, built, visit):
    opened = visit((built / "search.html").as_uri() + f"?q={word}")
    found = [hit["page"] for hit in hits(opened)]
    reference = [k for k, page in enumerate(found) if page in API]
    chapters = [k for k, page in enumerate(found) if page in CHAPTERS]
    assert chapters and max(chapters) < min(reference, default=len(found))
    assert not opened.problems


@browser_test
def test_a_section_about_it_comes_first(built, visit):
    opened = visit((built / "search.html").as_uri() + "?q=friction")
    titles = [hit["title"] for hit in hits(opened) if hit["page"] in CHAPTERS]
    about = [title for title in titles if title.endswith("Friction")]
    assert about and about[0] in titles[:2]


@browser_test
@pytest.mark.parametrize("kind", ["file", "http"])
@pytest.mark.parametrize("word", [*WORDS, "inertia"])
def test_excerpts_have_no_source(word, kind, built, site, visit):
    """From a folder, too, where a page cannot read others."""
    root = built.as_uri() if kind == "file" else site
    opened = visit(f"{root}/search.html?q={word}")
    excerpts = [hit["excerpt"] for hit in hits(opened) if hit["page"] in CHAPTERS]
    assert any(word[:7] in excerpt.lower() for excerpt in excerpts)
    raw = re.compile(r"\\[a-zA-Z(\[]|\$|#%|\.ipynb|^\W*import ")
    assert not [excerpt for excerpt in excerpts if raw.search(excerpt)]
    assert not opened.problems
    assert not [r.url for r in opened.responses if "/book/" in r.url]  # no page comes whole


@browser_test
def test_the_glossary_is_listed_by_its_words(built, visit):
    opened = visit((built / "search.html").as_uri() + "?q=friction")
    found = hits(opened)
    words = [hit for hit in found if hit["page"] == "book/glossary"]
    titles = {"Glossary > viscous friction", "Glossary > Coulomb friction"}
    assert titles <= {hit["title"] for hit in words}
    assert len({hit["title"] for hit in words}) == len(words) and "Glossary" not in words
    assert any("proportional to velocity" in hit["excerpt"] for hit in words)


@browser_test
def test_a_module_of_the_package_is_listed_once(built, visit):
    """Sphinx finds its section and the module itself, at one place."""
    opened = visit((built / "search.html").as_uri() + "?q=regressor")
    hits(opened)
    links = "[...document.querySelectorAll('#search-results li a')].map((a) => a.hash)"
    assert (
        opened.page.evaluate(links).count("#module-workshop.beyond.control.adaptive.regressor") == 1
    )
    assert not opened.problems


@pytest.mark.built
def test_the_texts_of_the_search_are_light(built):
    texts = (built / "_static" / dd_search.FILE).read_bytes()
    assert 30_000 < len(gzip.compress(texts, 6)) < 100_000


PAGE = """
Arms
====

An arm of mass :math:`m_1` *moves*.

.. code::

   import arm

Friction
--------

It brakes.

+------+
| cell |
+------+
"""


def test_texts_are_prose_by_section():
    texts = dd_search.texts_of(publish_doctree(PAGE, settings_overrides={"doctitle_xform": False}))
    assert texts == {"arms": "An arm of mass … moves.", "friction": "It brakes."}


def test_no_long_word_of_a_page_is_lost():
    known = set()
    first = dd_search.shortened("Here. There. It oscillates. So.", known)
    assert first == "Here. There. It oscillates. …"
    again = dd_search.shortened("One. Two. No oscillation. None. Saturated?", known)
    assert again == "One. Two. … Saturated?"
