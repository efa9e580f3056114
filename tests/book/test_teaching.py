"""Lectures: time for all of it, an answer to each question, links that open what they say."""

from __future__ import annotations

import base64
import io
import re
import sys
import xml.etree.ElementTree as ET
import zipfile
from types import SimpleNamespace
from urllib.parse import parse_qs, unquote, urlsplit

import numpy as np
import prose
import pytest
from book_pages import ROOT, code_cells
from IPython.core.formatters import DisplayFormatter
from needed import needed
from PIL import Image

from ddlib import figures
from workshop import chapters

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import build
import dd_figures
import dd_lessons
import dd_quiz
import dd_teaching
from dd_book import cache_path

LECTURES = dd_teaching.lectures(ROOT)
ROWS = [(name, k, row) for name, told in LECTURES.items() for k, row in enumerate(told["rows"], 1)]
IDS = [f"{name}-{k}" for name, k, _ in ROWS]
OPENED = [dd_teaching.OPEN.fullmatch(row["open"]) for _, _, row in ROWS]
SOURCE = (ROOT / "book" / "teaching.md").read_text(encoding="utf-8")


def test_each_question_has_what_a_teacher_needs():
    texts = ["show", "ask", *dd_teaching.ANSWERS]
    assert not [row for _, _, row in ROWS if set(row) != {"minutes", *texts}]
    assert not [row for _, _, row in ROWS if not all(row[key].strip() for key in texts)]
    assert len([name for name, _, _ in ROWS if name.isdecimal()]) >= 22 and all(OPENED)
    sentences = [row[key] for _, _, row in ROWS for key in ("answer", "wrong", "say")]
    assert not [text for text in sentences if not text.rstrip().endswith(".")]


def test_lectures_leave_time_for_the_quiz():
    spent = {name: sum(row["minutes"] for row in told["rows"]) for name, told in LECTURES.items()}
    assert set(spent.values()) == {dd_teaching.LENGTH - dd_teaching.QUIZ} == {85}
    assert len(LECTURES["3"]["pages"]) == 2
    for name, told in LECTURES.items():
        assert f"```{{lecture}} {name}\n" in SOURCE
        assert any(dd_quiz.questions(ROOT, page) for page in told["pages"])


def test_answers_quote_no_number_but_what_their_link_sets():
    typed = {}
    for which, (_, _, row) in zip(IDS, ROWS):
        for text in (row[key] for key in ("ask", "answer", "wrong", "say")):
            found = prose.typed_numbers(prose.sentence(text))
            typed[which] = typed.get(which, []) + [n.replace("−", "-") for n in found]
    known = {which: re.findall(r"-?\d+", row["open"]) for which, (_, _, row) in zip(IDS, ROWS)}
    assert not {w: n for w, numbers in typed.items() for n in numbers if n not in known[w]}
    assert any(typed.values())


def test_what_is_set_is_asked_after_it_was_taught():
    """The homework asks for a phase margin, so the lecture reads one before."""
    set_for_home = re.findall(r"^Homework: (.+)$", SOURCE, re.MULTILINE)
    assert "{exercise}`feedback: 2`" in set_for_home[0]
    (taught,) = [row for _, _, row in ROWS if "**phase margin**" in row["show"]]
    assert "`feedback: How close to instability?`" in taught["show"]


def test_minutes_come_from_what_an_exercise_asks():
    question = "Derive it.\n" + dd_lessons.SOLUTION
    assert dd_lessons.minutes("prediction", question) == 10
    longer = question + "\n```python\na = 1\nmine = a\n```\n"
    assert dd_lessons.minutes("design", longer) == 20 and dd_lessons.minutes("design", "") == 15
    steps = question + "$a = b$ and $b \\le c$ of $d$."
    assert dd_lessons.minutes("derivation", question) == dd_lessons.minutes("derivation", steps)
    many = question + "$a = b$ " * 6
    assert dd_lessons.minutes("derivation", many) == dd_lessons.minutes("derivation", question) + 5
    words = question + "word " * 10 * dd_lessons.WORDS_A_MINUTE
    assert dd_lessons.minutes("prediction", words) == 20
    told = dd_lessons.rule()
    for number in {*dd_lessons.KINDS.values(), dd_lessons.LINE, dd_lessons.EQUATION}:
        assert re.search(rf"\b{number}\b", told)
    assert all(kind in told for kind in dd_lessons.KINDS)


