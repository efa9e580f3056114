"""Assignments: a folder that needs nothing else, where checks judge and no solution is left."""

import ast
import csv
import json
import re
import subprocess
import sys
from itertools import pairwise

import nbformat
import pytest
from book_pages import ROOT
from chapter_rules import code_of, is_starter
from nbgrader.api import Gradebook
from open_cells import SHORT, exercises, lesson

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import assignment
import handed_in
import lessons
import solved
import variants
from lessons import entries

LESSONS = [*assignment.lessons()]
QUICK = ("dynamics", "window-size")
VARIED = [name for name in LESSONS if not isinstance(solved.variants(name), str)]
FAST = ("dynamics", "feedback")  # all their variants, at each run
SLOW = ("adaptive-control", "learning-in-the-loop")  # of which a variant's first question is asked
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
    for name, path in assignment.lessons().items():
        assignment.folder(path, folder / name)
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


def seen(source):
    """A cell as a student gets it."""
    return re.sub(r"(?ms)^### BEGIN ([A-Z ]+)\n.*?^### END \1\n?", "", source)


def test_every_question_is_there_and_no_solution(handed_out):
    for name in LESSONS:
        made, found = read(handed_out, name), exercises(f"book/{name}")
        nbformat.validate(made)
        starters = [cell for cell in made.cells if is_starter(cell)]
        assert [e.starter for e in found] == [seen(c.source).strip() for c in starters], name
        checks = [cell for cell in made.cells if cell.id.startswith("check-")]
        assert len(checks) == len(found)
        assert all(
            "HIDDEN TESTS\nfrom exercises import verdict\n" in cell.source for cell in checks
        )
        texts = [seen(cell.source) for cell in made.cells]
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
        names = [cell.id for cell in made.cells]
        count = made.metadata["assignment"]["questions"]
        for kind in ("check", "how"):
            assert [n for n in names if n.startswith(f"{kind}-")] == [
                f"{kind}-{k}" for k in range(1, count + 1)
            ]
        assert assignment.LEAVE in made.cells[names.index("settings") - 1].source
        assert names.count("settings") == 1 and names.count("quiz") == 1, name
        text = "\n".join(cell.source for cell in made.cells)
        shown = [*map(int, re.findall(r"\\tag\{(\d+)\}", text))]
        assert shown == [*range(1, len(shown) + 1)]
        text = seen(text)
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

    As handed out a check says "in place of the dots"; with a solution put in, "Right", and what
    nbgrader runs in secret agrees. Training is short.
    """
    cells, answers = [], []
    for cell in (c for c in read(handed_out, name).cells if c.cell_type == "code"):
        if cell.id.startswith("check-"):
            solution = cells.pop()
            cells += [seen(solution), seen(cell.source), solution, cell.source, "print(mine)"]
            answers.append(len(cells))
        else:
            short = SHORT.get(name, "") if cell.id == "settings" else ""
            cells.append(f"{cell.source}\n{short}")
    told, package, book, error = cells_run(handed_out / name, cells)
    assert not error, error
    assert package.startswith(str(handed_out)) and not book
    assert len(answers) == len(exercises(f"book/{name}")) >= 1
    for end in answers:
        before, _, after, left = told[end - 4 : end]
        assert "in place of the dots" in before and after.startswith("Right")
        assert left.strip() == "Ellipsis"  # no answer is judged twice


def test_what_is_missing_is_named(handed_out, tmp_path):
    """The first cell says what is not there; so does the command."""
    first = next(c for c in read(handed_out, "dynamics").cells if c.cell_type == "code")
    with pytest.raises(ModuleNotFoundError, match=r"judge is not there: see README\.md"):
        exec(first.source, {})
    with pytest.raises(ValueError, match=r"LESSON must be all or one of dynamics, .*; got 'door'"):
        assignment.write("door", tmp_path)
    (tmp_path / "roster.csv").write_text("id,email\nada,\n../bo,\n", "utf-8")
    with pytest.raises(ValueError, match=r"ROSTER must have a column id .*; got \['\.\./bo'\]"):
        assignment.roster(tmp_path / "roster.csv")
    with pytest.raises(ValueError, match="FOLDER must have work files in it"):
        handed_in.collect(tmp_path, tmp_path)


def test_a_lesson_has_ten_variants_or_says_why_not():
    assert len(VARIED) > 10 and {*FAST} <= {*VARIED}
    for name in LESSONS:
        known = solved.variants(name)
        assert len(known) >= 10 if name in VARIED else len(known.split()) > 5, name


@pytest.mark.parametrize("name", FAST)
def test_variants_are_solved_and_their_answers_differ(name):
    assert not variants.mistakes(name, whole=False)


TEACHING, LABS = ((ROOT / "book" / f"{p}.md").read_text("utf-8") for p in ("teaching", "labs"))
EXERCISE = re.compile(r"\{exercise\}`([\w-]+): ([\d, ]+)`")
QUICK_ONES = re.compile(r"\*\*For the quick ones:\*\*[^*]*")  # without a mark, for all alike


def named(text):
    """Exercises that a page names, each a lesson and a number."""
    return [(name, int(n)) for name, numbers in EXERCISE.findall(text) for n in numbers.split(", ")]


HOMEWORK = sorted({*named(TEACHING + QUICK_ONES.sub("", LABS))})


def test_homework_has_answers_that_differ():
    """By the table on the page, four of ten or more."""
    counts = {name: said.split(", ") for name, said in entries(ROOT, "variants")["differ"].items()}
    assert {*counts} == {*VARIED}
    assert min(int(counts[name][number - 1]) for name, number in HOMEWORK) >= 4


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in VARIED if name not in FAST])
def test_a_variant_is_solved_and_homework_has_another_answer(name):
    """Right is what its own settings give; what the book prints is wrong."""
    homework = [number for lesson, number in HOMEWORK if lesson == name]
    only = 1 if name in SLOW else 0
    own = solved.solve(variants.path(name), solved.settings_of(name, 7), only=only)
    assert own and all(one.said.startswith("Right") for one in own)
    book = solved.solve(variants.path(name)) if homework else ()
    assert not [number for number in homework if own[number - 1].takes(book[number - 1].answer)]


def test_a_lab_s_points_and_marks_are_those_of_its_questions():
    """And a lab sets what its plan has; its minutes add up."""
    plans = re.split(r"^## ", LABS, flags=re.M)
    plans = [plan.partition("**They hand in**")[0] for plan in plans if plan.startswith("Lab ")]
    rows = re.findall(r"^\| (\d) \| (.*?) \| (\d+) \| (\d+) \| (\d+) \|$", LABS, re.M)
    assert len(plans) == len(rows) == 3
    for plan, (_, asked, *points) in zip(plans, rows):
        assert named(plan) == named(asked)
        quiz = sum(
            len(lessons.questions(ROOT, f"book/{name}")) for name, _ in EXERCISE.findall(asked)
        )
        each = [len(named(asked)) * assignment.POINTS[kind] for kind in ("check", "how")]
        assert [*each, quiz] == [int(n) for n in points]
        times = [tuple(map(int, t)) for t in re.findall(r"^\| (\d+)–(\d+) \|", plan, re.M)]
        assert times[0][0] == 0 and times[-1][1] == 90
        assert all(one[1] == other[0] for one, other in pairwise(times))
    told = re.findall(r"(\d+) of (\d+) \| (\d+) of (\d+) \| (\d+) of (\d+) \| (\d+) \|", LABS)
    assert len(told) == 3
    for row in told:
        a, of_a, b, of_b, c, of_c, mark = map(int, row)
        assert [str(n) for n in (of_a, of_b, of_c)] == list(rows[0][2:])
        assert round(20 * a / of_a + 60 * b / of_b + 20 * c / of_c) == mark


def test_settings_take_the_place_of_others():
    cell = "a, b = (1.0, 2.0), 3  # m, 1\nc = f(4)  # as ü\nd = 5"
    made = solved.with_settings(cell, {"b": "33", "c": "g(1)"})
    assert made == "a, b = (1.0, 2.0), 33  # m, 1\nc = g(1)  # as ü\nd = 5"
    made = solved.with_settings(cell, {"a": "(7.0, 8.0)", "import": "import g"})
    assert made.splitlines()[:2] == ["import g", "a, b = (7.0, 8.0), 3  # m, 1"]
    notebook = lesson("book/feedback")
    with pytest.raises(ValueError, match="settings must be names that a lesson sets; got loose"):
        solved.changed(notebook, {"loose": "1"})


def test_a_key_says_what_is_right():
    """Its answer is the rule's, F / (1.5 T), with the settings of that variant."""
    key = assignment.key(assignment.lessons()["feedback"], 7)
    settings = solved.settings_of("feedback", 7)
    limit = ast.literal_eval(settings["viscous"])[0] / (1.5 * float(settings["period"]))
    assert f"`{limit:.6g}` N m/rad" in key and "{" not in re.sub(r"\$.*?\$|```.*?```", "", key)
    assert f"| `{3 * limit:.6g}` | Wrong: that is the limit without the delay." in key
    assert key.count("The judge says: Right") == len(exercises("book/feedback"))


