"""The book's sources: stored without outputs, short cells, the same grid in every chapter."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import lru_cache

import nbformat
import pytest
from book_pages import BACK_MATTER, CHAPTERS, PAGES, source

MAX_VISIBLE_LINES = 18  # "about 15", at the 84 columns that a page has room for
HIDDEN = {"hide-input", "hide-cell", "remove-input", "remove-cell"}
MAX_BOOKKEEPING = 0.5  # share of a visible cell's statements
MAX_VISIBLE_TEXT = 60  # characters of a literal: longer ones are alternative texts
PROMPT, IMPORTS = "code_prompt_show", "Show the imports"
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


# What is out of sight


def statements(body: list[ast.stmt]) -> Iterator[ast.stmt]:
    """The statements of a cell, those within loops and conditions included."""
    for node in body:
        inner = getattr(node, "body", None)
        if inner and not isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            yield from statements(inner)
        else:
            yield node


def called(node: ast.stmt) -> str:
    """The function that a statement calls for its own sake, if it is one."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        return ast.unparse(node.value.func)
    return ""


def names_alt(node: ast.stmt) -> bool:
    return "alt" in map(ast.unparse, getattr(node, "targets", ()))


def is_bookkeeping(node: ast.stmt) -> bool:
    """Whether a statement imports, asserts, quotes a number or words an alternative text."""
    plain = isinstance(node, (ast.Import, ast.ImportFrom, ast.Assert))
    return plain or called(node) in {"quote", "glue"} or names_alt(node)


def long_texts(tree: ast.Module) -> list[str]:
    """Literals that are sentences, without docstrings."""
    bodies = (node.body[0] for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))
    docstrings = {id(first.value) for first in bodies if isinstance(first, ast.Expr)}
    literals = [node for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    texts = [n.value for n in literals if isinstance(n.value, str) and id(n) not in docstrings]
    return [text for text in texts if len(text) > MAX_VISIBLE_TEXT]


def should_be_hidden(code: str) -> bool:
    """Whether a cell keeps books rather than teaches."""
    tree = ast.parse(code)
    every = list(statements(tree.body))
    share = sum(map(is_bookkeeping, every)) / len(every)
    return share >= MAX_BOOKKEEPING or any(map(names_alt, every)) or bool(long_texts(tree))


def shows_something(code: str) -> bool:
    """Whether a cell has an output: it prints, or ends with a value."""
    *_, last = every = list(statements(ast.parse(code).body))
    silent = called(last) in {"quote", "glue"} or "assert_" in called(last)
    return "print" in map(called, every) or (isinstance(last, ast.Expr) and not silent)


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_bookkeeping_is_out_of_sight(page):
    shown = [c for c in read(page).cells if c.cell_type == "code" and not tags(c) & HIDDEN]
    assert not [cell.id for cell in shown if should_be_hidden(cell.source)]


@pytest.mark.parametrize(
    ("code", "hidden"),
    [
        ("import numpy as np", True),
        ("x = 1\nquote('name', x)", True),
        ("for k in range(3):\n    quote(f'name-{k}', k)", True),
        ("alt = 'A line.'\nx = f(2)\ny = g(x)\nfigures.curves(x, y, alt)", True),
        (f"figures.curves(x, y, '{'word ' * 20}')", True),
        ("y = f(x)\nz = g(y)\nquote('name', z)", False),
        (f"def f(x):\n    '{'word ' * 20}'\n    return x", False),
    ],
)
def test_bookkeeping_is_seen(code, hidden):
    assert should_be_hidden(code) is hidden


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_no_fold_opens_onto_nothing(page):
    """A fold without anything to show is a bar in the way; one for the imports is allowed."""
    folds = [c for c in read(page).cells if tags(c) & {"hide-input", "hide-cell", "hide-output"}]
    imports = [c for c in folds if c.metadata.get("mystnb", {}).get(PROMPT) == IMPORTS]
    assert len(imports) <= 1
    assert not [c.id for c in folds if c not in imports and not shows_something(c.source)]


def test_empty_folds_are_seen():
    assert not any(map(shows_something, ("x = 1", "quote('a', 1)", "assert x", "import numpy")))
    assert all(map(shows_something, ("x", "if x:\n    print(x)\nassert x", "figures.hinton(x)")))


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


def raw_prints(code: str) -> list[str]:
    """Calls of `print` that show values without a sentence around them."""

    def speaks(node: ast.expr) -> bool:
        if isinstance(node, ast.Constant):
            return isinstance(node.value, str)
        if isinstance(node, ast.JoinedStr):
            return any(
                isinstance(n, ast.Constant) and re.search("[a-z]", n.value) for n in node.values
            )
        if isinstance(node, ast.BinOp):
            return speaks(node.left) or speaks(node.right)
        # texts made elsewhere: a listing, a message, several sentences
        return (
            re.fullmatch(r"error|.*\.(source|text|join\(.*\))", ast.unparse(node), re.S) is not None
        )

    calls = (node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Call))
    prints = (node for node in calls if ast.unparse(node.func) == "print")
    return [ast.unparse(node) for node in prints if not all(map(speaks, node.args))]


@pytest.mark.parametrize("page", NOTEBOOKS)
def test_what_is_printed_is_a_sentence(page):
    code = [cell for cell in read(page).cells if cell.cell_type == "code"]
    assert not {cell.id: raw_prints(cell.source) for cell in code if raw_prints(cell.source)}


def test_raw_prints_are_seen():
    raw = ("print(x)", "print({1: 2})", "print('shape', x.shape)", "print(f'{x:.2f}')")
    assert all(map(raw_prints, raw))
    fine = ("print('It is so.')", "print(f'{x:.2f} rad')", "print('; '.join(y))", "print(a.source)")
    assert not any(map(raw_prints, fine))


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
