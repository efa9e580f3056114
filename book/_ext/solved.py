"""A lesson with other settings, solved: its exercises, right answers, and what the judge says.

Settings are code by name, like {"window": "15"}. They take the place of the values that stand in
the cell *Change this*, or in a cell where an answer goes. Only statements are run on which some
exercise depends, unless the whole lesson is asked for.
"""

from __future__ import annotations

import ast
import io
from collections.abc import Mapping
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import patch
from zlib import crc32

import nbformat
from answers import FOLD, STARTER, exercises, is_check, is_open, is_starter  # noqa: F401
from lessons import CHANGE_THIS, entries

from workshop.chapters import exercises as engine

ROOT = Path(__file__).parents[2]
FILE = ROOT / "book" / "variants.yml"
DATA = ROOT / "book"  # where a lesson finds the folder `data`
IMPORT = "import"  # a setting that is a line of its own, before all others


@dataclass(frozen=True)
class Solved:
    """An exercise with its reference solution run."""

    code: str
    answer: object
    asked: engine.Exercise
    said: str

    def told(self, answer) -> str:
        """What is said to an answer."""
        return printed(lambda: engine.judge(answer, self.asked))

    def takes(self, answer) -> bool:
        return self.told(answer).startswith("Right")


def printed(call) -> str:
    with redirect_stdout(io.StringIO()) as said:
        call()
    return said.getvalue().strip()


def variants(lesson: str) -> list[dict[str, str]] | str:
    """The settings of all variants of a lesson; or why it has none."""
    kept = entries(ROOT, "variants").get(lesson, "variants.yml has no variants of this lesson")
    return (
        kept
        if isinstance(kept, str)
        else [{k: str(v) for k, v in settings.items()} for settings in kept]
    )


def settings_of(lesson: str, variant: int) -> dict[str, str]:
    """The settings of a variant of a lesson; variant 0 is the lesson as it stands."""
    return variants(lesson)[variant - 1] if variant else {}


def variant_of(lesson: str, student: str) -> int:
    """Which variant a student gets: the checksum of both names, so it stays if a roster grows."""
    known = variants(lesson)
    return 0 if isinstance(known, str) else 1 + crc32(f"{lesson} {student}".encode()) % len(known)


def assigned(source: str) -> dict[str, ast.expr]:
    """The names to which a cell's statements assign, with what they assign."""
    found = {}
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign):
            target, value = node.targets[0], node.value
            several = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            pairs = zip(target.elts, value.elts) if several else [(target, value)]
            found |= {t.id: v for t, v in pairs if isinstance(t, ast.Name)}
    return found


def with_settings(source: str, settings: Mapping[str, str]) -> str:
    """A cell's code with other values; its comments stay."""
    lines = source.splitlines()
    spots = [
        (value, settings[name]) for name, value in assigned(source).items() if name in settings
    ]
    for value, code in sorted(spots, key=lambda s: (s[0].lineno, s[0].col_offset), reverse=True):
        first, last = value.lineno - 1, value.end_lineno - 1
        before = lines[first].encode()[: value.col_offset].decode()
        after = lines[last].encode()[value.end_col_offset :].decode()
        lines[first : last + 1] = [f"{before}{code}{after}"]
    first = [settings[IMPORT]] if IMPORT in settings else []
    return "\n".join(first + lines)


def changed(notebook, settings: Mapping[str, str]):
    """A lesson's notebook with other settings."""
    made = nbformat.from_dict(notebook)
    known = {IMPORT} & {*settings}
    for cell in made.cells:
        here = CHANGE_THIS in cell.metadata.get("tags", ())
        if settings and (here or is_starter(cell)):
            known |= assigned(cell.source).keys()
            own = settings if here else {k: v for k, v in settings.items() if k != IMPORT}
            cell.source = with_settings(cell.source, own)
    if unknown := {*settings} - known:
        raise ValueError(f"settings must be names that a lesson sets; got {', '.join(unknown)}")
    return made


