"""Data flows one way: nothing in ddlib imports against its order, and torch stays in its place."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import ddlib

ROOT = Path(ddlib.__file__).parent

# Each stage may import earlier ones only; modules of one stage do not import each other.
# A new module is written down here first.
ORDER = [
    ("_check",),
    ("sweeps",),  # maps any function over any table
    # of plain arrays: they stand alone, anything may use them
    (
        *("metrics", "filters", "friction", "actuators", "counting", "formulations", "coverage"),
        "verdicts",
    ),
    ("arm", "effects", "paper"),
    ("trajectories", "serial", "derivation", "noise_floor"),
    (
        "controllers",
        "linear",
        "plant",
        "delays",
        "costs",
        "identification",
        "simplified",
        "recording",
    ),
    ("simulate", "velocity"),
    ("windows", "unmodelled", "modulation", "loops"),
    ("network",),
    ("descent",),
    ("training", "state_space"),
    ("gauss_newton",),
    ("solver",),
    ("rivals",),
    ("experiment", "units", "sensitivity", "parity"),
    ("random_arms", "harmonics", "responses"),
    ("results", "style", "tables", "stated"),
    ("claims",),
    ("judging",),
    ("measures", "ledger_tables"),
    ("ledger",),
    (
        "figures",
        "diagrams",
        "figures_dynamics",
        "figures_effects",
        "figures_recording",
        "figures_learning",
        "figures_maps",
        "figures_ledger",
        "figures_states",
        "control_figures",
    ),
    ("widgets",),
    ("studies",),
    ("reproduce",),
]
STAGE = {name: i for i, names in enumerate(ORDER) for name in names}
TORCH = {"network", "descent", "training", "gauss_newton", "solver"}
SINGLE_STAGE_FREE = {"widgets", "rivals", "studies", "measures"}  # packages of several modules


def name_of(path) -> str:
    """Place of a file in the order: its module, or the package it lies in."""
    return path.relative_to(ROOT).with_suffix("").parts[0]


FILES = [p for p in sorted(ROOT.rglob("*.py")) if p != ROOT / "__init__.py"]
each_file = pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))


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


def own_modules(names) -> set[str]:
    """First parts of the names inside ddlib that are modules of it."""
    parts = {name.split(".")[1] for name in names if name.startswith("ddlib.")}
    return {p for p in parts if (ROOT / f"{p}.py").exists() or (ROOT / p).is_dir()}


def package_of(path) -> str:
    return ".".join(["ddlib", *path.relative_to(ROOT).parts[:-1]])


def test_the_reader_of_imports_reads():
    source = "import torch.nn as nn\nfrom ddlib.arm import Arm\ndef f():\n    from . import effects"
    names = imported(source)
    assert {"torch.nn", "ddlib.dynamics.arm", "ddlib.effects.real_arm"} <= names
    assert own_modules(names) == {"arm", "effects"}
    assert "ddlib.simulation.simulate" in imported("from ..simulate import record", "ddlib.widgets")


@each_file
def test_every_module_has_a_place(path):
    assert name_of(path) in STAGE, "name its stage in ORDER"


@each_file
def test_nothing_imports_against_the_order(path):
    name = name_of(path)
    for other in own_modules(imported(path.read_text(), package_of(path))):
        other = name_of(ROOT / f"{other}.py")
        if other == name and name in SINGLE_STAGE_FREE:
            continue
        assert STAGE[other] < STAGE[name], f"{name} imports {other}"


@each_file
def test_only_network_and_training_import_torch(path):
    tops = {name.split(".")[0] for name in imported(path.read_text(), package_of(path))}
    assert "torch" not in tops or name_of(path) in TORCH


@pytest.mark.parametrize("module", ["arm", "simulate", "metrics"])
def test_physics_loads_without_torch_and_matplotlib(module):
    code = (
        f"import sys, ddlib.{module}; "
        "print([m for m in ('torch', 'matplotlib', 'sympy', 'IPython') if m in sys.modules])"
    )
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    assert answer.stdout.strip() == "[]"
