"""Objectives: each lesson of the walk has some, and each of them is tested on its page."""

import json
import sys
from types import SimpleNamespace

import pytest
from book_pages import ROOT, TOC, source

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_lessons
import dd_objectives
import dd_quiz

EVERY = dd_objectives.objectives(ROOT)
TEN = [page["file"].removeprefix("book/") for part in TOC["parts"][:3] for page in part["chapters"]]


def what_tests(page: str) -> list[str]:
    """All that a page can test by: "exercise 1" and so on, "question 1" and so on."""
    exercises = dd_lessons.exercises(source(f"book/{page}"))
    asked = dd_quiz.questions(ROOT, page)
    return [f"exercise {each.number}" for each in exercises] + [
        f"question {k}" for k in range(1, 1 + len(asked))
    ]


def test_the_ten_lessons_have_three_to_five_in_the_order_of_the_contents():
    assert list(EVERY) == TEN
    assert not [page for page, some in EVERY.items() if not 3 <= len(some) <= 5]


@pytest.mark.parametrize("page", TEN)
def test_each_is_tested_and_each_test_has_its_objective(page):
    named = {test for one in EVERY[page] for test in one.by}
    assert named == set(what_tests(page))
    for one in EVERY[page]:
        assert one.by and len(set(one.by)) == len(one.by), one
        assert one.can[0].islower() and one.can[-1].isalpha() and len(one.can.split()) <= 20, one


def test_objectives_are_not_proven_by_questions_alone():
    """In each lesson most of them ask for something that is computed, derived or designed."""
    for page, some in EVERY.items():
        done = [one for one in some if any(test.startswith("exercise") for test in one.by)]
        assert len(done) > len(some) / 2, page


def test_a_readers_notebook_lists_them():
    page = TEN[0]
    told = dd_objectives.with_markdown("Before.\n\n## On your own\n\nAfter.", ROOT, page)
    assert told.startswith(f"Before.\n\n{dd_objectives.HEADING}\n\n{dd_objectives.BEGINS}\n\n- ")
    assert told.endswith("\n\n## On your own\n\nAfter.")
    assert told.count("\n- ") == len(EVERY[page])
    other = "## On your own\n\nAfter."
    assert dd_objectives.with_markdown(other, ROOT, "rivals") == other


def test_a_page_calls_for_them_before_its_own_work():
    page, cell = (
        TEN[0],
        {"cell_type": "markdown", "source": ["Before.\n", "## On your own\n", "A."]},
    )
    env = SimpleNamespace(doc2path=lambda page: str(source(page)))
    app, text = SimpleNamespace(srcdir=ROOT, env=env), [json.dumps({"cells": [cell]})]
    for put in (dd_objectives.call, dd_quiz.call):
        put(app, f"book/{page}", text)
    (made,) = json.loads(text[0])["cells"]
    asked = (
        f"{dd_objectives.HEADING}\n\n{dd_objectives.BEGINS}\n\n```{{objectives}} {page}\n```\n\n"
    )
    assert made["source"] == f"Before.\n{asked}{dd_quiz.CALL}## On your own\nA."


@pytest.mark.built
def test_pages_list_them_with_links_that_lead_somewhere(parsed):
    """Before the questions, on the lesson's page; and all of them where one prepares to teach."""
    for page in TEN:
        section = parsed(f"book/{page}").select_one("#what-you-can-do-now")
        assert section.find_next_sibling("section")["id"] == "check-yourself"
        items = section.select("ul > li")
        assert len(items) == len(EVERY[page])
        for item, one in zip(items, EVERY[page]):
            links = item.select("a[href]")
            assert [link.get_text() for link in links] == one.by
            targets = [link["href"].lstrip("#") for link in links]
            assert all(parsed(f"book/{page}").find(id=target) for target in targets), one
    listed = parsed("book/lessons").select("#what-each-lesson-teaches li a[href]")
    assert len(listed) == sum(len(one.by) for some in EVERY.values() for one in some)
    for link in listed:
        page, _, target = link["href"].partition(".html#")
        assert parsed(f"book/{page}").find(id=target), link
