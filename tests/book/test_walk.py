"""Lessons: short, with code in the open that runs alone, follows changes, and judges answers."""

import pytest
from book_pages import PAGES, ROOT, WALK, code_cells, source
from chapter_rules import SHAPE, TUTORIAL
from nine_answers import Nine, wrong
from open_cells import CHANGES, SHORT, execute, exercises, imports, lesson, run

from workshop.chapters import exercises as engine

DATA = ROOT / "book" / "data"  # goes with the notebooks
MOST_SECONDS = 30  # of one core, for the open cells of a lesson
LIBRARIES = {"ddlib", "numpy", "scipy", "sympy", "torch", "control", "matplotlib", "ipywidgets"}
STANDARD = {"collections", "dataclasses", "fractions", "itertools", "math", "time", "warnings"}


@pytest.mark.parametrize("rule", SHAPE, ids=lambda rule: rule.__name__)
def test_lessons_have_the_shape(rule):
    assert not {page: wrong for page in (*WALK, TUTORIAL) if (wrong := rule(lesson(page)))}


@pytest.mark.parametrize("page", WALK)
def test_open_cells_run_alone(page, tmp_path, monkeypatch):
    """In a folder with the book's data alone; then nine kinds of answer are judged."""
    assert imports(page) <= LIBRARIES | STANDARD
    (tmp_path / "data").symlink_to(DATA)
    monkeypatch.chdir(tmp_path)
    space, seconds = run(page)
    assert seconds < MOST_SECONDS
    for exercise in exercises(page):
        execute(exercise.starter, space, "starter")
        assert "in place of the dots" in execute(exercise.check, space, "check")
        assert exercise.solution, exercise.check
        execute(exercise.solution, space, "solution")
        told = execute(exercise.check, space, "check")
        assert told.startswith("Right"), (exercise.check, told)
        nine = Nine(space, *exercise)
        with monkeypatch.context() as patch:
            patch.setattr(engine, "judge", nine.judge)
            assert not wrong(nine), exercise.check


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if source(page).suffix == ".ipynb"])
def test_all_cells_run(page, monkeypatch):
    """Those that the book hides, too, each page's as one program."""
    monkeypatch.chdir(source(page).parent)
    space = {"__name__": "__main__"}
    for number, cell in enumerate(code_cells(source(page))):
        execute(cell, space, f"{page}: {number}")


@pytest.mark.parametrize(
    "page, change", [(page, change) for page in WALK for change in CHANGES.get(page[5:], ())]
)
def test_a_change_goes_through_to_the_last_figure(page, change, tmp_path, monkeypatch):
    """After a short training, unless the change says how long."""
    (tmp_path / "data").symlink_to(DATA)
    monkeypatch.chdir(tmp_path)
    name = page[5:]
    run(page, SHORT.get(name, ""), CHANGES[name][change])
