"""Assignments to hand out: `make assignment LESSON=window-networks VARIANT=7`, or LESSON=all.

A folder that needs nothing else: open code, formulas, questions, a quiz, a judge, `ddlib`.
Solutions stay behind. Beside the folder, not in it, lies a key for who teaches: right answers of
this variant, wrong ones that are to be expected, and what to say to each.
"""

from __future__ import annotations

import argparse
import ast
import os
import re
import shutil
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import nbformat
import numpy as np
from dd_lessons import chapters
from dd_public import repository, site
from dd_quiz import OWN, questions
from dd_reader import ANCHOR, CHANGE_THIS, ROLE, TARGET
from solved import FOLD, Solved, changed, is_check, is_open, is_starter, settings_of, solve

from workshop.chapters.exercises import Between, MultipleOf, OneOf

ROOT = Path(__file__).parents[2]
TUTORIAL = "use-it-on-your-arm"
MADE = ROOT / "_build" / "assignments"
EQUATION = re.compile(r"(?ms)^\$\$\n(.*?)\n\$\$[ \t]*(?:\(([\w-]+)\))?[ \t]*$")
JUDGE = re.compile(r"from ((?:workshop|beyond)\.chapters\.\w+) import check\b")
ENGINE = "workshop.chapters.exercises"
SAID = (
    "# {}: an assignment{}\n\n**Name:**\n\nThis is the code of the lesson {}. Run it from the top. "
    "Your questions stand at the end, after the lesson's formulas."
)
BEGIN = """from importlib.util import find_spec

for needed in ("ddlib", "judge", "numpy", "scipy", "sympy", "torch", "control", "matplotlib"):
    if find_spec(needed) is None:
        raise ModuleNotFoundError(f"{needed} is not there: see README.md beside this notebook.")"""
HOW = "**How I found it ({}).** *Say why this is the answer, and how a wrong one would show.*"
LEAVE = "These are the settings of your assignment. Leave them as they are."
QUIZ = "## Check yourself\n\nWrite one letter for each question into the cell below."
READ_ME = """# {0}: an assignment{1}

With Python 3.11 or newer, in this folder:

    python -m venv .venv
    .venv/bin/python -m pip install -r requirements.txt
    .venv/bin/python -m jupyterlab {2}.ipynb

(On Windows `.venv\\Scripts\\python` in place of `.venv/bin/python`.)

On Linux, pip takes a PyTorch of several GB. For the smaller one, made for the CPU, run this before
the second line: `.venv/bin/python -m pip install {3} --index-url https://download.pytorch.org/whl/cpu`

Run the cells from the top. Put each answer in place of the dots; the cell below judges it. You
may try as often as you like: change the answer, then run both cells. Below each question, say how
you found it. In the end write your name into the first cell, run all cells, save, and hand in the
notebook alone.

The judge is judge.py, which asks, and exercises.py, which compares. Both can be read, so if you
read them, you see what is right. Your explanation is what counts.
"""


def lessons(root: Path = ROOT) -> dict[str, Path]:
    """Notebooks whose exercises are judged, by name, but for the tutorial on one's own arm."""
    judged = (p for p in chapters(root) if JUDGE.search(p.read_text("utf-8")))
    return {p.stem: p for p in judged if p.stem != TUTORIAL}


def names(node: ast.AST, use: str) -> set[str]:
    """What a statement of a module stores, or loads from elsewhere."""
    every = {"Load": set(), "Store": {a.arg for a in ast.walk(node) if isinstance(a, ast.arg)}}
    for name in (n for n in ast.walk(node) if isinstance(n, ast.Name)):
        every[type(name.ctx).__name__].add(name.id)
    own = every["Load"] - every["Store"] if use == "Load" else every["Store"]
    return {node.name} if hasattr(node, "name") and use == "Store" else own


