"""Install what ddlib needs and this Python lacks; what is there stays as it is.

A reader's notebook calls it where the book was fetched and not installed. Colab breaks if its own
IPython or traitlets are replaced, so nothing is: a version below ddlib's bound is said, no more.
"""

from __future__ import annotations

import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from packaging.requirements import Requirement

PROJECT = Path(__file__).parents[2] / "pyproject.toml"


def lacking(needs: list[str]) -> tuple[list[str], list[str]]:
    """What is not installed at all, and in words what is older or newer than asked for."""
    absent, other = [], []
    for need in map(Requirement, needs):
        try:
            found = version(need.name)
        except PackageNotFoundError:
            absent.append(str(need))
            continue
        if not need.specifier.contains(found, prereleases=True):
            other.append(f"{need.name} {found} is here, ddlib is tested with {need.specifier}")
    return absent, other


if __name__ == "__main__":
    needs = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["dependencies"]
    absent, other = lacking(needs)
    for sentence in other:
        print(sentence)
    if absent:
        print("Installing", ", ".join(absent))
        subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", *absent], check=True)
