"""Code on the built pages: what is to be read stands open, plumbing by a switch, answers folded."""

from __future__ import annotations

import json
import sys

import chromium
import pytest
from axe import violations_in
from book_pages import CHAPTERS, PAGES, ROOT, source
from bookkeeping import lines_of_bookkeeping
from bs4 import BeautifulSoup

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_reading

browser_test = pytest.mark.browser
built_test = pytest.mark.built

NOTEBOOKS = [page for page in PAGES if source(page).suffix == ".ipynb"]
BUTTON = ".btn-all-code"
# Pieces of code that a reader sees, with what the page calls a piece of code to read.
SEEN = """
() => [...document.querySelectorAll("article .cell_input pre")].filter((el) => el.checkVisibility())
  .map((el) => [el.textContent, Boolean(el.closest(".tag_to-read"))])
"""


def sources(page: str) -> list[str]:
    cells = json.loads(source(page).read_text(encoding="utf-8"))["cells"]
    return ["".join(c["source"]).strip() for c in cells if c["cell_type"] == "code"]


def open_code(html: str) -> list[str]:
    """What stands in the open without a script or a click."""
    cells = BeautifulSoup(html, "html.parser").select("article .cell:not(.tag_bookkeeping)")
    found = [pre for cell in cells for pre in cell.select(".cell_input pre")]
    return [pre.get_text() for pre in found if not pre.find_parent("details")]


def open_answers(html: str) -> list[str]:
    """What follows a question of *On your own* and is not folded, apart from questions."""
    section = BeautifulSoup(html, "html.parser").select_one("#on-your-own")
    shown = [el for el in section.find_all(recursive=False) if el.name not in {"h2", "span"}]
    folded = [el for el in shown if el.name == "details" or el.select_one(":scope > details")]
    questions = [el for el in shown if el.select_one(":scope > strong")]
    asked = questions[0] if questions else None
    found, open_ = [], False
    for el in shown:
        if el in folded:
            open_ = True
        elif el in questions:
            open_ = False
        elif open_ or asked is None:
            found.append(el.get_text())
    return found


@built_test
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_no_line_of_bookkeeping_on_a_page(name, built):
    shown = open_code((built / f"{name}.html").read_text(encoding="utf-8"))
    assert not [line for code in shown for line in lines_of_bookkeeping(code)]
    assert not [code for code in shown if code.strip() not in sources(name)]


@built_test
@pytest.mark.parametrize("name", CHAPTERS)
def test_no_answer_stands_in_the_open_on_a_page(name, built):
    html = (built / f"{name}.html").read_text(encoding="utf-8")
    assert not open_answers(html)
    assert BeautifulSoup(html, "html.parser").select("#on-your-own details")


@built_test
@pytest.mark.parametrize("name", NOTEBOOKS)
def test_nothing_of_a_notebook_is_lost_on_its_page(name, built):
    html = (built / f"{name}.html").read_text(encoding="utf-8")
    code = [pre.get_text().strip() for pre in BeautifulSoup(html, "html.parser").select("pre")]
    assert not [cell for cell in sources(name) if cell not in code]


def test_faults_of_a_page_are_seen():
    cell = '<div class="cell"><div class="cell_input"><pre>{}</pre></div></div>'
    folded = cell.replace("<pre>", "<details><pre>").replace("</pre>", "</pre></details>")
    html = f"<article>{cell.format('f(x)')}{folded.format('import x')}</article>"
    assert open_code(html) == ["f(x)"]
    assert open_code(html.replace("f(x)", "quote(x)")) == ["quote(x)"]
    asked = "<p><strong>1. So?</strong> How many?</p>"
    fold = '<div class="cell"><details>code</details></div><details>It is 5.</details>'
    section = '<article><section id="on-your-own"><h2>On your own</h2>{}</section></article>'
    assert open_answers(section.format(asked + fold + asked + fold)) == []
    assert open_answers(section.format(asked + fold + "<p>It is 5.</p>")) == ["It is 5."]


@pytest.mark.parametrize(
    ("tags", "page"),
    [
        ([], ["to-read"]),
        (["labels"], ["to-read", "labels"]),
        (["remove-cell"], ["hide-input", "remove-output", "bookkeeping"]),
        (["findings", "remove-input"], ["hide-input", "bookkeeping", "findings"]),
        (["hide-input"], ["hide-input", "plumbing"]),
        (["hide-cell"], ["hide-cell"]),
    ],
)
def test_tags_of_a_page(tags, page):
    assert dd_reading.page_tags(tags) == page


