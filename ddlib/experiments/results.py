"""Committed results: where they are, which code made them, and whether it still does.

What is kept from one run to the next is used again under two conditions, and no others:

- A result of a study, and a setting that a sweep has finished, while `code_hash` is the same: a
  hash of what the code means, so that words and layout do not count. A result is committed, and
  a test compares the hash in it.
- What the build keeps in ``_build``, while the files are the same, byte for byte: ``digest`` in
  ``book/_ext/dd_book.py``. Of ddlib, results, ``book/*.yml`` and requirements it names the folder
  of executed notebooks, in which a notebook is known by its cells and in which claims that one of
  them has measured (`ddlib.evidence.claims`) lie for the others; of everything, it says whether
  the pages are up to date.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import platform
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ddlib._check import book_file
from ddlib.experiments.setups import COURSE, STATE_FEEDBACK
from ddlib.learning import TorqueModel, kernels

PACKAGE = Path(__file__).parents[1]
FOLDER = PACKAGE.parent / "book" / "results"
"""Where `make reproduce` writes and the chapters read."""

STUDIES = "experiments/studies"
"""Folder of the package with the functions that make the results."""

ASIDE = ("_check", "experiments.results")
"""Modules that a study imports and that do not decide what it finds."""


def code_hash(result: str) -> str:
    """Hash of the code that makes a result: docstrings, comments and layout do not count.

    It covers every module of ddlib that the result's study depends on through its imports,
    and of the study's own file all but the other public functions.

    Parameters
    ----------
    result : str
        Name of the result, like "table-4-1".

    Raises
    ------
    ValueError
        If no function in `STUDIES` makes it.
    """
    own = result.replace("-", "_")
    study = _study(result)
    forms = [_study_form(study, own), *(_form(_text(name)) for name in modules(result))]
    return hashlib.sha256("\n".join(forms).encode()).hexdigest()[:16]


def modules(result: str) -> list[str]:
    """Modules of ddlib on which a result depends, through all imports of its study's file.

    Parameters
    ----------
    result : str
        Name of the result, like "table-4-1".
    """
    reached, waiting = set(ASIDE), _imports(_study(result))
    while waiting - reached:
        name = min(waiting - reached)
        reached.add(name)
        waiting |= _imports(_text(name))
    return sorted(reached - set(ASIDE))


def _study(result: str) -> str:
    """The text of the file whose function makes a result."""
    own = result.replace("-", "_")
    for path in sorted((PACKAGE / STUDIES).rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if own in _functions(text):
            return text
    raise ValueError(f"result must be made by a function of ddlib/{STUDIES}, got {result!r}")


def _imports(text: str) -> set[str]:
    """Modules of ddlib that a file imports from; a package's names lead to its modules."""
    found = set()
    for module, names in _import_statements(text):
        place = module.partition(".")[2]
        found |= {_home(place, name) for name in names} if _path(place).is_dir() else {place}
    return found


def _home(package: str, name: str) -> str:
    """The module behind a name that a package hands on, as its ``__init__`` says."""
    inside = f"{package}.{name}".lstrip(".")
    if _path(inside).is_dir() or _path(inside).with_suffix(".py").is_file():
        return inside
    for module, names in _handed_on(_text(package)):
        if name in names:
            return f"{package}.{module}"
    return package


def _path(module: str) -> Path:
    return PACKAGE.joinpath(*filter(None, module.split(".")))


def _text(module: str) -> str:
    path = _path(module)
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return path.read_text(encoding="utf-8")


# What a text says is found once; whether a file has that text is asked each time.


@cache
def _functions(text: str) -> frozenset[str]:
    body = ast.parse(text).body
    return frozenset(node.name for node in body if isinstance(node, ast.FunctionDef))


@cache
def _import_statements(text: str) -> list[tuple[str, list[str]]]:
    """Modules of ddlib that are imported from, with the names."""
    nodes = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom))
    return [
        (node.module, [alias.name for alias in node.names])
        for node in nodes
        if (node.module or "").split(".")[0] == "ddlib"
    ]


@cache
def _handed_on(text: str) -> list[tuple[str, list[str]]]:
    """The keywords of a package's ``__init__``: modules, with the names they hand on."""
    found = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.keyword):  # without a name: a dictionary of dotted modules
            value = ast.literal_eval(node.value)
            found += value.items() if node.arg is None else [(node.arg, value)]
    return [(module, names.split()) for module, names in found]


