"""The search page: chapters before the package's reference, and excerpts that can be read."""

from __future__ import annotations

import re

import pytest
from book_pages import API, CHAPTERS

pytestmark = pytest.mark.browser

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


@pytest.mark.parametrize("word", WORDS)
def test_chapters_come_before_the_reference(word, built, visit):
    """From a folder, where a page cannot read others: titles only."""
    opened = visit((built / "search.html").as_uri() + f"?q={word}")
    found = [hit["page"] for hit in hits(opened)]
    reference = [k for k, page in enumerate(found) if page in API]
    chapters = [k for k, page in enumerate(found) if page in CHAPTERS]
    assert chapters and max(chapters) < min(reference, default=len(found))
    assert not opened.problems


def test_a_section_about_it_comes_first(built, visit):
    opened = visit((built / "search.html").as_uri() + "?q=friction")
    titles = [hit["title"] for hit in hits(opened) if hit["page"] in CHAPTERS]
    about = [title for title in titles if title.endswith("Friction")]
    assert about and about[0] in titles[:2]


@pytest.mark.parametrize("word", [*WORDS, "inertia"])
def test_excerpts_have_no_source(word, site, visit):
    opened = visit(f"{site}/search.html?q={word}")
    excerpts = [hit["excerpt"] for hit in hits(opened) if hit["page"] in CHAPTERS]
    assert any(word[:7] in excerpt.lower() for excerpt in excerpts)
    raw = re.compile(r"\\[a-zA-Z(\[]|\$|#%|\.ipynb|^\W*import ")
    assert not [excerpt for excerpt in excerpts if raw.search(excerpt)]
    assert not opened.problems
