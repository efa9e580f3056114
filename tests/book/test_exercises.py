"""Exercises as headings, folds with names of their own, formulas out of the way of *Tab*."""

import re
import sys

import chromium
import pytest
import yaml
from book_pages import CHAPTERS, PAGES, ROOT
from docutils import nodes
from docutils.utils import new_document

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_cite
import dd_exercises
import lessons


def asked(strong: str, *rest) -> nodes.paragraph:
    return nodes.paragraph("", "", nodes.Text(""), nodes.strong("", strong), *map(nodes.Text, rest))


def test_a_paragraph_becomes_a_heading_and_its_folds_are_named():
    """The question keeps its words; what belongs to no exercise stays as it is."""
    fold = f'<details class="answer">\n{lessons.SOLUTION}\n'
    check = nodes.container(prompt_show="The check", prompt_hide="The check")
    own = nodes.section("", nodes.title("", lessons.ON_YOUR_OWN), nodes.paragraph("", "Before."))
    own += [asked("1. Late", " (a design). Let it."), check, nodes.raw("", fold, format="html")]
    own += [asked("2. Twice", " (an experiment). "), nodes.raw("", fold, format="html")]
    other = nodes.section("", nodes.title("", "Elsewhere"), asked("1. Late", " (a design)."))
    document = new_document("page")
    document += [other, own]
    for transform in (dd_exercises.HeadExercises, dd_exercises.NameFolds):
        transform(document).apply()
    first, second = document.findall(nodes.rubric)
    assert first["ids"] == ["exercise-1"] and isinstance(first, dd_exercises.Heading)
    assert first.astext().startswith("Exercise 1: Late (a design)")
    assert second.astext().startswith("Exercise 2: Twice (an experiment)")
    assert [p.astext() for p in own.findall(nodes.paragraph)] == ["Before.", "Let it."]
    assert check["prompt_show"] == "The check of exercise 1"
    folds = [raw.astext() for raw in own.children if isinstance(raw, nodes.raw)]
    assert [re.search("Solution.*(?=<)", text)[0] for text in folds] == [
        f"Solution of exercise {k}" for k in (1, 2)
    ]
    assert other[1].astext() == "1. Late (a design)."


def test_folds_of_code_are_told_apart():
    cells = [nodes.container(prompt_show="2 lines", prompt_hide="2 lines") for _ in range(3)]
    cells[2] += nodes.figure("", nodes.caption("", "It swings. And more."))
    document = new_document("page")
    document += nodes.section("", nodes.title("", "One joint"), *cells)
    dd_exercises.NameFolds(document).apply()
    names = [cell["prompt_show"].partition(dd_exercises.NAMED)[2] for cell in cells]
    assert names == ["One joint", "One joint, part 2", "It swings"]


def test_the_citation_is_that_of_the_repository():
    said = yaml.safe_load((ROOT / dd_cite.FILE).read_text(encoding="utf-8"))
    told = dd_cite.bibtex(ROOT)
    assert f"Version {said['version']}" in told and said["title"] in told
    assert told.count("@") == 2 and "Goldberg, Ken and Pearlmutter, Barak" in told
    assert told.count("{") == told.count("}")


@pytest.mark.built
def test_exercises_are_headings_of_their_pages(parsed):
    for name in CHAPTERS:
        heads = parsed(name).select('#on-your-own > h3[id^="exercise-"]')
        exercises = lessons.lesson(ROOT, name).exercises
        assert [head["id"] for head in heads] == [f"exercise-{each.number}" for each in exercises]


@pytest.mark.built
def test_no_two_folds_have_one_name(parsed):
    wrong = {}
    for name in CHAPTERS:
        folds = parsed(name).select("article details:not(.claim) > summary")
        names = [fold.get_text(" ", strip=True) for fold in folds]
        twice = {each for each in names if names.count(each) > 1}
        wrong |= {name: twice} if twice else {}
    assert len(names) > 3 and not wrong


@pytest.mark.built
def test_every_page_leads_to_what_a_reader_may_do(parsed):
    for name in PAGES:
        led = {link.get_text(strip=True) for link in parsed(name).select("footer a[href]")}
        assert set(dd_cite.FOOTER.values()) <= led, name


STOPS = """
() => [...document.querySelectorAll("article mjx-container[tabindex]")]
  .filter((el) => el.tabIndex >= 0 && el.dataset.stop !== "ours").length
"""
RING = "() => getComputedStyle(document.activeElement).outlineStyle"


@pytest.mark.browser
def test_tab_stops_at_buttons_not_at_formulas(site, visit):
    """What scrolls is a stop all the same; a button in the header shows its focus."""
    page = visit(f"{site}/{CHAPTERS[1]}.html").page
    chromium.settle(page)
    assert page.locator("article mjx-container").count() > 50 and page.evaluate(STOPS) == 0
    buttons = page.locator(".article-header-buttons button:visible")
    assert buttons.count() >= 3
    buttons.first.focus()
    for _ in range(buttons.count()):
        assert page.evaluate(RING) == "solid"
        page.keyboard.press("Tab")
