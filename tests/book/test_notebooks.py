"""The book's sources: stored without outputs, short cells, the same grid in every chapter."""

from __future__ import annotations

from copy import deepcopy

import nbformat
import pytest
from book_pages import BACK_MATTER, CHAPTERS, PAGES, source
from bookkeeping import ends_with_a_bare_value, lines_of_bookkeeping, shows_something
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


BOOKKEEPING = (
    "import numpy as np",
    "quote('name', x)",
    "assert x < 1",
    "alt = 'A line.'",
    "Table(('a', 'b'), zip(x, y))",
    "figures.curves(x, y)",
    "PIDTuner()",
    "table = results.read('table-4-1')",
    "print(f'{x:.2f} rad')",
)


def test_a_planted_line_of_bookkeeping_is_seen():
    teaching = "y = f(x)\n\n\ndef g(x):\n    'Twice as much.'\n    return 2 * x\n\n\n"
    assert lines_of_bookkeeping(teaching) == []
    for line in BOOKKEEPING:
        assert lines_of_bookkeeping(f"{teaching}for x in y:\n    {line}\n"), line


def test_another_order_of_a_lesson_is_seen(notebooks):
    lesson = deepcopy(notebooks["book/hinton-diagrams"])
    cells = lesson.cells
    promise = next(k for k, cell in enumerate(cells) if "**You will**" in cell.source)
    (first,) = [k for k in range(promise) if "hide-input" in cells[k].metadata.get("tags", [])]

    def against() -> set[str]:
        return {rule.__name__ for rule in LESSON if rule(lesson)}

    assert not against()
    result = cells.pop(first)
    assert against() == {"result_stands_first"}
    cells.insert(first, result)
    cells[0].source += "\n\n**The question.** Which?"
    assert against() == {"title_and_thesis_stand_alone"}
    cells[promise].source += "\n\nThe answer first."
    assert against() == {"title_and_thesis_stand_alone", "three_lines_follow"}


def test_outputs_are_seen():
    assert not any(map(shows_something, ("x = 1", "quote('a', 1)", "assert x", "import numpy")))
    assert all(map(shows_something, ("x", "if x:\n    print(x)\nassert x", "figures.hinton(x)")))
    bare = ("x", "a.b", "x[0]", "x, y", "[f(a) for a in x]", "np.round(x, 3)", "x.max()", "2 * x")
    assert all(map(ends_with_a_bare_value, bare))
    shown = ("x = 1", "figures.hinton(x)", "Table(a, b)", "x = Tuner()\nx", "wall.tiles('x')")
    assert not any(map(ends_with_a_bare_value, shown))
