"""Data flows one way: nothing imports against the order of the rooms, and torch stays in its place.

Rooms are found by folder: those of ddlib, those of the book's workshop, and Part IV's.
"""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

from book_pages import ROOT

DDLIB = (
    *("_check", "_files", "paper", "metrics", "tables", "trajectories", "dynamics", "effects"),
    *(
        "control",
        "simulation",
        "logs",
        "identification",
        "learning",
        "setups",
        "analysis",
        "figures",
    ),
    "widgets",
)
WORKSHOP = ("report", "chapters")
BEYOND = ("rivals", "control", "others", "figures", "studies", "measures", "chapters")
ORDER = (
    *("ddlib", *(f"ddlib.{room}" for room in DDLIB)),
    *("workshop", *(f"workshop.{room}" for room in WORKSHOP)),
    *("beyond", *(f"beyond.{room}" for room in BEYOND)),
)
"""Rooms: each may import from those before it. A new one comes here first."""

TORCH = ("ddlib.learning", "workshop", "beyond")
"""Where torch may be imported."""


def modules() -> dict[str, Path]:
    """The file of every module of ours, by its dotted name."""
    book = {top: ROOT / "book" / top for top in ("workshop", "beyond")}
    homes = {"ddlib": ROOT / "ddlib", **book}
    files = {}
    for top, home in homes.items():
        for path in sorted(home.rglob("*.py")):
            parts = [top, *path.relative_to(home).with_suffix("").parts]
            files[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return files


MODULES = modules()


def imported(source: str, package: str = "ddlib") -> set[str]:
    """Dotted names of everything that is imported anywhere in a source, late imports too."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")
            base = above[: len(above) - node.level + 1] if node.level else []
            module = ".".join([*base, *([node.module] if node.module else [])])
            names |= {module, *(f"{module}.{alias.name}" for alias in node.names)}
    return names


@cache
def imports_of(module: str) -> set[str]:
    path = MODULES[module]
    package = module if path.stem == "__init__" else module.rpartition(".")[0]
    return imported(path.read_text(encoding="utf-8"), package)


def room_of(name: str) -> str:
    top, *inside = name.split(".")
    room = ".".join([top, *inside[:1]])
    return room if room in ORDER else top


def may_import(module: str, name: str) -> bool:
    """Whether a module may import a name; the packages themselves hand on what they like."""
    room, other = room_of(module), room_of(name)
    free = module in ("ddlib", "workshop", "beyond") or other not in ORDER
    return free or ORDER.index(other) <= ORDER.index(room)


def test_nothing_imports_against_the_order():
    assert {room_of(module) for module in MODULES} == set(ORDER)
    pairs = [(module, name) for module in MODULES for name in sorted(imports_of(module))]
    against = [f"{module} imports {name}" for module, name in pairs if not may_import(module, name)]
    assert not against, "\n".join(against)


def test_only_learning_imports_torch():
    users = [m for m in MODULES if any(n.split(".")[0] == "torch" for n in imports_of(m))]
    assert users and not [module for module in users if not module.startswith(TORCH)]


def test_physics_loads_without_torch_and_matplotlib():
    code = (
        "import sys, ddlib.metrics; ddlib.STATE_FEEDBACK.record(); "
        "print([m for m in ('torch', 'matplotlib', 'sympy', 'IPython') if m in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (answer.stdout.strip(), answer.stderr) == ("[]", "")
