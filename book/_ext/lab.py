"""Lay out the readers' notebooks for `make lab`: those that a reader changed stay as they are."""

from __future__ import annotations

import shutil
from pathlib import Path

import nbformat
from nbformat.sign import NotebookNotary

ROOT = Path(__file__).parents[2]
MADE = ROOT / "_build" / "html" / "_sources" / "book"
LAB = ROOT / "_build" / "lab"
DATA = ROOT / "book" / "data"  # as some pages read it


def lay_out(made: Path, lab: Path) -> list[str]:
    """Copy notebooks to a folder, and names of those that were left as a reader changed them.

    What was handed out is kept beside, so that a change is told from a new build; what is handed
    out no longer goes.
    """
    handed, kept = lab / ".handed-out", []
    names = {path.relative_to(top) for top in (made, handed) for path in top.rglob("*.ipynb")}
    for name in sorted(names):
        new, own, before = made / name, lab / name, handed / name
        if own.is_file() and before.is_file() and own.read_bytes() != before.read_bytes():
            kept.append(name.as_posix())
            continue
        for path in (own, before):
            path.unlink(missing_ok=True)
            if new.is_file():
                path.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(new, path)
    shutil.copytree(DATA, lab / "data", dirs_exist_ok=True)
    return kept


def trust(made: Path) -> None:
    """Sign notebooks, wherever they lie: JupyterLab shows widgets of trusted ones before a run."""
    notary = NotebookNotary()
    for path in made.rglob("*.ipynb"):
        notary.sign(nbformat.read(path, as_version=4))


if __name__ == "__main__":
    trust(MADE)
    for name in lay_out(MADE, LAB):
        print(f"==> Left as you changed it: {(LAB / name).relative_to(ROOT)}")
