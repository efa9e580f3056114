"""Assignments for nbgrader: `make assignment LESSON=window-networks ROSTER=students.csv`.

Each is a folder that needs nothing else: open code, formulas, questions, a quiz, a judge, `ddlib`.
In a course's `source` it has solutions and hidden tests, in nbgrader's `release` none. `copies` has
one for each student of a roster, with settings of their own; `keys`, for who teaches, have what is
right with these, wrong answers that are to be expected, and what to say to each.
"""

from __future__ import annotations

import argparse
import ast
import csv
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path

import nbformat
import numpy as np
from dd_lessons import chapters
from dd_public import repository, site
from dd_quiz import OWN, questions
from dd_reader import ANCHOR, CHANGE_THIS, ROLE, TARGET
from handed_in import ALL, SETTINGS, own_copy, release
from solved import (
    FOLD,
    ROOT,
    Solved,
    exercises,
    is_check,
    is_open,
    is_starter,
    settings_of,
    solve,
    variant_of,
)

from workshop.chapters.exercises import Between, MultipleOf, OneOf

PATHS = [ROOT / "book", ROOT / "book" / "_ext"]
TUTORIAL = "use-it-on-your-arm"
EQUATION = re.compile(r"(?ms)^\$\$\n(.*?)\n\$\$[ \t]*(?:\(([\w-]+)\))?[ \t]*$")
JUDGE = re.compile(r"from ((?:workshop|beyond)\.chapters\.\w+) import check\b")
ENGINE = "workshop.chapters.exercises"
SAID = (
    f"# {{}}: {ALL}\n\nThis is the code of the lesson {{}}. Run it from the top. "
    "Your questions stand at the end, after the lesson's formulas."
)
BEGIN = """from importlib.util import find_spec

for needed in ("ddlib", "judge", "numpy", "scipy", "sympy", "torch", "control", "matplotlib"):
    if find_spec(needed) is None:
        raise ModuleNotFoundError(f"{needed} is not there: see README.md beside this notebook.")"""
HOW = "**How I found it ({}).** *Say why this is the answer, and how a wrong one would show.*"
POINTS = {"check": 1, "how": 3}  # for each question; the quiz has one for each of its own
LEAVE = "These are the settings of your assignment. Leave them as they are."
QUIZ = "## Check yourself\n\nWrite one letter for each question into the cell below."
MARK = """# Your letters are counted after you have handed in.
### BEGIN HIDDEN TESTS
right = {}
sum(str(choices.get(k)).strip().upper() == letter for k, letter in right.items())
### END HIDDEN TESTS"""
CONFIG = """import sys

sys.path += {}
from handed_in import configure

configure(get_config())
"""
READ_ME = """# {0}: an assignment

With Python 3.11 or newer, in this folder:

    python -m venv .venv
    .venv/bin/python -m pip install -r requirements.txt
    .venv/bin/python -m jupyterlab {1}.ipynb

(On Windows `.venv\\Scripts\\python` in place of `.venv/bin/python`.)

On Linux, pip takes a PyTorch of several GB. For the smaller one, made for the CPU, run this before
the second line: `.venv/bin/python -m pip install {2} --index-url https://download.pytorch.org/whl/cpu`

Run the cells from the top. Put each answer in place of the dots; the cell below judges it. You
may try as often as you like: change the answer, then run both cells. Below each question, say how
you found it. In the end run all cells, save, and hand in the notebook alone, under its own name.
Whoever marks it runs it anew, from the top; only your answers, your words and cells that you added
are taken from it.

The judge is judge.py, which asks, and exercises.py, which compares. Both can be read, so if you
read them, you see what is right. Your explanation is what counts.
"""


def lessons() -> dict[str, Path]:
    """Notebooks whose exercises are judged, by name, but for the tutorial on one's own arm."""
    judged = (p for p in chapters(ROOT) if JUDGE.search(p.read_text("utf-8")))
    return {p.stem: p for p in judged if p.stem != TUTORIAL}


def names(node: ast.AST, use: str) -> set[str]:
    """What a statement of a module stores, or loads from elsewhere."""
    every = {"Load": set(), "Store": {a.arg for a in ast.walk(node) if isinstance(a, ast.arg)}}
    for name in (n for n in ast.walk(node) if isinstance(n, ast.Name)):
        every[type(name.ctx).__name__].add(name.id)
    own = every["Load"] - every["Store"] if use == "Load" else every["Store"]
    return {node.name} if hasattr(node, "name") and use == "Store" else own


