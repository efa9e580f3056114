"""Returned notebooks are graded in one go, and none of them stops the others."""

import csv
import shutil
import sys

import nbformat
import pytest
from book_pages import ROOT
from open_cells import exercises

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import assignment
import grade
from solved import settings_of

ISOLATED = pytest.mark.skipif(not grade.isolated(), reason="this system isolates no process")
KEPT = ("begin", "settings")  # and what the questions need: students may delete a figure's cell
ANSWERS = {"1": "mine = 1.0", "2": "mine = (1.0, float('nan'))", "3": "mine = (2, 2, 0.5)"}
NETWORK = """import socket
try:
    socket.create_connection(("192.0.2.1", 9), timeout=3)
    mine = ...
except OSError as error:
    mine = F / (1.5 * period) if "imed out" not in str(error) else ..."""


def answered(path, answers, name=""):
    """A notebook as a student returns it."""
    _, made = assignment.notebook(ROOT / "book" / "feedback.ipynb", 3)
    cells = []
    for cell in made.cells:
        role, _, number = cell.metadata.get("assignment", "").partition("-")
        if role == "name":
            cell.source = cell.source.replace("**Name:**", f"**Name:** {name}")
        if role == "answer":
            cell.source = answers.get(number, cell.source)
        if role == "how" and name:
            cell.source = f"{cell.source}\n\n=SUM(1) because of {number}"
        if role == "begin":
            cell.source += "\nimport numpy as np\nfrom ddlib import figures"
        if role in answers:
            cell.source = answers[role]
        needed = (
            role in (*KEPT, "quiz", "answer", "check", "how", "name") or "J, F = " in cell.source
        )
        cells += [cell] * needed
    made.cells = cells
    path.parent.mkdir(exist_ok=True)
    nbformat.write(made, path)


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    where = tmp_path_factory.mktemp("returned")
    right = {str(k): one.solution for k, one in enumerate(exercises("book/feedback"), 1)}
    letters = assignment.right_letters("feedback")
    answered(where / "good.ipynb", {**right, "1": NETWORK, "quiz": f"choices = {letters}"}, "Ada")
    other = f"period = {settings_of('feedback', 4)['period']}"
    answered(where / "wrong" / "wrong.ipynb", {**ANSWERS, "settings": other + "\narm = ..."}, "Bo")
    answered(where / "crash.ipynb", {**right, "2": "import os\nos._exit(3)", "3": "1 / 0"})
    endless = "import time\nwhile True:\n    time.sleep(0.1)"
    answered(where / "endless.ipynb", {**right, "3": endless})
    answered(where / "empty.ipynb", {"2": "mine = undefined_name"})
    (where / "torn.ipynb").write_text("{", encoding="utf-8")
    (where / "wrong" / ".ipynb_checkpoints").mkdir()
    answered(where / "wrong" / ".ipynb_checkpoints" / "deep.ipynb", {})
    grade.grades(where, minutes=0.6)
    with (where / grade.KEPT).open(encoding="utf-8-sig", newline="") as file:
        found = list(csv.DictReader(file))
    return {row["file"]: row for row in found}


def statuses(row):
    return [row[f"question {k}"] for k in (1, 2, 3)]


def test_each_file_has_a_line(rows):
    names = {"good.ipynb", "wrong/wrong.ipynb", "crash.ipynb", "endless.ipynb", "empty.ipynb"}
    assert {*rows} == {*names, "torn.ipynb"}
    assert {rows[name]["lesson"] for name in names} == {"feedback"}
    assert {rows[name]["variant"] for name in names} == {"3"}
    assert rows["torn.ipynb"]["error"].startswith("no notebook")


def test_right_and_wrong_answers_are_told_apart(rows):
    """Without a network, and with the variant's settings whatever a copy says."""
    good, wrong = rows["good.ipynb"], rows["wrong/wrong.ipynb"]
    assert statuses(good) == ["right"] * 3 and good["score"] == good["of"] == "3"
    assert good["quiz"] == "4 of 4" and good["name"] == "Ada" and not good["error"]
    assert good["explanation 2"] == "'=SUM(1) because of 2"
    assert "period" not in good["changed"] and "period" in wrong["changed"]
    assert statuses(wrong) == ["wrong", "not judged", "wrong"] and wrong["score"] == "0"
    assert "NaN is no number" in wrong["judge 2"] and "has a root in it" in wrong["judge 3"]


def test_one_notebook_stops_alone(rows):
    crash, endless, empty = (rows[f"{name}.ipynb"] for name in ("crash", "endless", "empty"))
    assert statuses(crash) == ["right", "not reached", "not reached"]
    assert "status 3" in crash["error"]
    assert statuses(endless) == ["right", "right", "not reached"]
    assert endless["error"] == "stopped after 0.6 minutes" and float(endless["seconds"]) < 60
    assert statuses(empty) == ["no answer"] * 3 and empty["quiz"] == "0 of 4"
    assert "NameError" in empty["judge 2"] and empty["error"].startswith("answer-2: NameError")


def test_what_cannot_be_graded_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"FOLDER must be a folder, got '.*door'"):
        grade.grades(tmp_path / "door")
    with pytest.raises(ValueError, match="FOLDER must have notebooks in it"):
        grade.grades(tmp_path)
    with pytest.raises(ValueError, match="MINUTES must be above 0, got 0"):
        grade.grades(tmp_path, minutes=0)


@pytest.mark.parametrize("alone", [pytest.param(True, marks=ISOLATED), False])
def test_a_notebook_has_no_network(tmp_path, alone):
    """By the system or by Python's sockets; in the second case it reaches this machine."""
    shutil.copy(ROOT / "book" / "workshop" / "chapters" / "exercises.py", tmp_path)
    far = "import socket\nsocket.create_connection(('192.0.2.1', 9), timeout=5)"
    near = "s = socket.create_server(('127.0.0.1', 0))\nsocket.create_connection(s.getsockname())"
    cells = [{"role": role, "source": code} for role, code in (("far", far), ("near", near))]
    done, ended = grade.run(cells, tmp_path, 1.0, alone)
    assert not ended and [cell["role"] for cell in done] == ["far", "near"]
    said = "Network is unreachable" if alone else "no network while a notebook is graded"
    assert said in done[0]["error"]
    assert alone or not done[1]["error"]
