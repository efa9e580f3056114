"""How large each room is, for a review to judge: `python tests/support/sizes.py`.

Printed at the end of `make check`. Nothing fails: there is no size that a room must keep to.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = (
    *("ddlib", "ddlib/figures", "ddlib/widgets"),
    *("book/workshop", "book/workshop/report", "book/workshop/chapters", "book/beyond"),
    *("book/_ext", "book/_static", "benchmarks", "tests", "tests/beyond"),
)
"""Folders. What lies in a room below another is counted in the lower one alone."""


def files(room: str, suffix: str, root: Path = ROOT) -> list[Path]:
    """Files of a room with an ending like "py", without those of rooms below it."""
    below = {root / other for other in ROOMS if other.startswith(f"{room}/")}
    paths = sorted((root / room).rglob(f"*.{suffix}"))
    return [path for path in paths if not below & set(path.parents)]


def lines(path: Path) -> int:
    """Lines of a file."""
    return len(path.read_text(encoding="utf-8").splitlines())


def public_names(path: Path, root: Path = ROOT) -> list[str]:
    """What a module defines at its top level without an underscore in front.

    Nothing, if it or a package above it begins with an underscore: "an interface is also considered
    internal if any containing namespace (package, module or class) is considered internal" (PEP 8).
    """
    if any(re.match("_[a-z]", part) for part in path.relative_to(root).parts):
        return []
    names = []
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            names.append(node.name)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            bound = [n for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)]
            names += [name.id for name in bound if isinstance(name.ctx, ast.Store)]
    return [name for name in names if not name.startswith("_")]


def sizes(root: Path = ROOT) -> list[tuple[str, int, int, int, str]]:
    """Room, lines of Python and of JavaScript, public names, and its longest module."""
    rows = []
    for room in ROOMS:
        python = {path: lines(path) for path in files(room, "py", root)}
        script = sum(lines(path) for suffix in ("js", "mjs") for path in files(room, suffix, root))
        is_library = room.startswith(
            ("ddlib", "book/workshop", "book/beyond")
        )  # others are imported by nobody
        names = sum(len(public_names(path, root)) for path in python) if is_library else 0
        by_name = {path.relative_to(root / room).as_posix(): n for path, n in python.items()}
        longest = max(by_name, key=by_name.get, default="")
        told = f"{longest}, {by_name[longest]}" if longest else ""
        rows.append((room, sum(python.values()), script, names, told))
    return rows


def main() -> None:
    """Print the table."""
    rows, head = sizes(), ("room", "Python", "JavaScript", "public names", "longest module")
    print("==> Sizes, in lines (a room is counted without the rooms below it)")
    total = ("all", *(sum(row[k] for row in rows) for k in (1, 2, 3)), "")
    for room, python, script, names, longest in (head, *rows, total):
        print(f"{room:24}{python or '':>8}{script or '':>12}{names or '':>14}  {longest}".rstrip())


if __name__ == "__main__":
    main()
