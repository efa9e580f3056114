"""Assignments: a folder that needs nothing else, where checks judge and no solution is left."""

import ast
import json
import re
import subprocess
import sys

import nbformat
import pytest
from book_pages import ROOT
from chapter_rules import code_of, is_check, is_starter
from open_cells import exercises, lesson

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import assignment
import solved
import variants

LESSONS = [*assignment.lessons(ROOT)]
QUICK = ("dynamics", "window-size")
VARIED = [name for name in LESSONS if not isinstance(solved.variants(name), str)]
FAST = ("dynamics", "feedback")  # all their variants, at each run
# Where a question is quick whose answer depends on the settings, and others take long.
ONLY = dict.fromkeys(
    ("adaptive-control", "learning-in-the-loop", "window-networks", "feedforward"), 1
)
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
    made = assignment.write("all", 0, folder, keys=False)
    assert {path.name for path in made} == set(LESSONS)
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
        everything = "\n".join(texts)
        code = "\n".join(cell.source for cell in code_of(lesson(f"book/{name}")))
        for line in (line for exercise in found for line in exercise.solution.splitlines()):
            assert line.strip() in code or line.strip() not in everything, (name, line)
        assert not re.search(r"<details|Solution|workshop|\{[\w:-]+\}`", everything), name


def test_students_find_what_they_need(handed_out):
    """No heading without something below it; formulas, a quiz, room to explain, a plain judge."""
    for name in LESSONS:
        made, folder = read(handed_out, name), handed_out / name
        for cell, below in zip(made.cells, [*made.cells[1:], None]):
            if cell.cell_type == "markdown" and re.fullmatch(r"#+ .+", cell.source.strip()):
                assert below is not None and not re.match(r"#{1,2} ", below.source), cell.source
        roles = [cell.metadata.get("assignment", "") for cell in made.cells]
        count = made.metadata["assignment"]["questions"]
        for kind in ("answer", "check", "how"):
            assert [r for r in roles if r.startswith(kind)] == [
                f"{kind}-{k}" for k in range(1, count + 1)
            ]
        assert assignment.LEAVE in made.cells[roles.index("settings") - 1].source
        assert roles.count("settings") == 1 and roles.count("quiz") == 1, name
        text = "\n".join(cell.source for cell in made.cells)
        shown = [*map(int, re.findall(r"\\tag\{(\d+)\}", text))]
        assert shown == [*range(1, len(shown) + 1)]
        assert {*map(int, re.findall(r"Eq\. \((\d+)\)", text))} <= {*shown}, name
        figures = {*re.findall(r"Figure \d+(?!-)\b", text)}
        assert {*re.findall(r"\*\*(Figure \d+)\.\*\*", text)} == figures, name
        source = (folder / "judge.py").read_text("utf-8")
        assert not re.search(r"exec|base64|zlib|mine = ", source) and "def _exercise" in source
        assert ast.get_docstring(ast.parse(source))
        assert "torch" in (folder / "requirements.txt").read_text("utf-8")
        assert "whl/cpu" in (folder / "README.md").read_text("utf-8")


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
    assert len(answers) == len(found) >= 1
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
    with pytest.raises(ValueError, match=r"VARIANT must be 0 to \d+ for feedback; got 99"):
        assignment.write("feedback", 99)
    with pytest.raises(ValueError, match=r"VARIANT must be 0 to 0 for verdict \(its .*; got 1"):
        assignment.write("verdict", 1)


def test_a_lesson_has_ten_variants_or_says_why_not():
    assert len(VARIED) > 10 and {*FAST} <= {*VARIED}
    for name in LESSONS:
        known = solved.variants(name)
        assert len(known) >= 10 if name in VARIED else len(known.split()) > 5, name


@pytest.mark.parametrize("name", FAST)
def test_variants_are_solved_and_their_answers_differ(name):
    assert not variants.mistakes(name, whole=False)


@pytest.mark.parametrize("name", [name for name in VARIED if name not in FAST])
def test_a_variant_of_each_lesson_is_solved(name):
    settings = solved.settings_of(name, 7)
    found = solved.solve(variants.path(name), settings, only=ONLY.get(name, 0))
    assert found and all(one.said.startswith("Right") for one in found)


def test_settings_take_the_place_of_others():
    cell = "a, b = (1.0, 2.0), 3  # m, 1\nc = f(4)  # as ü\nd = 5"
    made = solved.with_settings(cell, {"b": "33", "c": "g(1)"})
    assert made == "a, b = (1.0, 2.0), 33  # m, 1\nc = g(1)  # as ü\nd = 5"
    made = solved.with_settings(cell, {"a": "(7.0, 8.0)", "import": "import g"})
    assert made.splitlines()[:2] == ["import g", "a, b = (7.0, 8.0), 3  # m, 1"]
    notebook = lesson("book/feedback")
    with pytest.raises(ValueError, match="settings must be names that a lesson sets; got loose"):
        solved.changed(notebook, {"loose": "1"})


def test_a_key_lies_beside_a_variant(tmp_path):
    """Its answer is the rule's, F / (1.5 T), with the settings of that variant."""
    (made,) = assignment.write("feedback", 7, tmp_path)
    assert made.name == "feedback-variant-7"
    key = (tmp_path / "KEY-feedback-variant-7.md").read_text("utf-8")
    settings = solved.settings_of("feedback", 7)
    limit = ast.literal_eval(settings["viscous"])[0] / (1.5 * float(settings["period"]))
    assert f"`{limit:.6g}` N m/rad" in key and "{" not in re.sub(r"\$.*?\$|```.*?```", "", key)
    assert f"| `{3 * limit:.6g}` | Wrong: that is the limit without the delay." in key
    notebook = (made / "feedback.ipynb").read_text("utf-8")
    assert f"period = {settings['period']}  # s between" in notebook
    assert not [path for path in made.rglob("*") if "KEY" in path.name]
    assert key.count("The judge says: Right") == len(exercises("book/feedback"))
    letters = assignment.right_letters("feedback")
    assert [*letters.values()] == re.findall(r"\*\*([A-E]) is right\.\*\*", key)
