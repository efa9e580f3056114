"""Lessons: exercises of each kind, and a place for every widget."""

import json
import re
import sys
from collections import defaultdict

from book_pages import ROOT

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_lessons


def name(path):
    return path.relative_to(ROOT / "book").with_suffix("").as_posix()


def test_chapters_ask_for_a_derivation_a_design_and_a_prediction():
    asked = {name(path): dd_lessons.exercises(path) for path in dd_lessons.chapters(ROOT)}
    asked = {page: exercises for page, exercises in asked.items() if exercises}
    assert len(asked) >= 20
    wrong = {}
    for page, exercises in asked.items():
        kinds = {each.kind for each in exercises}
        in_order = [each.number for each in exercises] == list(range(1, 1 + len(exercises)))
        if not in_order or not {"derivation", "design", "prediction"} <= kinds:
            wrong[page] = exercises
        elif not kinds <= set(dd_lessons.KINDS):
            wrong[page] = kinds
    assert not wrong


def test_what_the_walk_needs_is_said_alike():
    """The landing page names whatever a lesson asks for that no other lesson teaches."""
    told = (ROOT / "book" / "index.ipynb").read_text(encoding="utf-8")
    need = re.compile(r"\*\*You need\*\* (.+?)(?::|\.$|\. |\n)", re.MULTILINE)
    asked = {}
    for page in ("dynamics", "feedback", "backpropagation"):
        text = "\n".join(dd_lessons.prose(ROOT / "book" / f"{page}.ipynb"))
        pieces = re.split(r",(?: and)? ", need.search(text)[1])
        asked[page] = [each for each in pieces if "{doc}" not in each]
    assert all(asked.values())
    assert not [(page, each) for page, all_ in asked.items() for each in all_ if each not in told]


def test_every_widget_has_its_place_in_the_lessons():
    homes = ROOT / "ddlib" / "widgets", ROOT / "book" / "workshop", ROOT / "book" / "beyond"
    code = "\n".join(p.read_text(encoding="utf-8") for home in homes for p in home.rglob("*.py"))
    classes = set(re.findall(r"^class (\w+)\([\w.]*Widget\)", code, re.MULTILINE))
    made = re.compile(rf"\b({'|'.join(name for name in classes if name[-6:] != 'Widget')})\(")
    page = (ROOT / "book" / "lessons.md").read_text(encoding="utf-8")
    asked, found = set(re.findall(r"{section}`([^`]+)`", page)), defaultdict(set)
    for path in dd_lessons.chapters(ROOT):
        place = None
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            text = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                place = (re.findall(r"^#+ (.+)$", text, re.MULTILINE) or [place])[-1]
            else:
                for kind in made.findall(text):
                    found[kind].add(f"{name(path)}: {place}")
    assert len(found) >= 10
    assert not {name: places for name, places in found.items() if not places & asked}
