"""Data flows one way: nothing in ddlib imports against its order, and torch stays in its place."""

import ast
import importlib
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import ddlib

ROOT = Path(ddlib.__file__).parent

ORDER = (
    *("_check", "_names", "paper", "metrics", "tables", "trajectories", "others"),
    *("dynamics", "effects", "control", "simulation", "identification", "learning"),
    *("analysis", "rivals", "figures", "experiments", "evidence", "widgets"),
)
"""Modules and packages of ddlib: each may import from those before it. A new one comes here first.
"""
LARGEST = 9  # modules of a package
LONGEST = 400  # lines of a module

FILES = [p for p in sorted(ROOT.rglob("*.py")) if p != ROOT / "__init__.py"]
each_file = pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))


def room_of(path) -> str:
    """Place of a file in the order: its module, or the package it lies in."""
    return path.relative_to(ROOT).with_suffix("").parts[0]


def imported(source, package="ddlib") -> set[str]:
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


def package_of(path) -> str:
    return ".".join(["ddlib", *path.relative_to(ROOT).parts[:-1]])


def own(path) -> set[str]:
    """Dotted names inside ddlib that a file imports, without the first part."""
    names = imported(path.read_text(encoding="utf-8"), package_of(path))
    return {name.partition(".")[2] for name in names if name.startswith("ddlib.")}


def test_the_reader_of_imports_reads(tmp_path):
    source = "import torch.nn as nn\nfrom ddlib.dynamics import Arm\ndef f():\n    from . import x"
    names = imported(source, "ddlib.effects")
    assert {"torch.nn", "ddlib.dynamics", "ddlib.dynamics.Arm", "ddlib.effects.x"} <= names
    assert "ddlib.simulation" in imported("from ..simulation import record", "ddlib.widgets")


def test_every_room_has_a_place_and_every_place_a_room():
    assert {room_of(path) for path in FILES} == set(ORDER)


@each_file
def test_nothing_imports_against_the_order(path):
    room = room_of(path)
    others = {name.split(".")[0] for name in own(path)} & set(ORDER)
    for other in others - {room}:
        assert ORDER.index(other) < ORDER.index(room), f"{room} imports {other}"


def modules_of(package) -> dict[str, set[str]]:
    """Modules of a package, each with those of the same package that it imports."""
    place = ".".join(package.relative_to(ROOT).parts)
    files = {p.stem: p for p in package.glob("*.py") if p.stem != "__init__"}
    return {
        name: {m for m in files if any((n + ".").startswith(f"{place}.{m}.") for n in own(path))}
        for name, path in files.items()
    }


PACKAGES = [p.parent for p in FILES if p.name == "__init__.py"]
each_package = pytest.mark.parametrize("package", PACKAGES, ids=lambda p: p.name)


@each_package
def test_packages_are_small_and_say_what_lives_there(package):
    assert len(modules_of(package)) <= LARGEST
    text = ast.get_docstring(ast.parse((package / "__init__.py").read_text(encoding="utf-8")))
    assert text and len(text.split()) >= 6


@each_package
def test_modules_of_a_package_import_each_other_one_way(package):
    tuple(TopologicalSorter(modules_of(package)).static_order())  # CycleError if there is a circle


@each_package
def test_a_package_hands_on_names_that_exist_and_once(package):
    name = ".".join(["ddlib", *package.relative_to(ROOT).parts])
    found = importlib.import_module(name)
    names = list(getattr(found, "__all__", ()))
    assert len(names) == len(set(names))
    assert all(getattr(found, n) is not None for n in names)


@each_file
def test_other_packages_are_reached_by_the_names_that_they_hand_on(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.ImportFrom) or not (node.module or "").startswith("ddlib."):
            continue
        package, _, inside = node.module.removeprefix("ddlib.").partition(".")
        handed_on = getattr(importlib.import_module(f"ddlib.{package}"), "__all__", ())
        if inside and package != room_of(path):
            names = {alias.name for alias in node.names} & set(handed_on)
            assert not names, f"import {', '.join(sorted(names))} from ddlib.{package}"


@each_file
def test_modules_are_short(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST


@each_file
def test_only_learning_and_rivals_import_torch(path):
    tops = {name.split(".")[0] for name in imported(path.read_text(), package_of(path))}
    assert "torch" not in tops or room_of(path) in ("learning", "rivals")


@pytest.mark.parametrize("module", ["dynamics", "simulation.simulate", "metrics"])
def test_physics_loads_without_torch_and_matplotlib(module):
    code = (
        f"import sys, ddlib.{module}; "
        "print([m for m in ('torch', 'matplotlib', 'sympy', 'IPython') if m in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.strip() == "[]"
