"""What comes back of an assignment: for nbgrader, which marks it, and from pages of the book.

`make collect FOLDER=returned` makes notebooks of the files `direct-drive-work.json` that students
saved on pages. `nbgrader_config.py` of a course calls `configure`.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sys
from pathlib import Path
from shutil import which
from subprocess import PIPE, run
from tempfile import mkdtemp

import nbformat
from nbconvert.preprocessors.sanitize import SanitizeHTML
from nbgrader.converters import Autograde
from nbgrader.preprocessors import NbGraderPreprocessor
from solved import IMPORT, changed, settings_of, variant_of, with_settings

BOX = Path(__file__).parent / "box"
FORMAT = "direct-drive-work-1"  # as book/_ext/live/page/live.js writes it
ALL, ONE = "an assignment", "an assignment for {}, variant {}"
SETTINGS = "settings"  # the cell's name
SECONDS = 300  # for a cell


def release(course: Path, lesson: str):
    """A lesson's notebook, as nbgrader made it for students."""
    return nbformat.read(course / "release" / lesson / f"{lesson}.ipynb", as_version=4)


def own_settings(notebook, student: str) -> tuple[int, dict[str, str]]:
    """A student's variant of an assignment, and its settings."""
    known = notebook.metadata["assignment"]
    variant = variant_of(known["lesson"], student) if known["varied"] else 0
    return variant, settings_of(known["lesson"], variant)


def own_copy(notebook, student: str):
    """What a student gets: an assignment with settings of their own."""
    variant, settings = own_settings(notebook, student)
    made = changed(notebook, settings)
    if made.metadata["assignment"]["varied"]:
        first = made.cells[0]
        first.source = first.source.replace(ALL, ONE.format(student, variant), 1)
    return made


def is_answer(cell) -> bool:
    """Whether a cell is for students to write in."""
    return cell.metadata.get("nbgrader", {}).get("solution", False)


def restored(returned, given, settings: dict[str, str]):
    """What was returned, with all cells that have a name as they were given, but for answers.

    A cell is known by nbgrader's name or by its own: some editors lose one, some the other. Where
    one is missing it comes back, behind the one that was before it.
    """
    cells, named = [*returned.cells], {}
    for cell in cells:
        known = cell.metadata.pop("nbgrader", {})
        named[cell.get("id")] = named[known.get("grade_id")] = cell
    place, code = 0, {k: v for k, v in settings.items() if k != IMPORT}
    for cell in given.cells:
        if "nbgrader" not in cell.metadata and cell.id != SETTINGS:
            continue
        own = named.get(cell.id)
        if own is None:
            cells.insert(place, cell)
        else:
            place = next(k for k, other in enumerate(cells) if other is own)
            cells[place] = cell
            if is_answer(cell):
                cell.source = own.source
        if is_answer(cell) and cell.cell_type == "code":
            try:
                cell.source = with_settings(cell.source, code)
            except SyntaxError:
                pass  # it will be marked as it is
        place += 1
    return nbformat.from_dict({**given, "cells": cells})


class Restore(NbGraderPreprocessor):
    """Before nbgrader looks at a returned notebook: settings and cells as they were handed out."""

    def preprocess(self, nb, resources):
        about = resources["nbgrader"]
        given = release(Path(), about["notebook"])  # nbgrader works in the course's folder
        _, settings = own_settings(given, about["student"])
        return restored(nb, own_copy(given, about["student"]), settings), resources


class Tame(SanitizeHTML):
    """Afterwards: no script of a student's runs in the browser of who reads marks or feedback."""

    enabled = True

    def preprocess_cell(self, cell, resources, index):
        if cell.cell_type != "markdown":
            return super().preprocess_cell(cell, resources, index)
        cell.source = re.sub(r"<(?=[a-zA-Z/!?])", "< ", cell.source)  # no tag, but still a formula
        return cell, resources


