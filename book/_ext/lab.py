"""JupyterLab on the readers' notebooks, for `make lab`, with the options that it is given.

Notebooks that a reader changed stay as they are. JupyterLab shows their widgets before anything
runs, since they are signed, and after a notebook was saved and opened again, too.
"""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import nbformat
from nbformat.sign import NotebookNotary

ROOT = Path(__file__).parents[2]
MADE = ROOT / "_build" / "html" / "_sources" / "book"
LAB = ROOT / "_build" / "lab"
DATA = ROOT / "book" / "data"  # as some pages read it
STATE = "application/vnd.jupyter.widget-state+json"
VIEW = "application/vnd.jupyter.widget-view+json"
GONE = "Run this cell to see its widget."


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


def trust(made: Path, notary: NotebookNotary) -> None:
    """Sign notebooks, wherever they are copied to."""
    for path in made.rglob("*.ipynb"):
        notary.sign(nbformat.read(path, as_version=4))


def states(notebook: dict) -> dict:
    """Saved states of a notebook's widgets, by their models."""
    return notebook["metadata"].get("widgets", {}).get(STATE, {}).get("state", {})


def keep_widgets(model: dict, path: str, contents_manager, **_) -> None:
    """Add to a notebook that is about to be saved the states that its file has of shown widgets.

    JupyterLab saves only those that a kernel holds. Where there is no state at all, a sentence
    takes the place of the widget.
    """
    file = Path(contents_manager.root_dir, path.strip("/"))
    if model["type"] != "notebook" or not file.is_file():
        return
    before, kept = states(json.loads(file.read_text("utf-8"))), states(model["content"])
    for cell in model["content"]["cells"]:
        for data in (output.get("data", {}) for output in cell.get("outputs", ())):
            name = data.get(VIEW, {}).get("model_id")
            if name in before and name not in kept:
                parts = before[name]["state"].values()
                links = (part[10:] for part in parts if str(part).startswith("IPY_MODEL_"))
                kept |= {link: before[link] for link in (name, *links) if link in before}
            elif name and name not in kept:
                del data[VIEW]
                data["text/plain"] = GONE


if __name__ == "__main__":
    from jupyterlab.labapp import LabApp  # here: the book's build needs the rest

    for name in lay_out(MADE, LAB):
        print(f"==> Left as you changed it: {(LAB / name).relative_to(ROOT)}")
    trust(MADE, NotebookNotary())
    LabApp.launch_instance(sys.argv[1:])
