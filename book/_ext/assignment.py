"""Assignments to hand out: `make assignment LESSON=window-networks`, or LESSON=all.

A folder that needs nothing else: open code, questions, checks, `ddlib`. Solutions stay behind.
"""

from __future__ import annotations

import ast
import base64
import re
import shutil
import sys
import tomllib
import zlib
from pathlib import Path

import nbformat
from dd_lessons import HEADING, chapters
from dd_reader import FOLDED, ROLE

ROOT = Path(__file__).parents[2]
OWN = f"## {HEADING}\n"
ANSWER = re.compile(r"<details.*?</details>", re.DOTALL)
JUDGE = re.compile(r"(?m)^from workshop\.chapters\.\w+ import check$")
SAID = "# {}: an assignment\n\n**Name:**\n\nFirst the lesson's code; questions stand at the end."
BEGIN = """from importlib.util import find_spec
for needed in ("ddlib", "judge", "numpy", "scipy", "sympy", "torch", "control", "matplotlib"):
    if find_spec(needed) is None:
        raise ModuleNotFoundError(f"{needed} is not there: see README.md beside this notebook.")"""
READ_ME = """# {}: an assignment

With Python 3.11 or newer, in this folder:

    python -m venv .venv
    .venv/bin/python -m pip install -r requirements.txt
    .venv/bin/python -m jupyterlab {}.ipynb

(On Windows `.venv\\Scripts\\python` in place of `.venv/bin/python`.)

Run the cells from the top. Put each answer in place of the dots; the cell below judges it by
judge.py, which is folded so that nobody reads a solution by accident. An answer is judged once: to
try again, run both cells. Say how you found it, too.
"""


def lessons(root: Path = ROOT) -> dict[str, Path]:
    """Notebooks whose exercises are judged, by name."""
    return {p.stem: p for p in chapters(root) if " import check" in p.read_text("utf-8")}


def names(node: ast.AST, use: str) -> set[str]:
    """What a statement of a module stores, or loads from elsewhere."""
    every = {"Load": set(), "Store": {a.arg for a in ast.walk(node) if isinstance(a, ast.arg)}}
    for name in (n for n in ast.walk(node) if isinstance(n, ast.Name)):
        every[type(name.ctx).__name__].add(name.id)
    own = every["Load"] - every["Store"] if use == "Load" else every["Store"]
    return {node.name} if hasattr(node, "name") and use == "Store" else own


def judge(module: str, wanted: set[str], root: Path = ROOT) -> list[str]:
    """What some definitions of a module of the workshop need, and nothing else."""
    path = root / "book" / (module.replace(".", "/") + ".py")
    body, known, code = ast.parse(path.read_text(encoding="utf-8")).body, 0, []
    while known < len(wanted):
        known = len(wanted)
        needed = (names(n, "Load") for n in body if wanted & names(n, "Store"))
        wanted = wanted.union(*needed)
    for node in body:
        home, kept = getattr(node, "module", ""), wanted & names(node, "Store")
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            kept = [a for a in node.names if (a.asname or a.name.split(".")[0]) in wanted]
            node.names = kept
        if kept and home.startswith("workshop"):
            code += judge(home, {a.name for a in kept}, root)
        elif kept:
            code.append(ast.unparse(node))
    return code


def folded(code: str) -> str:
    text = base64.b85encode(zlib.compress(code.encode(), 9))
    return f"import base64, zlib  # folded\n\nexec(zlib.decompress(base64.b85decode({text})))\n"


def plain(question: str, lesson) -> str:
    """A question without roles: equations that it names stand below it, figures by their words."""
    text = "\n\n".join(c.source for c in lesson.cells if c.cell_type == "markdown")
    figures = (c.metadata.get("mystnb", {}).get("figure") for c in lesson.cells)
    captions, below = {f["name"]: f["caption"].partition(". ")[0] for f in figures if f}, {}

    def said(role: re.Match) -> str:
        kind, label = role.groups()
        found = re.search(rf"\$\$\n([^$]*)\n\$\$ \({label}\)", text) if kind == "eq" else None
        if kind.startswith("glue"):
            raise ValueError(f"a question must insert no number of the book's, got {role[0]}")
        if not found:
            return f"the figure *{captions[label].strip()}*" if label in captions else f"*{label}*"
        below[label] = found[1]
        return f"Eq. ({[*below].index(label) + 1})"

    asked = ROLE.sub(said, question)
    return asked + "".join(f"\n\n$$\n{x} \\tag{{{k}}}\n$$" for k, x in enumerate(below.values(), 1))


def notebook(path: Path):
    """Title and notebook to hand out."""
    lesson, new, asking = nbformat.read(path, as_version=4), nbformat.v4, False
    title = re.search("(?m)^# (.+)$", lesson.cells[0].source)[1]
    cells = [new.new_markdown_cell(SAID.format(title)), new.new_code_cell(BEGIN)]
    for cell in lesson.cells:
        if cell.cell_type == "markdown":
            head, own, rest = cell.source.partition(OWN)
            told = [] if asking else re.findall("^##+ .+$", head, re.MULTILINE)[-1:]
            rest = ANSWER.sub("", cell.source if asking else rest)
            question, end, _ = f"\n{rest}".partition("\n## ")
            told += [OWN.strip()] * bool(own) + [plain(question.strip(), lesson)]
            cells += [new.new_markdown_cell(text) for text in told if text]
            asking = (asking or bool(own)) and not end
        elif asking or not {*FOLDED, "hide-cell"} & set(cell.metadata.get("tags", [])):
            cells.append(new.new_code_cell(JUDGE.sub("from judge import check", cell.source)))
    cells = [{**cell, "id": f"cell-{k}"} for k, cell in enumerate(cells)]
    return title, nbformat.from_dict({**lesson, "cells": cells})


def write(lesson: str, to: Path = ROOT / "_build" / "assignments", root: Path = ROOT) -> list[Path]:
    """Make the folder of a lesson, or those of all."""
    known = lessons(root)
    if lesson not in {"all", *known}:
        raise ValueError(f"LESSON must be all or one of {', '.join(known)}; got {lesson!r}")
    needs = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]["dependencies"]
    chosen = [*known] if lesson == "all" else [lesson]
    for name in chosen:
        title, made = notebook(known[name])
        folder, module = to / name, f"workshop.chapters.{name.replace('-', '_')}"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(root / "ddlib", folder / "ddlib", ignore=lambda *_: ["__pycache__"])
        shutil.copy(root / "LICENSE", folder)
        (folder / "judge.py").write_text(folded("\n".join(judge(module, {"check"}, root))), "utf-8")
        (folder / "README.md").write_text(READ_ME.format(title, name), "utf-8")
        (folder / "requirements.txt").write_text("\n".join([*needs, "jupyterlab"]), "utf-8")
        read = re.findall(r"data/([\w.-]+)", "\n".join(c.source for c in made.cells))
        if read:  # with the licences
            data = root / "book" / "data"
            spare = {p.name for p in data.iterdir() if p.suffix in {".csv", ".npz"}} - {*read}
            shutil.copytree(data, folder / "data", ignore=shutil.ignore_patterns(*spare))
        nbformat.write(made, folder / f"{name}.ipynb")
    return [to / name for name in chosen]


if __name__ == "__main__":
    try:
        print(*(f"==> {folder.relative_to(ROOT)}" for folder in write(sys.argv[1])), sep="\n")
    except ValueError as error:
        sys.exit(f"==> {error}")
