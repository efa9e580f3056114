"""Readers' notebooks in an environment with Colab's pins, taken out of the repository.

`python tests/support/colab.py PYTHON [NAME ...]` runs each notebook of the built `notebooks.zip` in
an empty folder, by the Python that has `colab.txt` and nothing of the book. The first cell fetches
the book as it is committed here. Each has to come to its end without an error, with the widgets
that its page has, and with Colab's versions still in place.
"""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

import nbformat
from jupyter_client import KernelManager
from jupyter_client.kernelspec import KernelSpec
from nbclient import NotebookClient
from tqdm import tqdm

ROOT = Path(__file__).resolve().parents[2]
HTML, PINS = ROOT / "_build" / "html", Path(__file__).with_name("colab.txt")
VIEW, STATE = "application/vnd.jupyter.widget-view+json", "widget-state+json"


def pinned() -> dict[str, str]:
    lines = (line.split("==") for line in PINS.read_text(encoding="utf-8").split() if "==" in line)
    return dict(lines)


def versions(python: str) -> dict[str, str]:
    """Versions of the pinned packages in another Python."""
    asked = "import sys; from importlib.metadata import version; print(*map(version, sys.argv[1:]))"
    answer = subprocess.check_output([python, "-c", asked, *pinned()], text=True).split()
    return {name: version.partition("+")[0] for name, version in zip(pinned(), answer, strict=True)}


class Kernel(KernelManager):
    """A kernel of another Python."""

    python = ""

    @property
    def kernel_spec(self):
        start = [self.python, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=start, display_name="Colab", language="python")


def faults(python: str, name: str, text: str) -> tuple[list[str], int]:
    """What goes wrong in a notebook, and how many widgets it shows."""
    notebook = nbformat.reads(text, 4)
    with tempfile.TemporaryDirectory() as folder:
        manager = Kernel()
        manager.python = python
        client = NotebookClient(notebook, timeout=600, km=manager, allow_errors=True,
                                resources={"metadata": {"path": folder}})  # fmt: skip
        client.execute(env={**os.environ, "DDLIB_SOURCE": ROOT.as_uri()})
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    wrong = [f"{o.ename}: {o.evalue[:300]}" for o in outputs if o.output_type == "error"]
    shown = sum(VIEW in output.get("data", {}) for output in outputs)
    page = HTML / "book" / f"{name}.html"
    if STATE in page.read_text(encoding="utf-8") and not shown:
        wrong.append("no widget is shown")
    return wrong, shown


def main(python: str, names: list[str]) -> int:
    python = os.path.abspath(python)  # its kernels start in other folders
    if versions(python) != pinned():
        print(f"PYTHON must have {pinned()}, has {versions(python)}")
        return 2
    archive, bad = zipfile.ZipFile(io.BytesIO((HTML / "notebooks.zip").read_bytes())), {}
    members = {
        re.sub(r"notebooks/|\d\d-|\.ipynb", "", n): n
        for n in archive.namelist()
        if n.endswith(".ipynb")
    }
    if unknown := set(names) - set(members):
        print(f"NAME must be among {', '.join(sorted(members))}, got {', '.join(sorted(unknown))}")
        return 2
    for name in tqdm(names or sorted(members), unit="notebook"):
        started = time.monotonic()
        wrong, shown = faults(python, name, archive.read(members[name]).decode())
        tqdm.write(
            f"{name}: {time.monotonic() - started:.0f} s, {shown} widgets, {wrong or 'fine'}"
        )
        bad |= {name: wrong} if wrong else {}
    same = versions(python) == pinned()
    print(f"==> {len(bad)} with faults; Colab's versions {'kept' if same else 'CHANGED'}")
    return int(bool(bad) or not same)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
