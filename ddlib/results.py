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
    "metrics", "network", "training", "experiment", "reproduce",
)  # fmt: skip
"""Modules on which the results depend."""


def code_hash(modules=MODULES) -> str:
    """Hash of what the modules' code does: docstrings, comments and layout do not count.

    Parameters
    ----------
    modules : sequence of str
        Names of modules of ddlib.
    """
    total = hashlib.sha256()
    for name in modules:
        tree = ast.parse((PACKAGE / f"{name}.py").read_text(encoding="utf-8"))
        total.update(f"{name}:{_normal_form(tree)}\n".encode())
    return total.hexdigest()[:16]


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


def stamp(seconds: float) -> dict:
    """What is kept beside every result: code, versions, run time."""
    return {
        "code": code_hash(),
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