def judge(module: str, wanted: set[str], root: Path = ROOT) -> tuple[list[str], list[str]]:
    """What some definitions of a module of the book's need: imports, and code as it stands."""
    text = (root / "book" / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8")
    body, known, imports, code = ast.parse(text).body, 0, [], []
    while known < len(wanted):
        known = len(wanted)
        needed = (names(n, "Load") for n in body if wanted & names(n, "Store"))
        wanted = wanted.union(*needed)
    for node in body:
        home = getattr(node, "module", "")
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            node.names = [a for a in node.names if (a.asname or a.name.split(".")[0]) in wanted]
            if node.names and home == ENGINE:
                node.module = "exercises"
            elif node.names and home.startswith(("workshop", "beyond")):
                theirs = judge(home, {a.name for a in node.names}, root)
                imports, code = imports + theirs[0], code + theirs[1]
                continue
            imports += [ast.unparse(node)] * bool(node.names)
        elif wanted & names(node, "Store"):
            first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
            code.append("\n".join(text.splitlines()[first - 1 : node.end_lineno]))
    return imports, code


def judge_module(name: str, root: Path = ROOT) -> str:
    """The file judge.py of a lesson."""
    module = JUDGE.search(lessons(root)[name].read_text("utf-8"))[1]
    imports, code = judge(module, {"check"}, root)
    first = sorted({*imports}, key=lambda line: ("__future__" not in line, line))
    told = f'"""What is asked in the lesson {name}, and what is right."""'
    return "\n\n\n".join([f"{told}\n\n" + "\n".join(first), *code]) + "\n"


class Words:
    """A lesson's text as an assignment says it: without roles, with numbers of its own.

    Formulas are numbered as they stand; so are figures of open cells that a question names.
    """

    def __init__(self, lesson):
        self.formulas, self.figures, self.labels = [], [], {}
        section, named = "", {inside for text in asked(lesson) for _, inside in ROLE.findall(text)}
        for cell in lesson.cells:
            if cell.cell_type == "markdown":
                text = FOLD.sub("", cell.source).partition(OWN)[0]
                for piece in re.split(r"(?m)^(?=#+ )", text):
                    head = re.match(r"#+ (.+)", piece)
                    section = head[1] if head else section
                    for body, label in EQUATION.findall(piece):
                        self.formulas.append((section, body))
                        self.labels[label] = f"Eq. ({len(self.formulas)})"
            elif is_open(cell) and (figure := cell.metadata.get("mystnb", {}).get("figure")):
                if figure["name"] in named:
                    self.figures.append(figure)
                    self.labels[figure["name"]] = f"Figure {len(self.figures)}"

    def plain(self, text: str) -> str:
        """Markdown without roles."""
        return ROLE.sub(self._said, ANCHOR.sub("", text)).strip()

    def _said(self, role: re.Match) -> str:
        kind, inside = role.groups()
        named = TARGET.fullmatch(inside)
        if kind.startswith("glue"):
            raise ValueError(f"a question must insert no number of the book's, got {role[0]}")
        if kind in ("eq", "numref"):
            if inside not in self.labels:
                raise ValueError(f"a question must name what an open cell draws, got {role[0]}")
            return self.labels[inside]
        if kind == "math":
            return f"${inside}$"
        return f"*{named[1] if named else inside.rpartition('/')[2].partition(': ')[0]}*"

    def caption(self, figure: dict) -> str:
        """The first sentence below a figure, as far as it has no number of the book's."""
        told = re.split(r"(?<=[\w)])[.?] ", " ".join(figure["caption"].split()))[0].rstrip(".")
        told = "" if "{glue" in told else f" {self.plain(told)}."
        return f"**{self.labels[figure['name']]}.**{told}"

    def given(self) -> Iterator[str]:
        """The formulas, each with the section that it comes from."""
        before = None
        for k, (section, body) in enumerate(self.formulas, 1):
            told = f"From *{section}*:\n\n" if section != before else ""
            before = section
            yield f"{told}$$\n{body} \\tag{{{k}}}\n$$"


def asked(lesson) -> list[str]:
    """The texts of a lesson's exercises, with their roles."""
    every = "\n\n".join(c.source for c in lesson.cells if c.cell_type == "markdown")
    own = FOLD.sub("", every.partition(OWN)[2]).partition("\n## ")[0]
    return [text.strip() for text in re.split(r"(?m)^(?=\*\*\d+\. )", own) if text.strip()]


def where(name: str, title: str) -> str:
    """A link to a lesson, or how to find it without one."""
    hosted = repository()
    linked = hosted or "DDLIB_SITE" in os.environ
    return (
        f"[{title}]({site(hosted)}book/{name}.html)"
        if linked
        else f"*{title}* (`book/{name}.html` in the book)"
    )


def _cell(kind: str, source: str, role: str = "", **metadata):
    made = getattr(nbformat.v4, f"new_{kind}_cell")(source, metadata=metadata)
    if role:
        made.metadata["assignment"] = role
    return made


def notebook(path: Path, variant: int = 0):
    """Title and notebook to hand out."""
    name = path.stem
    lesson = changed(nbformat.read(path, as_version=4), settings_of(name, variant))
    words, title = Words(lesson), re.search("(?m)^# (.+)$", lesson.cells[0].source)[1]
    cells = [_cell("markdown", SAID.format(title, _told(variant), where(name, title)), "name")]
    cells.append(_cell("code", BEGIN, "begin"))
    told, below, count = "", False, 0
    quiz = questions(ROOT, f"book/{name}")
    for cell in lesson.cells:
        if cell.cell_type == "markdown":
            head, own, _ = cell.source.partition(OWN)
            found = re.findall("^##+ .+$", head, re.MULTILINE)
            told = found[-1] if found and not below else told
            if own:
                below, told = True, ""
                cells += _formulas(words) + _quiz(words, quiz)
                cells.append(_cell("markdown", OWN.strip()))
                texts = asked(lesson)
        elif below and is_starter(cell):
            count += 1
            cells.append(_cell("markdown", words.plain(texts[count - 1])))
            cells.append(_cell("code", cell.source, f"answer-{count}"))
        elif below and is_check(cell):
            source = JUDGE.sub("", cell.source).strip("\n")
            source = f"from judge import check\n\n{source}"
            cells.append(_cell("code", source, f"check-{count}"))
            cells.append(_cell("markdown", HOW.format(count), f"how-{count}"))
        elif is_open(cell):
            role = "settings" if CHANGE_THIS in cell.metadata.get("tags", ()) else ""
            told += f"\n\n{LEAVE}" * bool(role)
            cells += [_cell("markdown", told)] if told else []
            cells.append(_cell("code", cell.source, role))
            figure = cell.metadata.get("mystnb", {}).get("figure")
            if figure in words.figures:
                cells.append(_cell("markdown", words.caption(figure)))
            told = ""
    for k, cell in enumerate(cells):
        cell["id"] = cell.metadata.get("assignment", f"cell-{k}")
    known = {"lesson": name, "variant": variant, "questions": count}
    metadata = {**lesson.metadata, "assignment": known}
    return title, nbformat.from_dict({**lesson, "metadata": metadata, "cells": cells})


def _told(variant: int) -> str:
    return f", variant {variant}" if variant else ""


def _formulas(words: Words) -> list:
    texts = [*words.given()]
    return [_cell("markdown", "\n\n".join(["## Formulas of the lesson", *texts]))] if texts else []


def _quiz(words: Words, quiz: list[dict]) -> list:
    if not quiz:
        return []
    texts = [QUIZ]
    for k, one in enumerate(quiz, 1):
        choices = "\n".join(f"- **{a['letter']}.** {a['text']}" for a in one["answers"])
        texts += [f"**{k}.** {one['question']}", choices]
    empty = ", ".join(f'{k}: ""' for k in range(1, len(quiz) + 1))
    source = f'choices = {{{empty}}}  # one letter each, like "A"'
    return [_cell("markdown", "\n\n".join(texts)), _cell("code", source, "quiz")]


def right_letters(name: str) -> dict[int, str]:
    """The right answers of a lesson's quiz."""
    quiz = questions(ROOT, f"book/{name}")
    return {
        k: next(a["letter"] for a in one["answers"] if a.get("right"))
        for k, one in enumerate(quiz, 1)
    }


def slips(one: Solved) -> Iterator[tuple[str, str]]:
    """Wrong answers that are to be expected, and what the judge says to each."""
    for slip, why in one.asked.slips:
        these = slip.these if isinstance(slip, OneOf) else [slip]
        for wrong in these:
            if isinstance(wrong, Between) and np.ndim(wrong.low) == 0:
                yield _range(wrong), f"Wrong: {why}"
            elif isinstance(wrong, MultipleOf) or callable(wrong):
                yield "*an answer with this fault*", f"Wrong: {why}"
            elif np.isnan(
                np.asarray(wrong, dtype=float) if not isinstance(wrong, str) else 0
            ).any():
                said = ", ".join("any" if np.isnan(x) else f"{x:g}" for x in wrong)
                yield f"`{said}`", f"Wrong: {why}"
            else:
                said = one.told(wrong)
                if said.startswith("Wrong"):  # another setting may make a slip right
                    yield f"`{shown(wrong)}`", said
    yield "*anything else*", f"Wrong: {one.asked.otherwise}"


def _range(these: Between) -> str:
    low, high = these.low, these.high
    if not np.isfinite(high):
        return f"above `{low:.6g}`" if np.isfinite(low) else "*all others*"
    return f"`{low:.6g}` to `{high:.6g}`" if np.isfinite(low) else f"below `{high:.6g}`"


def shown(answer) -> str:
    """An answer in a line."""
    if isinstance(answer, str):
        return f'"{answer}"'
    if callable(answer):
        return "a function"
    flat = np.ravel(np.asarray(answer, dtype=float))
    told = ", ".join(f"{x:.6g}" for x in flat[:6])
    return told if flat.size <= 6 else f"{told}, ... ({flat.size} numbers)"


def key(path: Path, variant: int) -> str:
    """For who teaches: right and wrong answers of a variant, and what to say."""
    name = path.stem
    lesson, settings = nbformat.read(path, as_version=4), settings_of(name, variant)
    words = Words(lesson)
    title = re.search("(?m)^# (.+)$", lesson.cells[0].source)[1]
    parts = [f"# {title}{_told(variant)}: the key", "Keep this file: it has the answers."]
    if settings:
        code = "\n".join(v if k == "import" else f"{k} = {v}" for k, v in settings.items())
        parts.append(f"Settings of this variant:\n\n```python\n{code}\n```")
    explained = explanations(lesson)
    for number, (text, one) in enumerate(zip(asked(lesson), solve(path, settings)), 1):
        rows = "\n".join(f"| {wrong} | {said} |" for wrong, said in slips(one))
        parts += [
            f"## Question {number}",
            _quoted(words, text),
            f"**{_which(one)}:** `{shown(one.answer)}` {one.asked.unit}".rstrip(),
            f"The judge says: {one.said}",
            f"**What to say.** {_quoted(words, explained[number - 1])}",
            f"```python\n{one.code}\n```",
            "What fits within the tolerance is right; of the lines below the first counts.",
            f"| a wrong answer | the judge says |\n| --- | --- |\n{rows}",
        ]
    for k, one in enumerate(questions(ROOT, f"book/{name}"), 1):
        parts += ["## Check yourself"] * (k == 1) + [f"**{k}.** {one['question']}"]
        parts.append(
            "\n".join(f"- **{a['verdict']}** *{a['text']}* {a['why']}" for a in one["answers"])
        )
    return "\n\n".join(parts) + "\n"


def _which(one: Solved) -> str:
    several = isinstance(one.asked.right, OneOf) or callable(one.asked.right)
    return "One of the right answers" if several else "The answer"


def explanations(lesson) -> list[str]:
    """The words of the solutions, without their code."""
    every = "\n\n".join(c.source for c in lesson.cells if c.cell_type == "markdown")
    folds = FOLD.findall(every.partition(OWN)[2])
    told = [fold.partition("</summary>")[2].removesuffix("</details>") for fold in folds]
    return [re.sub(r"(?s)```python\n.*?```", "", text).strip() for text in told]


def _quoted(words: Words, text: str) -> str:
    """Text with roles, where numbers of the book's are left out, and tables of them."""
    text = re.sub(r"\{glue:text\}`[^`]+`", "…", text)
    tables = re.compile(r"(?m)(?:^\|.*\n?)+")
    text = tables.sub(lambda t: "(The lesson has a table here.)\n" if "…" in t[0] else t[0], text)
    return words.plain(text)


def write(
    lesson: str, variant: int = 0, to: Path = MADE, root: Path = ROOT, keys: bool = True
) -> list[Path]:
    """Make the folder of a lesson, or those of all, each with its key beside it.

    Of all, lessons without variants are made as they stand in the book.
    """
    known = lessons(root)
    if lesson not in {"all", *known}:
        raise ValueError(f"LESSON must be all or one of {', '.join(known)}; got {lesson!r}")
    made = []
    for name in [*known] if lesson == "all" else [lesson]:
        try:
            settings_of(name, variant)
            number = variant
        except ValueError:
            if lesson != "all":
                raise
            number = 0
        made.append(folder(known[name], number, to / f"{name}{_dash(number)}", root))
        if keys:
            text = key(known[name], number)
            (to / f"KEY-{name}{_dash(number)}.md").write_text(text, encoding="utf-8")
    return made


def _dash(variant: int) -> str:
    return f"-variant-{variant}" if variant else ""


def folder(path: Path, variant: int, to: Path, root: Path = ROOT) -> Path:
    """What is handed out: notebook, judge, package, data, how to run it."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    (torch,) = project["optional-dependencies"]["learning"]
    needs = [*project["dependencies"], torch, "jupyterlab"]
    name, (title, made) = path.stem, notebook(path, variant)
    shutil.rmtree(to, ignore_errors=True)
    shutil.copytree(root / "ddlib", to / "ddlib", ignore=lambda *_: ["__pycache__"])
    shutil.copy(root / "LICENSE", to)
    shutil.copy(root / "book" / (ENGINE.replace(".", "/") + ".py"), to)
    (to / "judge.py").write_text(judge_module(name, root), "utf-8")
    (to / "README.md").write_text(
        READ_ME.format(title, _told(variant), name, f'"{torch}"'), "utf-8"
    )
    (to / "requirements.txt").write_text("\n".join(needs) + "\n", "utf-8")
    read = re.findall(r"data/([\w.-]+)", "\n".join(c.source for c in made.cells))
    if read:  # with the licences
        data = root / "book" / "data"
        spare = {p.name for p in data.iterdir() if p.suffix in {".csv", ".npz"}} - {*read}
        shutil.copytree(data, to / "data", ignore=shutil.ignore_patterns(*spare))
    nbformat.write(made, to / f"{name}.ipynb")
    return to


def main() -> str:
    parser = argparse.ArgumentParser()
    parser.add_argument("lesson")
    parser.add_argument("variant", nargs="?", default="0")
    given = parser.parse_args()
    if not re.fullmatch(r"\d*", given.variant):
        raise ValueError(f"VARIANT must be a whole number, 0 or above; got {given.variant!r}")
    made = write(given.lesson, int(given.variant or 0))
    return "\n".join(
        f"==> {one.relative_to(ROOT)}, and KEY-{one.name}.md beside it" for one in made
    )


if __name__ == "__main__":
    try:
        print(main())
    except ValueError as error:
        sys.exit(f"==> {error}")
