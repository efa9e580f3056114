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
# What a notebook does: its cells one after the other, and what each prints. Each has a process of
# its own, forked from one that has imported the libraries of others and nothing else.
RUN = """
import contextlib, io, json, multiprocessing, os, sys, traceback
import control, matplotlib.pyplot, scipy.signal, sympy, torch
matplotlib.use("Agg")
assert not {"ddlib", "judge", "workshop"} & set(sys.modules)

def run(cells, pipe):
    sys.path.insert(0, "")  # as a kernel has it
    space, told = {"__name__": "__main__"}, []
    try:
        for source in cells:
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                exec(source, space)
            told.append(printed.getvalue())
        import ddlib, judge
        pipe.send([told, ddlib.__file__, "workshop" in sys.modules, ""])
    except BaseException:
        pipe.send([told, "", False, traceback.format_exc()])

for line in sys.stdin:
    folder, cells = json.loads(line)
    os.chdir(folder)
    ours, theirs = multiprocessing.Pipe(False)
    process = multiprocessing.get_context("fork").Process(target=run, args=(cells, theirs))
    process.start()
    theirs.close()
    try:
        answer = ours.recv()
    except EOFError:
        answer = [[], "", False, "the process ended"]
    process.join()
    print(json.dumps(answer), flush=True)
"""


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("assignments")
    assert {path.name for path in assignment.write("all", folder)} >= set(LESSONS)
    return folder


@pytest.fixture(scope="module")
def cells_run(tmp_path_factory):
    """``cells_run(folder, cells)`` in a process that finds the folder and installed packages alone.

    What each cell prints, where ddlib was found, whether the book was; the error if there is one.
    """
    home = tmp_path_factory.mktemp("home")
    env = {"PATH": "", "HOME": str(home), "OMP_NUM_THREADS": "1"}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-c", RUN], cwd=home, env=env, **pipes) as server:

        def run(folder, cells):
            print(json.dumps([str(folder), cells]), file=server.stdin, flush=True)
            return json.loads(server.stdout.readline())

        yield run
        server.stdin.close()


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
def test_it_runs_alone_and_judges(handed_out, name, cells_run):
    """In a process that finds neither the book nor the repository's ddlib.

    As handed out a check says "in place of the dots"; with a solution put in, "Right".
    """
    found, cells, answers = exercises(f"book/{name}"), [], []
    for cell in read(handed_out, name).cells:
        cells += [cell.source] * (cell.cell_type == "code")
        if is_check(cell):
            answers.append((len(cells) - 1, len(cells) + 1))
            cells += [found[len(answers) - 1].solution, cell.source, "print(mine)"]
    told, package, book, error = cells_run(handed_out / name, cells)
    assert not error, error
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
