"""The book's sources: stored without outputs, short cells, the same grid in every chapter."""

from __future__ import annotations

import re
from functools import lru_cache

import nbformat
import pytest
from book_pages import BACK_MATTER, CHAPTERS, PAGES, source

MAX_VISIBLE_LINES = 18  # "about 15", at the 84 columns that a page has room for
HIDDEN = {"hide-input", "hide-cell", "remove-input", "remove-cell"}
MAX_THESIS = 200  # characters
CLOSING = ["Paper and reproduction", "On your own", "Further reading"]
MIN_EXERCISES = 3

NOTEBOOKS = [page for page in PAGES if (path := source(page)) and path.suffix == ".ipynb"]


@lru_cache
def read(page: str):
    path = source(page)
    if path is None or path.suffix != ".ipynb":
        pytest.fail(f"{page}.ipynb does not exist")
    return nbformat.read(path, as_version=4)


def tags(cell) -> set[str]:
    return set(cell.metadata.get("tags", []))


def headings(text: str, level: int) -> list[str]:
    """Markdown headings of one level, without attributes in braces; code fences are skipped."""
    text = re.sub(r"^(`{3,}|:{3,}).*?^\1", "", text, flags=re.M | re.S)
    return re.findall(rf"^#{{{level}}} +(.*?) *(?:\{{.*\}})?$", text, flags=re.M)


@pytest.mark.parametrize("page", PAGES)
def test_page_has_one_source(page):
    path = source(page)
    assert path is not None, f"{page} is in _toc.yml but there is no such file"
    assert not (path.suffix == ".ipynb" and path.with_suffix(".md").exists())


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_notebook_is_valid_and_stripped(page):
    notebook = read(page)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not [cell.id for cell in code if cell.outputs or cell.execution_count is not None]
    assert notebook.metadata.kernelspec.name == "python3"
    assert "widgets" not in notebook.metadata


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_cell_ids_are_unique(page):
    ids = [cell.id for cell in read(page).cells]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_no_cell_is_empty(page):
    assert not [cell.id for cell in read(page).cells if not cell.source.strip()]


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_visible_code_cells_are_short(page):
    def lines(cell):
        return len([line for line in cell.source.splitlines() if line.strip()])

    shown = [c for c in read(page).cells if c.cell_type == "code" and not tags(c) & HIDDEN]
    assert not {cell.id: n for cell in shown if (n := lines(cell)) > MAX_VISIBLE_LINES}


@pytest.mark.parametrize("page", [page for page in NOTEBOOKS if page not in CHAPTERS])
def test_other_notebooks_have_a_title(page):
    first = read(page).cells[0]
    assert first.cell_type == "markdown"
    assert len(headings(first.source, 1)) == 1


@pytest.mark.parametrize("page", CHAPTERS)
class TestChapterGrid:
    def prose(self, page) -> str:
        return "\n\n".join(c.source for c in read(page).cells if c.cell_type == "markdown")

    def test_title_then_thesis(self, page):
        first = read(page).cells[0]
        assert first.cell_type == "markdown"
        title, thesis = re.split(r"\n\s*\n", first.source.strip())[:2]
        assert re.fullmatch(r"(\([\w-]+\)=\n)?# .+", title), "the first line is not the H1"
        assert not re.match(r"[#>`:|*-]+ |\*\*", thesis), "no thesis below the title"
        assert len(thesis) <= MAX_THESIS, "the thesis is longer than a line or two"
        assert len(headings(self.prose(page), 1)) == 1

    def test_opening(self, page):
        opening = self.prose(page).split("\n## ")[0]
        found = re.findall(r"\*\*(You will|You need|Time to run)\b", opening)
        assert found == ["You will", "You need", "Time to run"]

    def test_closing(self, page):
        assert headings(self.prose(page), 2)[-len(CLOSING) :] == CLOSING

    def test_exercises_have_solutions_that_run(self, page):
        section, solutions = "", 0
        for cell in read(page).cells:
            if cell.cell_type == "markdown":
                section = ([section, *headings(cell.source, 2)])[-1]
            elif section == "On your own":
                assert "hide-cell" in tags(cell), f"{cell.id}: tag a solution `hide-cell`"
                solutions += 1
        assert solutions >= MIN_EXERCISES


def test_back_matter_is_listed():
    assert {"book/notation", "book/glossary", "book/provenance"} <= set(BACK_MATTER)
