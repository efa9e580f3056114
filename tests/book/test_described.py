"""Alternative texts of the figures that open code makes: they say what is seen."""

from __future__ import annotations

import json

import pytest
from book_pages import CHAPTERS, source

FEWEST = 20  # words
HIDDEN = {"hide-input", "remove-input", "remove-cell"}
PAGES = [page for page in [*CHAPTERS, "book/use-it-on-your-arm"] if source(page)]


def open_figures(page: str) -> list[dict]:
    """What metadata say of the figures whose code stands open."""
    cells = json.loads(source(page).read_text(encoding="utf-8"))["cells"]
    told = [(cell["metadata"].get("mystnb", {}).get("figure"), cell["metadata"]) for cell in cells]
    return [one for one, data in told if one and not HIDDEN & set(data.get("tags", ()))]


def test_every_figure_has_a_text_of_its_own():
    texts = [one["alt"] for page in PAGES for one in open_figures(page)]
    assert len(set(texts)) == len(texts) > 50
    assert not [text for text in texts if len(text.split()) < FEWEST]


@pytest.mark.built
def test_pages_have_the_words(parsed):
    for page in PAGES:
        for one in open_figures(page):
            forms = parsed(page).find(id=one["name"]).select('svg[role="figure"]')
            assert forms and all(one["alt"] in form["aria-label"] for form in forms), one["name"]