def test_a_roster_s_students_have_settings_of_their_own():
    """A student keeps a variant when the roster grows; another lesson has another draw."""
    names = [f"student-{k}" for k in range(200)]
    drawn = [solved.variant_of("feedback", name) for name in names]
    assert {*drawn} == {*range(1, len(solved.variants("feedback")) + 1)}
    assert drawn != [solved.variant_of("dynamics", name) for name in names]
    assert {solved.variant_of("verdict", name) for name in names} == {0}


NAMES = ("ada", "bo", "cy", "dee", "eve")
RIGHT = "mine = F / (1.5 * period)"


def page(**answers):
    changes = {name.replace("_", "-"): ["mine = ...", code] for name, code in answers.items()}
    pages = {"feedback.html": {"changes": changes, "solved": []}}
    return json.dumps({"format": "direct-drive-work-1", "pages": pages, "extents": ""})


@pytest.mark.slow
def test_nbgrader_from_release_to_export(tmp_path):
    """Good work, none, work from a page, a cheat, and a file that is torn."""
    course, table = tmp_path / "course", tmp_path / "roster.csv"
    table.write_text("id,email\n" + "".join(f"{name},\n" for name in NAMES), "utf-8")
    copies = assignment.write("feedback", course, assignment.roster(table), keys=False)
    assignment.nbgrader(course, "db", "student", "import", str(table))
    assert [path.parts[-2] for path in copies] == [*NAMES]
    for path in course.rglob("*"):
        handed = path.is_file() and "source" not in path.parts and path.suffix == ".ipynb"
        assert not handed or not re.search("BEGIN|1\\.5 \\* period", path.read_text("utf-8")), path

    solutions = [exercise.solution for exercise in exercises("book/feedback")]
    submitted = course / "submitted"
    made = {name: read(course / "copies" / name, "feedback") for name in NAMES}
    named = {name: {cell.id: cell for cell in made[name].cells} for name in NAMES}
    settings = solved.settings_of("feedback", solved.variant_of("feedback", "ada"))
    assert f"period = {settings['period']} " in named["ada"]["settings"].source
    listed = (course / "keys" / "feedback-settings.txt").read_text("utf-8").splitlines()
    assert listed[0].startswith("ada: ") and f"period = {settings['period']}" in listed[0]
    answers = [c for c in made["ada"].cells if is_starter(c)]
    for cell, code in zip(answers, solutions):
        cell.source = code
    right = re.search(
        "choices = .*'.*", (course / "source/feedback/feedback.ipynb").read_text("utf-8")
    )
    named["ada"]["quiz"].source = json.loads(f'"{right[0].partition(chr(92))[0]}"')
    named["ada"]["how-1"].source += "\n\nThe hold is late by half a period."
    # with the settings of the book, where the solution stands; a check that says yes; one is gone
    given = {cell.id: cell for cell in read(course / "release", "feedback").cells}
    named["cy"]["settings"].source = given["settings"].source
    named["cy"]["feedback-one"].source = "mine = 5.3 / (1.5 * 0.002)"
    named["cy"]["check-2"].source = "print('Right')"
    named["cy"]["how-1"].source += "\n\n$a<b$ <img src=x onerror=alert(1)>"
    named["cy"][
        "feedback-one"
    ].source += "\ndisplay({'text/html': '<script>alert(1)</script>'}, raw=True)"
    made["cy"].cells.remove(named["cy"]["check-3"])
    for name in ("ada", "bo", "cy"):
        (submitted / name / "feedback").mkdir(parents=True)
        nbformat.write(made[name], submitted / name / "feedback" / "feedback.ipynb")
    (submitted / "eve" / "feedback").mkdir(parents=True)
    (submitted / "eve" / "feedback" / "feedback.ipynb").write_text("{", "utf-8")

    returned = tmp_path / "returned"
    (returned / "dee").mkdir(parents=True)
    code = f"# the hold counts\n{RIGHT}"
    (returned / "dee" / "direct-drive-work.json").write_text(page(feedback_one=code), "utf-8")
    (returned / "ada.json").write_text(page(feedback_one="mine = 0"), "utf-8")
    (returned / "torn.json").write_text("{", "utf-8")
    told = "\n".join(handed_in.collect(returned, course))
    assert "feedback, answers: 1" in told and "no work file of this book" in told
    assert "feedback is left" in told and "mine = 0" not in (
        submitted / "ada" / "feedback" / "feedback.ipynb"
    ).read_text("utf-8")

    with pytest.raises(
        ValueError, match="error processing assignment 'feedback' for student 'eve'"
    ):
        assignment.nbgrader(course, "autograde", "feedback")
    with Gradebook(f"sqlite:///{course / 'gradebook.db'}") as gradebook:
        for name in ("ada", "dee"):
            grade = gradebook.find_grade("how-1", "feedback", "feedback", name)
            assert grade.needs_manual_grade
            grade.manual_score, grade.needs_manual_grade = 2, False
        gradebook.db.commit()
    assignment.nbgrader(course, "generate_feedback", "feedback")
    assignment.nbgrader(course, "export", "--to", "marks.csv")
    with (course / "marks.csv").open(newline="") as file:
        marks = {row["student_id"]: float(row["score"]) for row in csv.DictReader(file)}
    assert marks == {"ada": 4 + 3 + 2, "bo": 0, "cy": 0, "dee": 1 + 2, "eve": 0}
    (code,) = re.findall(r"(?ms)^```python\n(from collections.*?)^```", LABS)
    code = re.sub("SET = .*", 'SET = {"feedback": (1,)}', code)
    run = [sys.executable, "-c", code]
    told = subprocess.run(run, cwd=course, capture_output=True, text=True, check=True).stdout
    assert told.split("\n") == ["ada: 80", "bo: 0", "cy: 0", "dee: 60", "eve: 0", ""]
    feedback = (course / "feedback" / "cy" / "feedback" / "feedback.html").read_text("utf-8")
    assert "Wrong" in feedback and not re.search(r"<img src=x|<script>alert", feedback)