def test_a_fold_says_how_much_it_hides():
    assert dd_reading.lines("a = 1") == "1 line of plumbing"
    assert dd_reading.lines("a = 1\n\nb = 2\n") == "2 lines of plumbing"


@browser_test
@pytest.mark.parametrize("kind", ["file", "http"])
def test_one_switch_shows_all_code(kind, built, site, visit):
    """By keyboard; it is remembered, and what was looked at stays where it is."""
    name = CHAPTERS[0]
    address = (built / f"{name}.html").as_uri() if kind == "file" else f"{site}/{name}.html"
    opened = visit(address)
    page = opened.page
    button = page.locator(BUTTON)
    assert button.count() == 1 and button.get_attribute("aria-pressed") == "false"
    taught = page.evaluate(SEEN)
    assert taught and all(to_read for _, to_read in taught)
    button.focus()
    page.keyboard.press("Enter")
    assert button.get_attribute("aria-pressed") == "true"
    seen = {code.strip() for code, _ in page.evaluate(SEEN)}
    folded = page.locator("article details:not([open]) .cell_input pre").all_text_contents()
    assert seen >= set(sources(name)) - {code.strip() for code in folded}
    assert len(seen) > 2 * len(taught)
    page.reload()
    assert button.get_attribute("aria-pressed") == "true"
    chromium.settle(page)
    button.focus()
    page.evaluate("scrollTo({top: 3000, behavior: 'instant'})")
    look = """() => {
      window.looked ??= [...document.querySelectorAll("article :is(p, h2, li)")]
        .find((el) => !el.closest("details") && el.getBoundingClientRect().top > 80);
      return window.looked.getBoundingClientRect().top;
    }"""
    before = page.evaluate(look)
    page.keyboard.press("Space")
    assert button.get_attribute("aria-pressed") == "false"
    assert abs(page.evaluate(look) - before) < 2
    assert page.evaluate(SEEN) == taught
    assert not opened.problems


@browser_test
def test_the_page_with_all_its_code_is_accessible(site, visit):
    opened = visit(f"{site}/{CHAPTERS[0]}.html")
    opened.page.locator(BUTTON).click()
    assert not opened.problems  # before axe asks for style sheets itself
    assert not violations_in(opened.page, "light", "dark")


@browser_test
def test_without_storage_the_switch_works(site, browser):
    context = browser.new_context()
    page = context.new_page()
    faults = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.add_init_script(
        "Object.defineProperty(window, 'localStorage', {get() { throw new Error('denied'); }})"
    )
    page.goto(f"{site}/{CHAPTERS[0]}.html")
    page.locator(BUTTON).click()
    assert page.locator(BUTTON).get_attribute("aria-pressed") == "true"
    assert not [fault for fault in faults if "reading.js" in fault]
    context.close()


@browser_test
def test_a_phone_has_room_for_the_switch(site, visit):
    opened = visit(f"{site}/{CHAPTERS[0]}.html", "light", 390)
    box = opened.page.locator(BUTTON).bounding_box()
    assert box["x"] > 0 and box["x"] + box["width"] < 390 and box["height"] >= 24
    opened.page.locator(BUTTON).click()
    assert opened.page.locator(BUTTON).get_attribute("aria-pressed") == "true"


@browser_test
def test_paper_has_the_code_that_teaches(site, visit):
    """With its folds open, as `print.js` leaves them: no plumbing, unless all code is shown."""
    page = visit(f"{site}/{CHAPTERS[0]}.html").page
    page.emulate_media(media="print")
    page.evaluate("document.querySelectorAll('article details').forEach((el) => (el.open = true))")
    plumbing = page.locator("article :is(.tag_plumbing, .tag_bookkeeping) .cell_input")
    seen = "(found) => found.filter((el) => el.checkVisibility()).length"
    assert plumbing.count() > 0 and plumbing.evaluate_all(seen) == 0
    assert page.locator("article .tag_to-read .cell_input").evaluate_all(seen) > 0
    page.evaluate("document.documentElement.dataset.code = 'all'")
    assert plumbing.evaluate_all(seen) == plumbing.count()
