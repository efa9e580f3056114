"""*Run this page*: which cells of a lesson run in the page, with which handles and solutions."""

import ast
import html
import re

import nbformat
import pytest
from book_pages import WALK
from chapter_rules import CHANGE_THIS, is_check, is_starter, tags, visible
from live.cells import imported, live_cells, needs
from live.handles import handles
from live.packages import Refused
from live.pages import live_page
from live_pages import plain
from open_cells import lesson


@pytest.mark.parametrize("page", WALK)
def test_a_lesson_becomes_live(page):
    notebook = lesson(page)
    shown, cells = visible(notebook), live_cells(notebook)
    wanted = [cell for cell in notebook.cells if cell in shown or is_check(cell)]
    assert [cell["kind"] == "answer" for cell in cells] == [is_starter(cell) for cell in wanted]
    assert not any(cell["needs"] for cell in cells)  # all of a lesson runs in the page
    for cell in cells:
        if cell["kind"] == "answer":
            assert "mine =" in cell["solution"] and "mine" in cell["solves"]["writes"]
    marked = live_page(plain(page), notebook, page, [1, 2], [page], {})
    pairs = re.findall(r'data-live="([^"]+)".*?<pre>(.*?)</pre>', marked, re.S)
    code = [(name, html.unescape(text)) for name, text in pairs]
    assert code == [(cell.id, cell.source) for cell in wanted]
    assert marked.index("follow.js") < marked.index("live.js")
    with pytest.raises(Refused, match="make book first"):
        live_page(plain(page)[:-900], notebook, page, [1, 2], [page], {})


def test_packages_come_in_the_order_in_which_cells_import_them():
    packages = {
        name: {"imports": [name], "depends": depends}
        for name, depends in (
            ("numpy", []),
            ("scipy", ["numpy"]),
            ("control", ["scipy", "matplotlib"]),
            ("matplotlib", ["numpy"]),
            ("sympy", []),
            ("yaml", []),
        )
    }
    sources = (
        "import numpy as np",
        "from ddlib import figures\nimport control as ct, os",
        "import sympy",
    )
    cells = [{"source": source} for source in sources]
    assert imported(cells, packages) == ["matplotlib", "scipy", "control", "sympy", "yaml"]


def test_what_a_page_lacks_of_pytorch_is_named():
    known = {}
    assert needs("import torch as t\nfrom torch import nn\nt.zeros(3)", known) == ""
    assert needs("nn.Conv1d(2, 3, 5)(t.fft.rfft(x))", known) == (
        "torch.fft, torch.fft.rfft, torch.nn.Conv1d"
    )


def cell(source: str, **entries):
    made = nbformat.v4.new_code_cell(source)
    made.metadata["dd"] = {
        "handles": {name.replace("__", ", "): of for name, of in entries.items()}
    }
    return made


@pytest.mark.parametrize(
    ("settings", "wanted"),
    [
        (cell("kp = (750.0, 225.0)  # N m/rad", kp={"unit": "N m/rad"}),
         [("kp[0]", "N m/rad", 100, 3000, 50), ("kp[1]", "N m/rad", 25, 900, 25)]),
        (cell("w, h = 21, 10", w={"from": 3, "to": 84, "step": 2}, h={}),
         [("w", "", 3, 83, 2), ("h", "", 2, 40, 1)]),
        (cell("a = Link(1.5, m=14.0)", a={}, a__m={"unit": "kg"}),
         [("a, number 1", "", 0.2, 6.0, 0.1), ("a, m", "kg", 2.0, 56.0, 1.0)]),
        (cell("x = -80.0", x={"from": -90, "to": 90}), [("x", "", -90, 90, 2)]),
        (cell("kd = 0.0", kd={}), [("kd", "", 0, 10, 0.1)]),
        (cell("seed = 0", seed={}), [("seed", "", 0, 10, 1)]),
        (cell("x = 0.313", x={"to": 1}), [("x", "", 0.033, 0.993, 0.01)]),
        (cell("n = 3000", n={}), [("n", "", 800, 12000, 200)]),
        (cell("late = (0, 1)\nx = 10**6\nname = 'A0'"), []),
    ],
)  # fmt: skip
def test_ends_steps_and_units_of_handles(settings, wanted):
    made = handles(settings)
    assert [(h["label"], h["unit"], h["low"], h["high"], h["step"]) for h in made] == wanted


def test_a_handle_without_its_number_is_refused():
    with pytest.raises(ValueError, match="numbers of their cell, got y"):
        handles(cell("x = 1", y={}))


@pytest.mark.parametrize("page", WALK)
def test_handles_of_a_lesson_agree_with_its_numbers(page):
    """Each stands for a number of the code, on a step of its range, with room to move."""
    settings = next(cell for cell in lesson(page).cells if CHANGE_THIS in tags(cell))
    made = handles(settings)
    assert len({handle["label"] for handle in made}) == len(made)
    nodes = [node for node in ast.parse(settings.source).body if isinstance(node, ast.Assign)]
    values = {ast.unparse(node.targets[0]).strip("()"): ast.unparse(node.value) for node in nodes}
    for handle in made:
        code = values[handle["target"]]
        numbers = re.findall(r"(?<![\w.])-?\d+(?:\.\d*)?(?:e-?\d+)?(?!\w)", code)
        assert len(numbers) == handle["count"]
        value = ast.literal_eval(numbers[handle["place"]])
        low, high, step = handle["low"], handle["high"], handle["step"]
        assert low <= value <= high and 9 * step <= high - low + 1e-9 <= 101 * step, handle
        assert (value - low) / step == pytest.approx(round((value - low) / step), abs=1e-6)
        assert (not handle["digits"]) == all(isinstance(x, int) for x in (value, low, high, step))
