"""What keeps the house small: lines of each room, sizes of modules and packages, public names."""

import ast
import re
from pathlib import Path

from book_pages import ROOT

LINES = {
    "ddlib, without figures and widgets": 6966,  # 6800 before filters were learnt with equations
    "ddlib/figures": 1100,
    "ddlib/widgets": 3630,  # 3600 before the trainer and the builder took the reader's arm
    "ddlib/widgets, JavaScript": 4800,  # 4600 before the page recorded the reader's trajectories
    "book/workshop/report": 4950,
    "book/workshop/beyond": 8680,  # 8324 before every rival was tuned alike, two of a referee too
    "book/workshop/chapters": 7300,  # 5060 before lessons had numbers and judges
    "tests": 18900,  # 17935 before questions, assignments, Firefox, Colab and planted mistakes
}
"""Lines that a room may have. They may only fall: what is added replaces something."""

LONGEST, LARGEST, NAMES = 400, 9, 700
"""Lines of a module, modules of a package, public names of ddlib and the workshop together.

They may only fall, too.
"""

EACH_CHAPTER = ROOT / "book" / "workshop" / "chapters"
"""Has a module for each chapter, and so more than other packages."""


def files(folder: str, suffix: str = "py") -> list[Path]:
    return sorted((ROOT / folder).rglob(f"*.{suffix}"))


def lines(path: Path) -> int:
    return len(path.read_text(encoding="utf-8").splitlines())


def lines_of(room: str) -> int:
    if "without" in room:
        aside = ROOT / "ddlib" / "figures", ROOT / "ddlib" / "widgets"
        return sum(lines(p) for p in files("ddlib") if not set(aside) & set(p.parents))
    folder, _, language = room.partition(", ")
    return sum(map(lines, files(folder, "js" if language else "py")))


def public_names(path: Path) -> list[str]:
    """What a module defines at its top level without an underscore in front.

    Nothing, if it or a package above it begins with an underscore: "an interface is also considered
    internal if any containing namespace (package, module or class) is considered internal" (PEP 8).
    """
    if any(re.match("_[a-z]", part) for part in path.relative_to(ROOT).parts):
        return []
    names = []
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            names.append(node.name)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            bound = [part for target in targets for part in ast.walk(target)]
            names += [n.id for n in bound if isinstance(getattr(n, "ctx", 0), ast.Store)
                      and isinstance(n, ast.Name)]  # fmt: skip
    return [name for name in names if not name.startswith("_")]


def test_every_room_keeps_to_its_budget():
    ours = [*files("ddlib"), *files("book/workshop")]
    over = [
        f"{room}: {count} lines of {most}"
        for room, most in LINES.items()
        if (count := lines_of(room)) > most
    ]
    every = [*ours, *files("tests")]
    over += [f"{p}: {count} lines" for p in every if (count := lines(p)) > LONGEST]
    packages = {path.parent for path in ours if path.name == "__init__.py"}
    for package in sorted(packages):
        count = len(list(package.glob("*.py"))) - 1
        if count > LARGEST and package != EACH_CHAPTER:
            over.append(f"{package}: {count} modules")
    count = sum(len(public_names(path)) for path in ours)
    over += [f"{count} public names of {NAMES}"] * (count > NAMES)
    assert not over, "\n".join(over).replace(f"{ROOT}/", "")
