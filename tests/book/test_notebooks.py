"""The book's sources: stored without outputs, short cells, the same grid in every chapter."""

from __future__ import annotations

import re
from functools import lru_cache

import nbformat
import pytest
from book_pages import BACK_MATTER, CHAPTERS, PAGES, source
from bookkeeping import (
    ends_with_a_bare_value,
    lines_of_bookkeeping,
    only_imports,
    raw_prints,
    shows_something,
)

MAX_VISIBLE_LINES, MAX_VISIBLE_COLUMNS = 18, 84  # "about 15", and what a page has room for
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


# What is out of sight


def visible(page: str) -> list:
    """The code cells that stand open."""
    return [c for c in read(page).cells if c.cell_type == "code" and not tags(c) & HIDDEN]


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_visible_code_cells_are_short(page):
    def size(cell):
        lines = [line for line in cell.source.splitlines() if line.strip()]
        return len(lines), max(map(len, lines))

    sizes = {cell.id: size(cell) for cell in visible(page)}
    assert not {
        name: found
        for name, found in sizes.items()
        if found[0] > MAX_VISIBLE_LINES or found[1] > MAX_VISIBLE_COLUMNS
    }


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_no_visible_cell_has_a_line_of_bookkeeping(page):
    kept = {cell.id: lines_of_bookkeeping(cell.source) for cell in visible(page)}
    assert not {name: lines for name, lines in kept.items() if lines}


BOOKKEEPING = [
    "import numpy as np",
    "from ddlib.dynamics import Arm",
    "quote('name', x)",
    "assert x < 1",
    "np.testing.assert_allclose(x, y)",
    "alt = 'A line.'",
    "rows = []",
    "Table(('a', 'b'), zip(x, y))",
    "figures.curves(x, y)",
    "PIDTuner()",
    "table = results.read('table-4-1')",
    "print(f'{x:.2f} rad')",
    f"look(x, y, '{'word ' * 20}')",
]


@pytest.mark.parametrize("line", BOOKKEEPING)
def test_a_planted_line_of_bookkeeping_is_seen(line):
    teaching = "y = f(x)\n\n\ndef g(x):\n    'Twice as much.'\n    return 2 * x\n\n\n"
    assert lines_of_bookkeeping(teaching) == []
    (found,) = lines_of_bookkeeping(f"{teaching}{line}\n")
    inner = f"{teaching}for x in y:\n    if x:\n        {line}\n"
    assert found and lines_of_bookkeeping(inner) == [found]


def test_what_teaches_is_not_bookkeeping():
    long = f"def f(x):\n    '{'word ' * 20}'\n    return x"
    refused = "try:\n    f(-1)\nexcept ValueError as error:\n    print(error)"
    assert not any(map(lines_of_bookkeeping, (long, refused, "print(two.source)", "f(x, 'ramp')")))


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_no_fold_opens_onto_nothing(page):
    """A fold above nothing is a bar in the way; one for the imports of a recipe is allowed."""
    folds = [c for c in read(page).cells if tags(c) & {"hide-input", "hide-cell", "hide-output"}]
    silent = [c for c in folds if not shows_something(c.source)]
    recipes = [c for c in silent if page not in CHAPTERS and set(only_imports(c.source)) == {True}]
    assert len(recipes) <= 1
    assert not [c.id for c in silent if c not in recipes]


def test_empty_folds_are_seen():
    assert not any(map(shows_something, ("x = 1", "quote('a', 1)", "assert x", "import numpy")))
    assert all(map(shows_something, ("x", "if x:\n    print(x)\nassert x", "figures.hinton(x)")))


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_what_is_removed_shows_nothing(page):
    """`remove-cell` takes an output away, too, so such a cell has none."""
    removed = [c for c in read(page).cells if "remove-cell" in tags(c)]
    assert not [c.id for c in removed if shows_something(c.source)]


# Answers


def exercises(page: str) -> list:
    """The cells after the heading *On your own*, up to the next one and with it."""
    section, found = "", []
    for cell in read(page).cells:
        if section == "On your own":
            found.append(cell)
        if cell.cell_type == "markdown":
            section = ([section, *headings(cell.source, 2)])[-1]
    return found


def open_answer(text: str) -> str:
    """What a markdown cell says before its next question or heading, outside a closed fold."""
    before = re.split(r"^(?=\*\*\d+\. |## )", text, maxsplit=1, flags=re.M)[0]
    return re.sub(r"^<details .*?^</details>$", "", before, flags=re.M | re.S).strip()


@pytest.mark.parametrize("page", CHAPTERS)
def test_no_answer_stands_in_the_open(page):
    """On the page by a tag, in JupyterLab by its own metadata; words by an element for both."""
    cells = exercises(page)
    code = [cell for cell in cells if cell.cell_type == "code"]
    assert len(code) >= MIN_EXERCISES
    assert all("hide-cell" in tags(cell) for cell in code)
    folded = {"source_hidden": True, "outputs_hidden": True}
    assert all(cell.metadata.get("jupyter") == folded for cell in code)
    words = [cell for cell in cells if cell.cell_type == "markdown"]
    assert not [open_answer(cell.source) for cell in words if open_answer(cell.source)]


def test_open_answers_are_seen():
    fold = '<details class="answer">\n<summary>What it means</summary>\n\nIt is 5.\n\n</details>'
    assert not open_answer(f"{fold}\n\n**2. Next.** How many?")
    assert not open_answer("## Further reading\n\n- A book")
    assert open_answer("It is 5.\n\n**2. Next.** How many?") == "It is 5."
    assert open_answer(f"{fold}\n\nAnd 6.") == "And 6."


# Outputs


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_what_is_shown_is_a_sentence_or_a_table(page):
    code = [cell for cell in read(page).cells if cell.cell_type == "code"]
    raw = {cell.id: raw_prints(cell.source) for cell in code}
    assert not {name: prints for name, prints in raw.items() if prints}
    assert not [cell.id for cell in code if ends_with_a_bare_value(cell.source)]


def test_raw_outputs_are_seen():
    raw = ("print(x)", "print({1: 2})", "print('shape', x.shape)", "print(f'{x:.2f}')")
    assert all(map(raw_prints, raw))
    fine = ("print('It is so.')", "print(f'{x:.2f} rad')", "print('; '.join(y))", "print(a.source)")
    assert not any(map(raw_prints, fine))
    bare = ("x", "a.b", "x[0]", "x, y", "[f(a) for a in x]", "np.round(x, 3)", "x.max()", "2 * x")
    assert all(map(ends_with_a_bare_value, bare))
    shown = ("x = 1", "figures.hinton(x)", "Table(a, b)", "x = Tuner()\nx", "wall.tiles('x')")
    assert not any(map(ends_with_a_bare_value, shown))


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
        assert re.search(r"\*\*Time to run\*\* \{runtime\}`", opening), "not as measured"

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