def no_box() -> str:
    """Why bubblewrap gives no box; nothing if it gives one."""
    if not which("bwrap"):
        return "bubblewrap is not there"
    tried = run(["bwrap", "--unshare-all", "--ro-bind", "/", "/", "true"], stderr=PIPE, text=True)
    return f"bubblewrap gives no box ({tried.stderr.strip()})" if tried.returncode else ""


def configure(c):
    """Settings of nbgrader for a course of this book."""
    c.CourseDirectory.course_id = "direct-drive-arm"
    c.CourseDirectory.ignore = [
        ".ipynb_checkpoints",
        "*.pyc",
        "__pycache__",
    ]  # a lesson is feedback
    c.ClearSolutions.code_stub = {"python": "# Write your answer above this line."}
    c.ClearSolutions.text_stub = "(Your words.)"
    c.Execute.timeout = SECONDS
    before, marked = Autograde.sanitize_preprocessors, Autograde.autograde_preprocessors
    c.Autograde.sanitize_preprocessors = [Restore, *before.default()]
    c.Autograde.autograde_preprocessors = [*marked.default(), Tame]
    if not (why := no_box()):
        os.environ["JUPYTER_PATH"] = str(BOX)
        c.Execute.kernel_name = "boxed"
        kernel, sockets = c.AsyncKernelManager, mkdtemp()  # files, as the box has no network
        kernel.transport, kernel.ip = "ipc", f"{sockets}/kernel"
        kernel.connection_file = f"{sockets}/kernel.json"
    elif "autograde" in sys.argv:
        print(f"==> {why}: notebooks run with your rights (see Teaching).")


def written(path: Path) -> dict[str, dict[str, str]]:
    """The code that a work file has, by lesson and cell."""
    content = json.loads(path.read_text("utf-8"))
    if content["format"] != FORMAT:
        raise ValueError(f"its format is {content['format']!r}")
    return {
        page.removesuffix(".html"): {cell: change[1] for cell, change in of["changes"].items()}
        for page, of in content["pages"].items()
    }


def answered(given, code: dict[str, str]) -> int:
    """Put a page's answers into a notebook, with their comments as explanations: how many."""
    names = [c.id for c in given.cells if is_answer(c) and c.cell_type == "code" and c.id in code]
    cells = {cell.id: cell for cell in given.cells}
    for name in names:
        said = re.findall(r"(?m)^ *#+ ?(.*)", code[name])
        cells[name].source = code[name]
        how = next(c for c in given.cells[given.cells.index(cells[name]) :] if "how-" in c.id)
        how.source += "\n\n" + "\n".join(said) if said else ""
    return len(names)


def collect(folder: Path, course: Path) -> list[str]:
    """Make notebooks of the work files in a folder, and say of each what became of it.

    `ada.json` and whatever lies in a folder `ada` is of the student `ada`.
    """
    if not (files := sorted(folder.rglob("*.json"))):
        raise ValueError(f"FOLDER must have work files in it, or in folders of it; got {folder}")
    told = []
    for path in files:
        student = path.relative_to(folder).parts[0].removesuffix(".json")
        try:
            pages = written(path)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            told.append(f"{path}: no work file of this book ({type(error).__name__}: {error})")
            continue
        for lesson in sorted(p.parent.name for p in course.glob("release/*/*.ipynb")):
            made = own_copy(release(course, lesson), student)
            count = answered(made, pages.get(lesson, {}))
            to = course / "submitted" / student / lesson / f"{lesson}.ipynb"
            if count and to.exists():
                told.append(f"{path}: {lesson} is left, because {to} is there already")
            elif count:
                to.parent.mkdir(parents=True, exist_ok=True)
                nbformat.write(made, to)
                told.append(f"{path}: {lesson}, answers: {count}")
    return told


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("course", type=Path)
    asked = parser.parse_args()
    try:
        print(*collect(asked.folder, asked.course), sep="\n")
    except ValueError as error:
        sys.exit(f"==> {error}")