class _Uses(ast.NodeVisitor):
    """Names that a statement reads, sets, and those of what it may change in place."""

    def __init__(self, statement: ast.stmt):
        self.reads, self.sets, self.changes = set(), set(), set()
        self.visit(statement)

    def visit_Expr(self, node):
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name):
            self.changes |= {n.id for n in ast.walk(call) if isinstance(n, ast.Name)} - {"print"}
        self.generic_visit(node)

    def visit_Name(self, node):
        (self.reads if isinstance(node.ctx, ast.Load) else self.sets).add(node.id)

    def visit_AugAssign(self, node):
        self.reads |= _base(node.target)
        self.generic_visit(node)

    def visit_alias(self, node):
        self.sets.add(node.asname or node.name.split(".")[0])

    def visit_Call(self, node):
        if isinstance(node.func, ast.Attribute):
            self.changes |= _base(node.func)
        self.generic_visit(node)

    def generic_visit(self, node):
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            self.sets.add(node.name)
        if isinstance(node, (ast.Subscript, ast.Attribute)) and not isinstance(node.ctx, ast.Load):
            self.changes |= _base(node)
        super().generic_visit(node)


def _base(node: ast.AST) -> set[str]:
    while isinstance(node, (ast.Subscript, ast.Attribute)):
        node = node.value
    return {node.id} if isinstance(node, ast.Name) else set()


def needed(statements: list[ast.stmt], wanted: set[str]) -> list[ast.stmt]:
    """Those statements on which some names depend, rather too many than too few."""
    kept, every = [], [_Uses(node) for node in statements]
    modules, inside = set(), {}
    for node, uses in zip(statements, every):
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            modules |= uses.sets
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            inside[node.name] = uses.changes
    for node, uses in zip(reversed(statements), reversed(every)):
        called = (inside[name] for name in uses.changes & inside.keys())
        if (uses.sets | uses.changes.union(*called) - modules) & wanted:
            kept.append(node)
            wanted = wanted | uses.reads
    return kept[::-1]


def solve(
    path: Path, settings: Mapping[str, str] = {}, whole: bool = False, only: int = 0
) -> list[Solved]:
    """Run a lesson with its reference solutions; with that of one exercise, or of all."""
    import matplotlib
    import matplotlib.pyplot as plt

    matplotlib.use("Agg")
    notebook = changed(nbformat.read(path, as_version=4), settings)
    every = exercises(notebook)
    found = every[only - 1 : only] if only else every
    opened = [c.source for c in notebook.cells if is_open(c) and not is_starter(c)]
    statements = [node for source in opened for node in ast.parse(source).body]
    if not whole:
        own = ast.parse("\n".join(code for exercise in found for code in exercise))
        statements = needed(statements, _Uses(own).reads)
    space, solved = {"__name__": "__main__"}, []
    with chdir(DATA), redirect_stdout(io.StringIO()):
        exec(compile(ast.Module(statements, []), str(path), "exec"), space)
        for exercise in found:
            exec(exercise.starter, space)
            exec(exercise.solution, space)
            answer, asked = space["mine"], []

            def keep(mine, exercise, asked=asked, judge=engine.judge):
                asked.append(exercise)
                return judge(mine, exercise)

            with patch.object(engine, "judge", keep):
                said = printed(lambda exercise=exercise: exec(exercise.check, space))
            solved.append(Solved(exercise.solution.strip(), answer, asked[0], said))
    plt.close("all")
    return solved


def differ(solutions: list[list[Solved]]) -> str:
    """How many answers to each exercise are neither the first's nor each other's: "10, 0"."""
    counts = []
    for first, *others in zip(*solutions):
        kept = [first]
        for one in others:
            known = any(one.takes(k.answer) or k.takes(one.answer) for k in kept)
            kept += [] if known else [one]
        counts.append(str(len(kept) - 1))
    return ", ".join(counts)


def apart(first: list[Solved], second: list[Solved]) -> bool:
    """Whether the answers to some exercise are right in first variant alone, each way."""
    return any(not a.takes(b.answer) and not b.takes(a.answer) for a, b in zip(first, second))
