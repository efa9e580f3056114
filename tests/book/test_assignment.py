"""Assignments: a folder that needs nothing else, where checks judge and no solution is left."""

import json
import re
import subprocess
import sys

import nbformat
import pytest
from book_pages import ROOT, WALK
from chapter_rules import code_of, is_check, is_starter
from open_cells import exercises, lesson

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import assignment

LESSONS = [page.removeprefix("book/") for page in WALK]
QUICK = ("dynamics", "window-size")
# What a notebook does: its cells one after the other, and what each of them prints.
RUN = """
import contextlib, io, json, sys
import matplotlib
matplotlib.use("Agg")
sys.path.insert(0, "")  # as a kernel has it
space = {"__name__": "__main__"}
told = []
for source in json.load(sys.stdin):
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(source, space)
    told.append(printed.getvalue())
import ddlib, judge
print(json.dumps([told, ddlib.__file__, "workshop" in sys.modules]))
"""


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("assignments")
    assert {path.name for path in assignment.write("all", folder)} >= set(LESSONS)
    return folder


def read(folder, name):
    return nbformat.read(folder / name / f"{name}.ipynb", as_version=4)


def test_every_question_is_there_and_no_solution(handed_out):
    for name in LESSONS:
        made, found = read(handed_out, name), exercises(f"book/{name}")
        nbformat.validate(made)
        starters = [each.starter for each in found]
        assert starters == [cell.source for cell in made.cells if is_starter(cell)]
        assert sum(map(is_check, made.cells)) == len(found)
        texts = [cell.source for cell in made.cells]
        assert sum(bool(re.match(r"\*\*\d+\. ", text)) for text in texts) == len(found), name
        everything = "\n".join([*texts, (handed_out / name / "judge.py").read_text("utf-8")])
        code = "\n".join(cell.source for cell in code_of(lesson(f"book/{name}")))
        for line in (line for exercise in found for line in exercise.solution.splitlines()):
            assert line.strip() in code or line.strip() not in everything, (name, line)
        assert not re.search(r"<details|Solution|workshop|\{[\w:-]+\}`", everything), name


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.slow] * (n not in QUICK)) for n in LESSONS]
)
def test_it_runs_alone_and_judges(handed_out, name, tmp_path):
    """In a process that finds neither the book nor the repository's ddlib.

    As handed out a check says "in place of the dots"; with a solution put in, "Right".
    """
    found, cells, answers = exercises(f"book/{name}"), [], []
    for cell in read(handed_out, name).cells:
        cells += [cell.source] * (cell.cell_type == "code")
        if is_check(cell):
            answers.append((len(cells) - 1, len(cells) + 1))
            cells += [found[len(answers) - 1].solution, cell.source, "print(mine)"]
    done = subprocess.run(
        [sys.executable, "-c", RUN], input=json.dumps(cells), capture_output=True, text=True,
        cwd=handed_out / name, env={"PATH": "", "HOME": str(tmp_path), "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    told, package, book = json.loads(done.stdout.splitlines()[-1])
    assert package.startswith(str(handed_out)) and not book
    assert len(answers) == len(found) >= 3
    for before, after in answers:
        assert "in place of the dots" in told[before] and told[after].startswith("Right")
        assert told[after + 1].strip() == "Ellipsis"  # no answer is judged twice


def test_what_is_missing_is_named(handed_out):
    """The first cell says what is not there; so does the command."""
    first = next(c for c in read(handed_out, "dynamics").cells if c.cell_type == "code")
    with pytest.raises(ModuleNotFoundError, match=r"judge is not there: see README\.md"):
        exec(first.source, {})
    with pytest.raises(ValueError, match=r"LESSON must be all or one of dynamics, .*; got 'door'"):
        assignment.write("door")
