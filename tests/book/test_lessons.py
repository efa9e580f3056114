"""Lessons: every chapter has exercises of each kind, every widget has its place in a lesson."""

import json
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_lessons  # noqa: E402

CHAPTERS = [path for path in dd_lessons.chapters(ROOT) if dd_lessons.exercises(path)]


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem)
def test_a_chapter_asks_for_a_derivation_a_design_and_a_prediction(path):
    found = dd_lessons.exercises(path)
    assert [each.number for each in found] == list(range(1, 1 + len(found)))
    assert {each.kind for each in found} <= set(dd_lessons.KINDS), "an exercise without its kind"
    assert {each.kind for each in found} >= {"derivation", "design", "prediction"}


def test_all_chapters_are_seen():
    assert len(CHAPTERS) >= 20


def test_every_widget_has_its_place_in_the_lessons():
    code = "\n".join(p.read_text(encoding="utf-8") for p in (ROOT / "ddlib/widgets").rglob("*.py"))
    classes = set(re.findall(r"^class (\w+)\([\w.]*Widget\)", code, re.MULTILINE))
    made = re.compile(rf"\b({'|'.join(name for name in classes if name[-6:] != 'Widget')})\(")
    page = (ROOT / "book" / "lessons.md").read_text(encoding="utf-8")
    asked, found = set(re.findall(r"{section}`([^`]+)`", page)), set()
    for path in dd_lessons.chapters(ROOT):
        place = None
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            text = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                place = (re.findall(r"^#+ (.+)$", text, re.MULTILINE) or [place])[-1]
            elif names := made.findall(text):
                found.update(names)
                assert f"{path.stem}: {place}" in asked, names
    assert len(found) >= 10


def test_exercises_are_read_with_their_kind(tmp_path):
    cells = [
        "# A page\n**1. Before** (a design). Not yet.",
        "## On your own\n\n**1. By hand** (a derivation). Show it.",
        "**2. Look.** Without a kind.\n\n**3. An egg** (an experiment). Try.",
    ]
    text = json.dumps({"cells": [{"cell_type": "markdown", "source": c} for c in cells]})
    (tmp_path / "page.ipynb").write_text(text, encoding="utf-8")
    found = dd_lessons.exercises(tmp_path / "page.ipynb")
    assert [(e.number, e.kind) for e in found] == [(1, "derivation"), (2, ""), (3, "experiment")]
