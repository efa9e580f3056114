"""The book's sources: stored without outputs, short cells, the same grid in every chapter."""

from __future__ import annotations

import nbformat
import pytest
from book_pages import BACK_MATTER, CHAPTERS, PAGES, source
from chapter_rules import (
    CHAPTER,
    EVERYWHERE,
    FROM_SCRATCH,
    LESSON,
    visible_code_teaches,
)

NOTEBOOKS = [page for page in PAGES if (path := source(page)) and path.suffix == ".ipynb"]


@pytest.fixture(scope="module")
def notebooks() -> dict:
    return {page: nbformat.read(source(page), as_version=4) for page in NOTEBOOKS}


@pytest.mark.parametrize("rule", (*EVERYWHERE, *CHAPTER, *LESSON), ids=lambda rule: rule.__name__)
def test_notebooks_keep_to_the_rule(rule, notebooks):
    lessons = sorted(FROM_SCRATCH)  # all of them, and the tutorial
    pages = lessons if rule in LESSON else CHAPTERS if rule in CHAPTER else NOTEBOOKS
    if rule is visible_code_teaches:
        pages = [page for page in pages if page not in FROM_SCRATCH]
    assert len(pages) >= 13
    assert not {page: wrong for page in pages if (wrong := rule(notebooks[page]))}


def test_every_page_has_one_source():
    paths = [source(page) for page in PAGES]
    assert not [page for page, path in zip(PAGES, paths) if path is None]
    assert not [p for p in paths if p.suffix == ".ipynb" and p.with_suffix(".md").exists()]
    assert {"book/notation", "book/glossary", "book/provenance"} <= set(BACK_MATTER)