def test_an_archive_has_pictures_and_what_they_show(tmp_path):
    svg = (
        '<svg style="width:1in" aria-label="A &amp; B"><path d="M0 0" stroke="currentColor"/></svg>'
    )
    kept = [dd_figures.Kept("fig-one", "A line.\n", svg, "A curve.", b"png")]
    dd_figures.pack(tmp_path / "f.zip", kept, lambda name: "Fig. 2.1")
    with zipfile.ZipFile(tmp_path / "f.zip") as archive:
        assert archive.namelist() == ["2.1-one.svg", "2.1-one.png", "captions.txt"]
        assert b"currentColor" not in archive.read("2.1-one.svg")
        assert b"Fig. 2.1 (2.1-one)\nA line.\nTo be seen: A curve." in archive.read("captions.txt")


def test_figures_of_lectures_and_no_others_come_as_png(monkeypatch):
    """In a notebook whose page the build names; a reader's own notebook draws nothing twice."""
    assert build.taught(ROOT) == {page for told in LECTURES.values() for page in told["pages"]}
    drawn = figures.curves(np.arange(3.0), {"a, m": {"one": np.arange(3.0)}}, "time, s", "A line.")
    for named, forms in (("dynamics window-networks", 2), ("dynamics", 1), ("", 1)):
        monkeypatch.setenv("DDLIB_PNG", named)
        shell = SimpleNamespace(display_formatter=DisplayFormatter())
        monkeypatch.setattr("IPython.get_ipython", lambda shell=shell: shell)
        monkeypatch.setattr("workshop.chapters.window_networks._quoted", lambda: None)
        chapters.quoted("window_networks")
        data, metadata = shell.display_formatter.format(drawn)
        assert data["text/html"] == drawn._repr_html_()
        png = metadata.get("text/html", {}).get(chapters.PNG)
        assert bool(png) is (forms == 2)
        assert not png or Image.open(io.BytesIO(base64.b64decode(png))).width > 800


@pytest.mark.built
def test_lectures_stand_on_the_page_with_all_their_links(parsed, built):
    page = parsed("book/teaching")
    for name, told in LECTURES.items():
        assert page.find("a", href=f"../{dd_figures.archive_of(name)}")
        which = f"lecture {name}" if name.isdecimal() else "the class"
        fold = page.find("summary", string=f"Answers of {which}").parent
        opened = [li for li in fold.select("li") if li.get_text().startswith("Open:")]
        assert len(opened) == len(told["rows"]) and all(li.find("a") for li in opened)
    for link in page.select("article a[href]"):
        where = urlsplit(link["href"])
        if where.scheme or not where.path.endswith(".html") or where.path.startswith("../"):
            continue
        assert (built / "book" / where.path).is_file(), where.path
        widget = where.fragment.endswith("-widget") or "=" in where.fragment
        there = parsed(f"book/{where.path.removesuffix('.html')}")
        assert not where.fragment or widget or there.find(id=where.fragment), link["href"]


@pytest.mark.built
def test_figures_of_a_lecture_are_in_its_archive(built):
    cache = cache_path(ROOT, ROOT / "_build")
    for name, told in LECTURES.items():
        path = built / dd_figures.archive_of(name)
        paths = (ROOT / "book" / f"{page}.ipynb" for page in told["pages"])
        cells = [dd_figures.executed(cache, path) for path in paths]
        assert all(cells)
        drawn = [each for page in cells for each in dd_figures.figures(page)]
        assert len(drawn) >= 3 * len(told["pages"]) and path.stat().st_size < 8e6
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            assert len(names) == len(set(names)) == 2 * len(drawn) + 1
            assert not [each for each in names if each.startswith("x-")]
            for each in (n for n in names if n.endswith(".svg")):
                assert ET.fromstring(archive.read(each)).tag.endswith("svg")
                png = Image.open(io.BytesIO(archive.read(each.removesuffix("svg") + "png")))
                assert min(png.size) >= 100 and len(set(png.convert("L").getdata())) > 2


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
@pytest.mark.parametrize("found", [one for one in OPENED if one["key"]], ids=lambda f: f[0][:60])
def test_a_link_opens_its_widget_as_it_says(found, site, visit):
    opened = visit(f"{site}/book/{dd_teaching.address(found)}", reduced_motion="reduce")
    given = urlsplit(opened.page.evaluate(STATE, found["key"]))
    asked = settings(urlsplit(dd_teaching.address(found)).query, found["key"])
    taken = settings(given.query, found["key"])
    assert asked and asked.items() <= taken.items() and not opened.problems


def test_every_link_leads_to_a_page_with_widgets_or_to_a_place():
    kinds = [bool(found["key"]) for found in OPENED]
    assert sum(kinds) >= 0.75 * len(kinds)
    for found in OPENED:
        path = ROOT / "book" / f"{found['page']}.ipynb"
        assert path.is_file()
        assert not found["key"] or needed(code_cells(path))
