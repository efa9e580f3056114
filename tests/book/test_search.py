"""The search page: chapters before the package's reference, and excerpts that can be read."""

from __future__ import annotations

import re
from urllib.parse import unquote, urlsplit

import pytest
from book_pages import API, CHAPTERS

WORDS = ("friction", "momentum", "jerk", "inertia")

HITS = """() => [...document.querySelectorAll("#search-results li")].map((hit) => ({
  page: hit.querySelector("a").getAttribute("href").replace(/\\.html.*/, ""),
  title: hit.querySelector("a").innerText,
  excerpt: hit.querySelector("p.context")?.innerText ?? "",
}))"""

ELEMENTS = """() => [...document.querySelectorAll(
  "[src], object[data], link:is([rel~=stylesheet], [rel~=icon], [rel~=preload], [rel~=prefetch])",
)].map((el) => el.src || el.data || el.href)"""


def hits(opened) -> list[dict]:
    """What the search page lists, once it has listed all."""
    opened.page.wait_for_selector(".search-summary:not(:empty)", timeout=60_000)
    opened.page.wait_for_load_state("networkidle", timeout=60_000)
    return opened.page.evaluate(HITS)


def fetched(opened) -> list[str]:
    """Addresses of what the page has loaded.

    Firefox reports no files of a folder, but there only elements can load them.
    """
    reported = [response.url for response in opened.responses]
    return reported or opened.page.evaluate(ELEMENTS)


def below(root: str, url: str) -> str:
    """The part of an address after that of the site: where the site lies is not in it."""
    home, path = (unquote(urlsplit(address).path) for address in (root, url))
    assert path.startswith(f"{home}/"), url
    return path.removeprefix(home)


@pytest.mark.browser
@pytest.mark.parametrize("kind", ["file", "http"])
def test_chapters_come_before_the_reference_with_prose(kind, built, site, visit):
    """From a folder, too, where a page cannot read others."""
    root = built.as_uri() if kind == "file" else site
    raw = re.compile(r"\\[a-zA-Z(\[]|\$|#%|\.ipynb|^\W*import ")
    for word in WORDS if kind == "file" else WORDS[-1:]:
        opened = visit(f"{root}/search.html?q={word}")
        found = hits(opened)
        kinds = ["chapter" if hit["page"] in CHAPTERS else hit["page"] in API for hit in found]
        assert "chapter" in kinds and True not in kinds[: len(kinds) - kinds[::-1].index("chapter")]
        excerpts = [hit["excerpt"] for hit in found if hit["page"] in CHAPTERS]
        assert any(word[:7] in excerpt.lower() for excerpt in excerpts), word
        assert not [excerpt for excerpt in excerpts if raw.search(excerpt)]
        assert not opened.problems
        read = [below(root, url) for url in fetched(opened)]
        assert read and not [path for path in read if "/book/" in path]  # no page comes whole


@pytest.mark.browser
def test_a_section_about_it_and_the_glossary_by_its_words(built, visit):
    found = hits(visit((built / "search.html").as_uri() + "?q=friction"))
    titles = [hit["title"] for hit in found if hit["page"] in CHAPTERS]
    about = [title for title in titles if title.endswith("Friction")]
    assert about and about[0] in titles[:1]
    words = {hit["title"]: hit for hit in found if hit["page"] == "book/glossary"}
    assert {"Glossary > viscous friction", "Glossary > Coulomb friction"} <= set(words)
    assert len(words) == sum(hit["page"] == "book/glossary" for hit in found)
    assert any("proportional to velocity" in hit["excerpt"] for hit in words.values())
