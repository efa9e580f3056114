"""A notebook that fails does not take the book with it: its page says so, in a box.

The box names the cell, the exception's last line and what a report needs. Numbers that were
not computed read as a question mark. `FAILURES` lists the pages for `build.py`.
"""

from __future__ import annotations

import json
import platform
import re
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import nbformat
from docutils import nodes
from myst_nb.ext.glue.roles import PasteTextRole
from myst_nb.sphinx_ import NbMetadataCollector
from sphinx.util.console import strip_colors

FAILURES = "failures.json"  # in the folder above the pages
PACKAGES = ("numpy", "scipy", "torch", "matplotlib", "myst-nb")

KERNEL_ENDED = "The Python process that executes the notebook ended, or did not start."
RULE = re.compile(r"^-{10,}\n(.*?)^-{10,}$", re.MULTILINE | re.DOTALL)  # around a cell's source
HYPHEN = re.compile(r"(?<![\w.])-(?=\d)")  # that stands for a minus sign
EXCEPTION = re.compile(r"^(?:\w+\.)*(\w*(?:Error|Exception|Warning|Interrupt|Exit)\b.*)$", re.M)


def failing_cell(traceback: str, cells: list) -> tuple[int, str]:
    """Number of the code cell that a traceback shows, from 1 on (0: not found), and its source.

    Parameters
    ----------
    traceback : str
        As nbclient words it: the source between two rules, long ones with an ellipsis.
    cells : list of str
        Sources of the notebook's code cells.
    """
    shown = RULE.search(traceback)
    start = shown[1].partition("\n...\n")[0].strip() if shown else ""
    for number, source in enumerate(cells, 1):
        if start and source.strip().startswith(start):
            return number, source
    return 0, start


def last_line(traceback: str) -> str:
    """The exception of a traceback in one line: the last that names one."""
    found = EXCEPTION.findall(traceback)
    return found[-1].strip() if found else traceback.strip().rpartition("\n")[2]


def described(env, page: str) -> dict | None:
    """What failed on a page, or None."""
    done = NbMetadataCollector.get_doc_data(env).get(page, {}).get("exec_data") or {}
    if page in env.config.kernel_ended:
        return {"page": page, "cell": 0, "begins": "", "error": KERNEL_ENDED}
    if done.get("succeeded", True):
        return None
    text = strip_colors(done["traceback"] or done["error"] or "")
    notebook = nbformat.read(env.doc2path(page), as_version=4)
    code = [cell.source for cell in notebook.cells if cell.cell_type == "code"]
    number, source = failing_cell(text, code)
    return {
        "page": page,
        "cell": number,
        "begins": source.strip().partition("\n")[0],
        "error": last_line(text),
    }


def where(failure: dict) -> str:
    """The cell in words."""
    if not failure["cell"]:
        return "its notebook"
    return f"code cell {failure['cell']} (“{failure['begins']}”)"


def machine() -> str:
    """What a report should say about the machine."""
    found = []
    for name in PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            found.append(f"{name} missing")
    system = f"{platform.system()} {platform.release()}, {platform.machine()}"
    return "\n".join([f"Python {platform.python_version()}, {system}", *found])


def box(failure: dict) -> nodes.Node:
    """The box at the top of an incomplete page."""
    shown = nodes.admonition("", nodes.title(text="This page is incomplete"))
    shown["classes"] += ["admonition", "danger", "failed"]
    shown["ids"] = ["this-page-is-incomplete"]
    shown += nodes.paragraph(text=f"When these pages were built, {where(failure)} failed:")
    shown += nodes.literal_block(failure["error"], failure["error"], language="text")
    shown += nodes.paragraph(
        text="What comes before it is as it should be. Figures, tables and widgets that come "
        "after it are missing, and numbers that were not computed read “?”. The other pages "
        "were built as usual."
    )
    shown += nodes.paragraph(
        text="Please report it where this book came from, with the following lines. The whole "
        "traceback stands at the cell, if it is shown, and in the folder reports."
    )
    report = f"{failure['page']}, {where(failure)}\n{failure['error']}\n{machine()}"
    shown += nodes.literal_block(report, report, language="text")
    return shown


def insert_box(app, document):
    """Put the box below the title of a page whose notebook failed."""
    failure = described(app.env, app.env.docname)
    if failure:
        title = next(document.findall(nodes.title), None)
        place = title.parent if title else document
        place.insert(place.index(title) + 1 if title else 0, box(failure))


class NumberOrGap(PasteTextRole):
    """``{glue:text}`` with a true minus sign, or a question mark where nothing was computed."""

    def run(self):
        found, messages = super().run()
        for text in [text for node in found for text in node.findall(nodes.Text)]:
            text.parent.replace(text, nodes.Text(HYPHEN.sub("−", text)))
        return found or [nodes.inline(text="?", classes=["not-computed"])], messages


def leave_out(app, config):
    """Notebooks whose kernels ended are shown without outputs."""
    pages = [f"{page}.ipynb" for page in config.kernel_ended]
    config.nb_execution_excludepatterns = [*config.nb_execution_excludepatterns, *pages]


def list_failures(app, exception):
    """Tell `build.py` which pages are incomplete."""
    found = [described(app.env, page) for page in sorted(app.env.found_docs)]
    path = Path(app.outdir).parent / FAILURES
    path.write_text(json.dumps([f for f in found if f], ensure_ascii=False), encoding="utf-8")


def setup(app):
    app.add_config_value("kernel_ended", [], "env")  # pages that `build.py` could not execute
    app.add_role_to_domain("glue", "text", NumberOrGap(), override=True)
    app.connect("config-inited", leave_out)
    app.connect("doctree-read", insert_box)
    app.connect("build-finished", list_failures)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
