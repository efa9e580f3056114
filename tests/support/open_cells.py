"""The open cells of a lesson, run as a reader runs them: in order, alone, after a change."""

from __future__ import annotations

import ast
import io
import sys
import time
from contextlib import redirect_stdout

import matplotlib
import nbformat
import yaml
from book_pages import ROOT, source
from chapter_rules import CHANGE_THIS, is_starter, tags, visible

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import solved

from ddlib.figures import Illustration

SHOWN = ("_repr_html_", "_repr_svg_", "_repr_markdown_", "_repr_png_", "_repr_mimebundle_")
CHANGES = yaml.safe_load((ROOT / "tests" / "support" / "changes.yml").read_text("utf-8")) or {}

SHORT = {
    "adaptive-control": "motions = 2",
    "backpropagation": "epochs, warm_up = 400, 50",
    "convolution-filters": "epochs = 400",
    "global-view": "epochs = 400",
    "hinton-diagrams": "epochs = 400",
    "inertia-in-the-weights": "epochs = 400",
    "learning-in-the-loop": "before, after = 3, 3",
    "networks-that-walk": "epochs = 100",
    "rivals": "epochs = 400",
    "run-time": "epochs = 400",
    "stirring": "few, many = 5, 20",
    "whole-state-space": "epochs, warm_up = 400, 50",
    "whose-filters": "epochs = 400",
    "window-networks": "epochs = 400",
    "window-size": "epochs = 400",
}
"""Settings with which a lesson's training takes seconds: the cells are the same."""


def lesson(page: str):
    return nbformat.read(source(page), as_version=4)


def imports(page: str) -> set[str]:
    """Packages that the open cells import."""
    nodes = [n for cell in visible(lesson(page)) for n in ast.walk(ast.parse(cell.source))]
    packages = {n.module.partition(".")[0] for n in nodes if isinstance(n, ast.ImportFrom)}
    return packages | {
        name.name.partition(".")[0] for n in nodes if isinstance(n, ast.Import) for name in n.names
    }


def execute(source_code: str, space: dict, name: str) -> str:
    """Run a cell: what it prints, and its last value as a notebook would show it."""
    tree = ast.parse(source_code)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(tree, name, "exec"), space)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), name, "eval"), space)
            wide = isinstance(value, Illustration)  # drawn; its narrow form each build draws
            for how in () if wide else SHOWN:
                if hasattr(value, how) and not isinstance(value, type):
                    print(str(getattr(value, how)())[:200])
                    break
    return printed.getvalue()


def run(page: str, *changes: str) -> tuple[dict, float]:
    """What the open cells leave behind, and the seconds of one core that they took.

    The changes are added to the cell *Change this*.
    """
    space = {"__name__": "__main__"}
    matplotlib.use("Agg")
    started = time.process_time()
    for cell in visible(lesson(page)):
        if is_starter(cell):
            continue
        lines = [cell.source, *changes] if CHANGE_THIS in tags(cell) else [cell.source]
        execute("\n".join(lines), space, f"{page}: {cell.id}")
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
    return space, time.process_time() - started


def exercises(page: str) -> list[solved.Exercise]:
    """The exercises of a lesson that have a cell for an answer, in order."""
    return solved.exercises(lesson(page))
