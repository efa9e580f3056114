"""Committed results: where they are, which code made them, and whether it still does."""

from __future__ import annotations

import ast
import hashlib
import json
import os
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np

PACKAGE = Path(__file__).parent
FOLDER = PACKAGE.parent / "book" / "results"
"""Where `make reproduce` writes and the chapters read."""

MODULES = (
    "paper", "arm", "effects", "trajectories", "controllers", "simulate", "windows",
    "metrics", "network", "training", "experiment",
)  # fmt: skip
"""Modules on which every result depends."""


def code_hash(result: str) -> str:
    """Hash of the code that makes a result: docstrings, comments and layout do not count.

    It covers `MODULES` whole, and of `ddlib.reproduce` the result's own function with
    the private helpers.

    Parameters
    ----------
    result : str
        Name of the result, like "table-4-1".

    Raises
    ------
    ValueError
        If no function of `ddlib.reproduce` makes it.
    """
    trees = [ast.parse(_source(name)) for name in MODULES]
    functions = [n for n in ast.parse(_source("reproduce")).body if isinstance(n, ast.FunctionDef)]
    own = result.replace("-", "_")
    if own not in [function.name for function in functions]:
        raise ValueError(f"result must be made by a function of ddlib.reproduce, got {result!r}")
    trees += [f for f in functions if f.name == own or f.name.startswith("_")]
    return hashlib.sha256("\n".join(map(_normal_form, trees)).encode()).hexdigest()[:16]


def _source(module: str) -> str:
    return (PACKAGE / f"{module}.py").read_text(encoding="utf-8")


def _normal_form(node) -> str:
    """A syntax tree as text, the same for every Python version the book supports."""
    if isinstance(node, list):
        return "[" + ",".join(_normal_form(item) for item in node if not _is_text(item)) + "]"
    if isinstance(node, ast.AST):
        parts = [
            f"{name}={_normal_form(value)}"
            for name, value in ast.iter_fields(node)
            if value not in (None, []) and name not in ("ctx", "kind", "type_params")
        ]
        return f"{type(node).__name__}({','.join(parts)})"
    return repr(node)


def _is_text(node) -> bool:
    """A statement that is only a string: a docstring or the note below a constant."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def stamp(seconds: float, result: str | None = None) -> dict:
    """What is kept beside a result: run time, versions, and for `result` its code's hash."""
    return {
        **({"code": code_hash(result)} if result else {}),
        "seconds": round(seconds, 1),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in ("numpy", "torch", "scipy")},
    }


def write_json(path: Path, content: dict) -> None:
    """Write a JSON file in one step, so that an interrupted run leaves no half file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + ".part")
    temporary.write_text(json.dumps(content, indent=1, default=_plain) + "\n", encoding="utf-8")
    os.replace(temporary, path)


def _plain(value):
    if isinstance(value, np.ndarray):
        return [_plain(v) for v in value] if value.ndim else _plain(value[()])
    if isinstance(value, np.floating):
        return float(f"{value:.5g}")
    if isinstance(value, (np.integer, np.bool_)):
        return value.item()
    raise TypeError(f"{type(value).__name__} does not go into a results file")


def networks_path(setup: str, width: int) -> Path:
    """File of the trained networks of one cell of Table 4-1."""
    return FOLDER / f"networks-{setup.replace(' ', '-')}-{width}.npz"


def snapshot_path(width: int, epoch: int) -> Path:
    """File of the first two networks of a window size after some epochs."""
    return FOLDER / "snapshots" / f"{width}-{epoch}.npz"


def read(name: str) -> dict:
    """The committed result `name`.

    Parameters
    ----------
    name : str
        Name of a file in `FOLDER`, without its ending.

    Raises
    ------
    FileNotFoundError
        If there is no such result; says how to make it.
    """
    path = FOLDER / f"{name}.json"
    if not path.is_file():
        raise FileNotFoundError(f"no result {name!r} in {FOLDER}: run `make reproduce` first")
    return json.loads(path.read_text(encoding="utf-8"))
