"""Exercises as headings, folds with names of their own, formulas out of the way of *Tab*."""

import chromium
import dd_cite
import lessons
import pytest
import yaml
from book_pages import CHAPTERS, PAGES, ROOT


def test_the_citation_is_that_of_the_repository():
    said = yaml.safe_load((ROOT / dd_cite.FILE).read_text(encoding="utf-8"))
    told = dd_cite.bibtex(ROOT)
    assert ("Version" in told) == ("version" in said) and said["title"] in told
    assert told.count("@") == 2 and "Goldberg, Ken and Pearlmutter, Barak" in told
    assert told.count("{") == told.count("}")


@pytest.mark.built
def test_exercises_are_headings_of_their_pages(parsed):
    for name in CHAPTERS:
        heads = parsed(name).select('#try-it-yourself h3[id^="exercise-"]')
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
