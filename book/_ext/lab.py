"""Lay out the readers' notebooks for `make lab`: those that a reader changed stay as they are."""

from __future__ import annotations

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[2]
MADE = ROOT / "_build" / "html" / "_sources" / "book"
LAB = ROOT / "_build" / "lab"
DATA = ROOT / "book" / "data"  # as some pages read it


def lay_out(made: Path, lab: Path) -> list[str]:
    """Copy notebooks to a folder, and names of those that were left as a reader changed them.

    What was handed out is kept beside, so that a change is told from a new build.
    """
    handed, kept = lab / ".handed-out", []
    handed.mkdir(parents=True, exist_ok=True)
    for path in sorted(made.rglob("*.ipynb")):
        name = path.relative_to(made)
        own, before = lab / name, handed / name
        if own.is_file() and before.is_file() and own.read_bytes() != before.read_bytes():
            kept.append(name.as_posix())
            continue
        for folder in (own.parent, before.parent):
            folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, own)
        shutil.copyfile(path, before)
    shutil.copytree(DATA, lab / "data", dirs_exist_ok=True)
    return kept


if __name__ == "__main__":
    for name in lay_out(MADE, LAB):
        print(f"==> Left as you changed it: {(LAB / name).relative_to(ROOT)}")
