"""Lectures: time for all of it, an answer to each question, links that open what they say."""

from __future__ import annotations

from urllib.parse import parse_qs, unquote, urlsplit

import dd_lessons
import pytest
from book_pages import ROOT, code_cells
from lessons import entries, questions
from needed import needed

LECTURES = entries(ROOT, "lectures")
ROWS = [(name, k, row) for name, told in LECTURES.items() for k, row in enumerate(told["rows"], 1)]
IDS = [f"{name}-{k}" for name, k, _ in ROWS]
OPENED = [dd_lessons.OPEN.fullmatch(row["open"]) for _, _, row in ROWS]
SOURCE = "".join((ROOT / "book" / f"{p}.md").read_text("utf-8") for p in ("teaching", "labs"))


def test_each_question_has_what_a_teacher_needs():
    """An answer, the commonest wrong one, what to say, and a link to a page that has its widget."""
    wanted = {"minutes", "show", "ask", *dd_lessons.ANSWERS}
    assert not [row for _, _, row in ROWS if set(row) != wanted or not all(row.values())]
    assert all(OPENED)
    for link in OPENED:
        path = ROOT / "book" / f"{link['page']}.ipynb"
        assert path.is_file() and (not link["key"] or needed(code_cells(path))), link[0]


def test_lectures_leave_time_for_the_quiz():
    for name, lecture in LECTURES.items():
        spent = sum(row["minutes"] for row in lecture["rows"])
        assert spent + dd_lessons.QUIZ == dd_lessons.LENGTH == 90, name
        assert f"```{{lecture}} {name}\n" in SOURCE
        assert any(questions(ROOT, f"book/{page}") for page in lecture["pages"])


@pytest.mark.built
def test_lectures_stand_on_the_page(parsed):
    for name, lecture in LECTURES.items():
        page = parsed("book/labs" if " of " in name else "book/teaching")
        which = "the class" if name in lecture["pages"] else f"lecture {name}"
        fold = page.find("summary", string=f"Answers of {which}").parent
        opened = [li for li in fold.select("li") if li.get_text().startswith("Open:")]
        assert len(opened) == len(lecture["rows"]) and all(li.find("a") for li in opened)


STATE = """(name) => {
  const root = document.querySelector(`[data-widget="${name}"]`);
  navigator.clipboard.writeText = async (text) => (window.copied = text);
  [...root.querySelectorAll(".actions button")].find((b) => b.textContent === "Link").click();
  return new Promise((done) => setTimeout(() => done(window.copied), 100));
}"""


def settings(query: str, key: str) -> dict[str, str]:
    """What an address says of a widget."""
    pairs = parse_qs(query)[key][0].split(",") if key in parse_qs(query) else []
    return dict(map(unquote, pair.split(":", 1)) for pair in pairs)


@pytest.mark.browser
@pytest.mark.parametrize(
    "found", {one[0]: one for one in OPENED if one["key"]}.values(), ids=lambda f: f[0][:60]
)
def test_a_link_opens_its_widget_as_it_says(found, site, visit):
    opened = visit(f"{site}/book/{dd_lessons.address(found)}", reduced_motion="reduce")
    given = urlsplit(opened.page.evaluate(STATE, found["key"]))
    asked = settings(urlsplit(dd_lessons.address(found)).query, found["key"])
    taken = settings(given.query, found["key"])
    assert asked and asked.items() <= taken.items() and not opened.problems
