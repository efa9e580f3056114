"""Which cells of a lesson a reader can run in the page, and what the page has to know of each."""

from __future__ import annotations

import ast
import importlib.util
import re
from functools import cache

from answers import exercises, is_check, is_open, is_starter
from lessons import CHANGE_THIS

from live.handles import handles
from live.packages import FIRST, OURS, PAGE
from live.page.names import names


def kind(cell) -> str:
    """What a code cell is on a page that runs: "open", "answer", "check", or ""."""
    if is_open(cell):
        return "answer" if is_starter(cell) else "open"
    return "check" if "hide-input" in cell.metadata["tags"] and is_check(cell) else ""


@cache
def stand_in():
    """What stands in for PyTorch in a page."""
    spec = importlib.util.spec_from_file_location("torch_of_a_page", PAGE / "instead" / "torch.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def is_lacking(path: str) -> bool:
    """Whether a dotted name of PyTorch is not in what stands in for it."""
    value = stand_in()
    for part in path.split(".")[1:]:
        value = getattr(value, part, None)
    return value is None or type(value).__name__ == "_Lacking"


def needs(source: str, known: dict[str, str]) -> str:
    """What a cell uses of PyTorch that the page lacks; `known`, names from its imports, grows."""
    used = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            modules = [a for a in node.names if a.name.partition(".")[0] == "torch"]
            known |= {a.asname or "torch": a.name if a.asname else "torch" for a in modules}
        elif isinstance(node, ast.ImportFrom) and f"{node.module}.".startswith("torch."):
            known |= {a.asname or a.name: f"{node.module}.{a.name}" for a in node.names}
            used |= {f"{node.module}.{a.name}" for a in node.names}
        elif isinstance(node, ast.Attribute):
            root, _, rest = ast.unparse(node).partition(".")
            if root in known and re.fullmatch(r"[\w.]+", rest):
                used.add(f"{known[root]}.{rest}")
    return ", ".join(sorted(filter(is_lacking, used)))


def live_cells(notebook) -> list[dict]:
    """The cells of a notebook that a reader of the page can run, in order.

    With the names that each takes and gives, the handles of *Change this*, and the solution of an
    exercise.
    """
    cells, imported, known = [], set(), {}
    for cell in notebook.cells:
        if cell.cell_type != "code" or not kind(cell):
            continue
        own = names(cell.source, imported)
        imported = (imported - own.writes - own.perhaps) | own.imports
        about = {"id": cell.id, "kind": kind(cell), "source": cell.source}
        about |= {"needs": needs(cell.source, known), "names": own.as_dict()}
        if CHANGE_THIS in cell.metadata.get("tags", ()):
            about["handles"] = handles(cell)
        cells.append(about)
    answers = [about for about in cells if about["kind"] == "answer"]
    for about, exercise in zip(answers, exercises(notebook)):
        about["solution"] = exercise.solution
        both = f"{exercise.solution}\n{exercise.check}"
        about["solves"] = names(both, imported).as_dict()
    return cells


def imported(cells: list[dict], packages: dict) -> list[str]:
    """Packages that cells import, in their order, each after those that it depends on.

    Without what comes before the first cell; `figures` draw with Matplotlib. Then those that
    modules of ours import for them: a page runs on where the network ends.
    """
    roots = [name for cell in cells for name in _imports(cell["source"])]
    order: list[str] = []

    def add(name):
        if name not in order:
            for other in packages[name]["depends"]:
                add(other)
            order.append(name)

    for root in [*roots, *OURS]:
        for name in [name for name, entry in packages.items() if root in entry["imports"]]:
            add(name)
    return [name for name in order if name not in FIRST]


def _imports(source: str) -> list[str]:
    """The packages behind the modules of a cell's imports."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [f"{node.module}.{alias.name}" for alias in node.names]
    drawn = ["matplotlib"] if "ddlib.figures" in found else []
    return [*drawn, *(name.partition(".")[0] for name in found)]