@cache
def _form(text: str) -> str:
    return _normal_form(ast.parse(text))


@cache
def _study_form(text: str, own: str) -> str:
    """Of a study's file without the public functions that make other results."""
    others = {name for name in _functions(text) if not name.startswith("_")} - {own}
    body = ast.parse(text).body
    return _normal_form([node for node in body if getattr(node, "name", None) not in others])


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
    return isinstance(node, ast.Expr) and isinstance(getattr(node.value, "value", None), str)


def stamp(seconds: float) -> dict:
    """What is kept beside a result: time, the machine's kernels, versions."""
    return {
        "seconds": round(seconds, 1),
        "machine": f"{platform.system()} {platform.machine()}, {kernels()}",
        "python": platform.python_version(),
        "versions": {name: version(name) for name in ("numpy", "torch", "scipy")},
    }


def write_json(path: Path, content: dict) -> None:
    """Write a JSON file in one step, so that an interrupted run leaves no half file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + ".part")
    text = json.dumps(_plain(content), indent=1, allow_nan=False)
    temporary.write_text(text + "\n", encoding="utf-8")
    os.replace(temporary, path)


def _plain(value):
    """Floats with five digits (null if not finite), arrays as lists; the rest is refused."""
    if isinstance(value, dict):
        return {key: _plain(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    if isinstance(value, np.ndarray):
        return [_plain(v) for v in value] if value.ndim else _plain(value[()])
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.5g}") if np.isfinite(value) else None
    if isinstance(value, (np.integer, np.bool_)):
        return value.item()
    if value is None or isinstance(value, (str, int)):
        return value
    raise TypeError(f"{type(value).__name__} does not go into a results file")


def networks(width: int, setup: str = STATE_FEEDBACK.name) -> TorqueModel:
    """The trained networks of a cell of Table 4-1.

    Parameters
    ----------
    width : int
        Window size, one of `ddlib.experiments.setups.WINDOWS`.
    setup : str
        Name of one of `ddlib.experiments.setups.SETUPS`.
    """
    return TorqueModel.load(networks_path(setup, width))


def median_network(width: int, setup: str = STATE_FEEDBACK.name) -> TorqueModel:
    """The trained network of a cell of Table 4-1 whose test error is the median.

    Parameters
    ----------
    width, setup
        As in `networks`.
    """
    errors = read("table-4-1")["setups"][setup][str(width)]["errors"]["test"]
    return networks(width, setup)[int(np.argsort(errors)[len(errors) // 2])]


def networks_path(setup: str, width: int) -> Path:
    """File of the trained networks of one cell of Table 4-1."""
    return book_file(FOLDER) / f"networks-{setup.replace(' ', '-')}-{width}.npz"


def course_path(width: int) -> Path:
    """File of the first two networks of a window size on their way through training."""
    return book_file(FOLDER) / f"course-{width}.npz"


def course(width: int) -> tuple[np.ndarray, TorqueModel]:
    """The first two networks (state feedback) of a window size, all along their training.

    Parameters
    ----------
    width : int
        Window size, among those of Table 4-1.

    Returns
    -------
    epochs : ndarray, shape (epochs,)
        `ddlib.experiments.setups.COURSE`: 0 stands for the initial weights.
    model : TorqueModel
        Weights with leading axes ``(epochs, 2)``.

    Raises
    ------
    FileNotFoundError
        If there is no such result.
    """
    return np.array(COURSE), TorqueModel.load(course_path(width))


_parsed = lru_cache(maxsize=8)(json.loads)  # a chapter asks for a large one hundreds of times


def read(name: str) -> dict:
    """The committed result `name`; all who read it share what comes back, so leave it as it is.

    Parameters
    ----------
    name : str
        Name of a file in `FOLDER`, without its ending.

    Raises
    ------
    FileNotFoundError
        If there is no such result; says how to make it.
    ValueError
        If the file is damaged.
    """
    path = book_file(FOLDER) / f"{name}.json"
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise FileNotFoundError(
            f"no result {name!r} in {FOLDER}: run `make reproduce` first"
        ) from error
    try:
        return _parsed(text)
    except ValueError as error:
        raise ValueError(f"result {name!r} in {FOLDER} is damaged: {error}") from error
