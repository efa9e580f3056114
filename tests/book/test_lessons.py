"""Lessons: exercises of each kind, a place for every widget, and a recipe of forty lines."""

import json
import re
import sys

from book_pages import BACK_MATTER, ROOT, source

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_lessons

RECIPE = "book/use-it-on-your-arm"
LINES = 40  # of code that a reader sees, imports included


def test_chapters_ask_for_a_derivation_a_design_and_a_prediction():
    asked = {path.stem: dd_lessons.exercises(path) for path in dd_lessons.chapters(ROOT)}
    asked = {name: exercises for name, exercises in asked.items() if exercises}
    assert len(asked) >= 20
    wrong = {}
    for name, exercises in asked.items():
        kinds = {each.kind for each in exercises}
        in_order = [each.number for each in exercises] == list(range(1, 1 + len(exercises)))
        if not in_order or not {"derivation", "design", "prediction"} <= kinds:
            wrong[name] = exercises
        elif not kinds <= set(dd_lessons.KINDS):
            wrong[name] = kinds
    assert not wrong


def test_every_widget_has_its_place_in_the_lessons():
    homes = ROOT / "ddlib" / "widgets", ROOT / "book" / "workshop"
    code = "\n".join(p.read_text(encoding="utf-8") for home in homes for p in home.rglob("*.py"))
    classes = set(re.findall(r"^class (\w+)\([\w.]*Widget\)", code, re.MULTILINE))
    made = re.compile(rf"\b({'|'.join(name for name in classes if name[-6:] != 'Widget')})\(")
    page = (ROOT / "book" / "lessons.md").read_text(encoding="utf-8")
    asked, found = set(re.findall(r"{section}`([^`]+)`", page)), {}
    for path in dd_lessons.chapters(ROOT):
        place = None
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            text = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                place = (re.findall(r"^#+ (.+)$", text, re.MULTILINE) or [place])[-1]
            else:
                found |= {name: f"{path.stem}: {place}" for name in made.findall(text)}
    assert len(found) >= 10
    assert not {name: place for name, place in found.items() if place not in asked}


def test_the_recipe_is_short_and_needs_nothing_of_the_book():
    cells = json.loads(source(RECIPE).read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    shown = [c for c in code if "remove-cell" not in c["metadata"].get("tags", ())]
    lines = "\n".join("".join(cell["source"]) for cell in shown).splitlines()
    assert RECIPE in BACK_MATTER and 20 < len([line for line in lines if line.strip()]) <= LINES
    packages = set(re.findall(r"from (?:ddlib\.)?(\w+)", "\n".join(lines)))
    assert {"dynamics", "simulation", "identification", "learning", "analysis"} <= packages
    assert not packages & {"paper", "workshop", "widgets"}