def judge(module: str, wanted: set[str]) -> tuple[list[str], list[str]]:
    """What some definitions of a module of the book's need: imports, and code as it stands."""
    text = (ROOT / "book" / (module.replace(".", "/") + ".py")).read_text(encoding="utf-8")
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
                theirs = judge(home, {a.name for a in node.names})
                imports, code = imports + theirs[0], code + theirs[1]
                continue
            imports += [ast.unparse(node)] * bool(node.names)
        elif wanted & names(node, "Store"):
            first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
            code.append("\n".join(text.splitlines()[first - 1 : node.end_lineno]))
    return imports, code


def judge_module(name: str) -> str:
    """The file judge.py of a lesson."""
    module = JUDGE.search(lessons()[name].read_text("utf-8"))[1]
    imports, code = judge(module, {"check"})
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


def _cell(kind: str, source: str, name: str = "", answer=False, points=None, **metadata):
    """A cell; of one with a name nbgrader takes the answer, counts the points, or locks it."""
    made = getattr(nbformat.v4, f"new_{kind}_cell")(source, metadata=metadata)
    made["id"] = name
    if name:
        known = {"grade_id": name, "solution": answer, "locked": not answer, "task": False}
        scored = {} if points is None else {"points": points}
        grade = {"grade": points is not None, "schema_version": 3}
        made.metadata["nbgrader"] = {**known, **grade, **scored}
    return made


def _between(what: str, source: str) -> str:
    """What nbgrader takes out before it hands out a notebook."""
    return f"### BEGIN {what}\n{source}\n### END {what}"


def notebook(path: Path, varied: bool = False):
    """Title and notebook with solutions, from which nbgrader makes that to hand out."""
    name = path.stem
    lesson = nbformat.read(path, as_version=4)
    words, title = Words(lesson), re.search("(?m)^# (.+)$", lesson.cells[0].source)[1]
    cells = [
        _cell("markdown", SAID.format(title, where(name, title))),
        _cell("code", BEGIN, "begin"),
    ]
    told, below, count = "", False, 0
    solutions, explained = exercises(lesson), explanations(lesson)
    for cell in lesson.cells:
        if cell.cell_type == "markdown":
            head, own, _ = cell.source.partition(OWN)
            found = re.findall("^##+ .+$", head, re.MULTILINE)
            told = found[-1] if found and not below else told
            if own:
                below, told = True, ""
                cells += _formulas(words) + _quiz(words, questions(ROOT, f"book/{name}"))
                cells.append(_cell("markdown", OWN.strip()))
                texts = asked(lesson)
        elif below and is_starter(cell):
            cells.append(_cell("markdown", words.plain(texts[count])))
            answer = _between("SOLUTION", solutions[count].solution.strip())
            cells.append(_cell("code", f"{cell.source}\n{answer}", cell.id, answer=True))
            count += 1
        elif below and is_check(cell):
            test = _between("HIDDEN TESTS", "from exercises import verdict\n\nassert verdict.right")
            source = f"{JUDGE.sub('from judge import check', cell.source)}\n{test}"
            cells.append(_cell("code", source, f"check-{count}", points=POINTS["check"]))
            said = _between("SOLUTION", _quoted(words, explained[count - 1]))
            text = f"{HOW.format(count)}\n\n{said}"
            cells.append(_cell("markdown", text, f"how-{count}", True, POINTS["how"]))
        elif is_open(cell):
            settings = CHANGE_THIS in cell.metadata.get("tags", ())
            told += f"\n\n{LEAVE}" * settings
            cells += [_cell("markdown", told)] if told else []
            if settings:  # of a student's own, so not locked by nbgrader
                own = {"tags": [CHANGE_THIS], "editable": False, "deletable": False}
                cells.append(_cell("code", cell.source, **own))
                cells[-1]["id"] = SETTINGS
            else:
                cells.append(_cell("code", cell.source, f"code-{len(cells)}"))
            figure = cell.metadata.get("mystnb", {}).get("figure")
            if figure in words.figures:
                cells.append(_cell("markdown", words.caption(figure)))
            told = ""
    for k, cell in enumerate(cells):
        cell["id"] = cell["id"] or f"cell-{k}"
    known = {"lesson": name, "varied": varied, "questions": count}
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
    right = {
        k: next(a["letter"] for a in one["answers"] if a.get("right"))
        for k, one in enumerate(quiz, 1)
    }
    answer = _between("SOLUTION", f"choices = {right}")
    source = f'choices = {{{empty}}}  # one letter each, like "A"\n{answer}'
    return [
        _cell("markdown", "\n\n".join(texts)),
        _cell("code", source, "quiz", answer=True),
        _cell("code", MARK.format(right), "quiz-marks", points=len(quiz)),
    ]


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


