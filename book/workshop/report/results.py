"""Committed results: where they are, and how they are written and read.

What is kept from one run to the next is used again under two conditions, and no others:

- A result of a study, and a setting that a sweep has finished, while their `code_hash` is the
  same. A result is committed, and a test compares the hash in it.
- What the build keeps in ``_build``, while the files are the same, byte for byte: ``digest`` in
  ``book/_ext/dd_book.py``. Of ddlib, results, ``book/*.yml`` and requirements it names the folder
  of executed notebooks, in which a notebook is known by its cells and in which claims that one of
  them has measured lie for the others; of everything, it says whether the pages are up to date.
"""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ddlib._files import write_whole
from ddlib.learning import TorqueModel
from ddlib.setups import COURSE, STATE_FEEDBACK
from workshop import BOOK

FOLDER = BOOK / "results"  # Where `make reproduce` writes and the chapters read


def stamp(seconds: float) -> dict:
    """What is kept beside a result: time, the machine's kernels, versions."""
    from ddlib.learning import kernels  # needs PyTorch

    return {
        "seconds": round(seconds, 1),
        "machine": f"{platform.system()} {platform.machine()}, {kernels()}",
        "python": platform.python_version(),
        "versions": {name: version(name) for name in ("numpy", "torch", "scipy")},
    }


def write_json(path: Path, content: dict) -> None:
    """Write a JSON file in one step, so that an interrupted run leaves no half file."""
    write_whole(path, json.dumps(_plain(content), indent=1, allow_nan=False) + "\n")


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
    """The trained networks of a cell of Table 4-1."""
    return TorqueModel.load(_networks_path(setup, width))


def median_network(width: int, setup: str = STATE_FEEDBACK.name) -> TorqueModel:
    """The trained network of a cell of Table 4-1 whose test error is the median."""
    errors = read("table-4-1")["setups"][setup][str(width)]["errors"]["test"]
    return networks(width, setup)[int(np.argsort(errors)[len(errors) // 2])]


def _networks_path(setup: str, width: int) -> Path:
    """File of the trained networks of one cell of Table 4-1."""
    return FOLDER / f"networks-{setup.replace(' ', '-')}-{width}.npz"


def _course_path(width: int) -> Path:
    """File of the first two networks of a window size on their way through training."""
    return FOLDER / f"course-{width}.npz"


def course(width: int) -> tuple[np.ndarray, TorqueModel]:
    """The first two networks (state feedback) of a window size, all along their training, shape
    (epochs,).
    """
    return np.array(COURSE), TorqueModel.load(_course_path(width))


_parsed = lru_cache(maxsize=8)(json.loads)  # a chapter asks for a large one hundreds of times


def read(name: str) -> dict:
    """The committed result `name`; all who read it share what comes back, so leave it as it is."""
    path = FOLDER / f"{name}.json"
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


@cache
def _digest(folder: Path) -> str:
    """Hash of all numbers and networks of the studies in a folder, whoever made them and when."""
    total = hashlib.sha256()
    for path in sorted(folder.glob("*.json")):
        content = json.loads(path.read_text(encoding="utf-8"))
        if "code" in content.pop("made by", {}):
            total.update(f"{path.stem} {json.dumps(content, sort_keys=True)}\n".encode())
    for path in sorted(folder.glob("*.npz")):
        total.update(f"{path.stem} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return total.hexdigest()[:16]


def _committed() -> bool:
    """Whether these are the committed results, for which ``verdicts.json`` was written."""
    is_there = (FOLDER / "verdicts.json").is_file()
    return is_there and read("verdicts")["of results"] == _digest(FOLDER)