def write(lesson: str, course: Path, students: Iterable[str] = (), keys: bool = True) -> list[Path]:
    """Make a lesson's assignment, or all: for everybody alike, or for students of a roster.

    Returns the folders to hand out.
    """
    known = lessons()
    if lesson not in {"all", *known}:
        raise ValueError(f"LESSON must be all or one of {', '.join(known)}; got {lesson!r}")
    course.mkdir(parents=True, exist_ok=True)
    (course / "nbgrader_config.py").write_text(CONFIG.format([str(p) for p in PATHS]), "utf-8")
    made = []
    for name in [*known] if lesson == "all" else [lesson]:
        folder(known[name], course / "source" / name, varied=bool(students))
        nbgrader(course, "generate_assignment", name, "--force")
        made += [course / "release" / name] if not students else []
        for student in students:
            to = course / "copies" / student / name
            shutil.copytree(course / "release" / name, to, dirs_exist_ok=True)
            nbformat.write(own_copy(release(course, name), student), to / f"{name}.ipynb")
            made.append(to)
        (course / "keys").mkdir(exist_ok=True)
        if students:
            own = {s: settings_of(name, variant_of(name, s)) for s in students}
            lines = (f"{s}: {', '.join(map(' = '.join, own[s].items()))}\n" for s in students)
            (course / "keys" / f"{name}-settings.txt").write_text("".join(lines), "utf-8")
        for variant in {variant_of(name, s) for s in students} or {0} if keys else ():
            to = course / "keys" / f"{name}{f'-variant-{variant}' if variant else ''}.md"
            to.write_text(key(known[name], variant), "utf-8")
    return made


def nbgrader(course: Path, *asked: str) -> str:
    """Run nbgrader in a course's folder; what it said. It looks for alembic on the path."""
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
    how = {"cwd": course, "env": {**os.environ, "PATH": path}, "capture_output": True}
    done = subprocess.run([sys.executable, "-m", "nbgrader", *asked], text=True, **how)
    if done.returncode:
        raise ValueError(f"nbgrader {' '.join(asked)}:\n{done.stderr}")
    return done.stderr


def folder(path: Path, to: Path, varied: bool = False) -> Path:
    """What nbgrader hands out, with solutions: notebook, judge, package, data, how to run it."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    (torch,) = project["optional-dependencies"]["learning"]
    needs = [*project["dependencies"], torch, "jupyterlab"]
    name, (title, made) = path.stem, notebook(path, varied)
    shutil.rmtree(to, ignore_errors=True)
    shutil.copytree(ROOT / "ddlib", to / "ddlib", ignore=lambda *_: ["__pycache__"])
    shutil.copy(ROOT / "LICENSE", to)
    shutil.copy(ROOT / "book" / (ENGINE.replace(".", "/") + ".py"), to)
    (to / "judge.py").write_text(judge_module(name), "utf-8")
    (to / "README.md").write_text(READ_ME.format(title, name, f'"{torch}"'), "utf-8")
    (to / "requirements.txt").write_text("\n".join(needs) + "\n", "utf-8")
    read = re.findall(r"data/([\w.-]+)", "\n".join(c.source for c in made.cells))
    if read:  # with the licences
        data = ROOT / "book" / "data"
        spare = {p.name for p in data.iterdir() if p.suffix in {".csv", ".npz"}} - {*read}
        shutil.copytree(data, to / "data", ignore=shutil.ignore_patterns(*spare))
    nbformat.write(made, to / f"{name}.ipynb")
    return to


def roster(path: Path) -> list[str]:
    """The students of a file as nbgrader imports it: a column is `id`."""
    with path.open(encoding="utf-8-sig", newline="") as file:
        found = [row.get("id") or "" for row in csv.DictReader(file)]
    wrong = [name for name in found if not re.fullmatch(r"\w[\w.@-]*", name)]
    if wrong or not found:
        raise ValueError(f"ROSTER must have a column id of letters, digits and .@-_; got {wrong}")
    return found


def main() -> str:
    parser = argparse.ArgumentParser()
    parser.add_argument("lesson")
    parser.add_argument("course", type=Path)
    parser.add_argument("roster", nargs="?", default="")
    given = parser.parse_args()
    path = Path(given.roster).absolute() if given.roster else None
    made = write(given.lesson, given.course, roster(path) if path else ())
    if path:
        nbgrader(given.course, "db", "student", "import", str(path))
    return "\n".join(f"==> {one}" for one in made) + f"\n==> Keys in {given.course / 'keys'}"


if __name__ == "__main__":
    try:
        print(main())
    except (ValueError, OSError) as error:
        sys.exit(f"==> {error}")
