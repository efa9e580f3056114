"""The page *Status*: what its tables say about times, ratios and targets."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest
from book_pages import CHAPTERS, PAGES, ROOT, source
from bs4 import BeautifulSoup

from workshop.chapters import status
from workshop.report import results

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_runtime

PAIR = {
    "group": "Training",
    "what": "window 21",
    "ours": {"name": "ensemble", "seconds": 2.5e-5},
    "other": {"name": "loop", "seconds": 4.5e-4},
    "ratio": 18.0,
    "at least": 8.0,
    "details": {"share of the rate": 0.423, "largest error, rad": 2e-7, "operations": 3},
}
LIMIT = {"group": "Time", "what": "book", "value": 130.0, "unit": "s", "at most": 120.0}
MISSING = {"group": "Training", "what": "MuJoCo", "not measured": "pip install .[bench]"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of results; ``folder(name, content)`` writes one."""
    monkeypatch.setattr(results, "FOLDER", tmp_path)

    def write(name, content):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))

    return write


def plain(rows) -> list[list[str]]:
    return [[cell.replace("\N{NO-BREAK SPACE}", " ") for cell in row] for row in rows]


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (120.0, "120 s"),
        (1.0, "1.00 s"),
        (0.0251, "25.1 ms"),
        (2.5e-5, "25.0 µs"),
        (3e-7, "0.300 µs"),
    ],
)
def test_durations_have_the_unit_that_suits_them(seconds, shown):
    assert status.duration(seconds).split() == shown.split()


@pytest.mark.parametrize(
    ("row", "shown"),
    [
        (PAIR, "≥ 8.0: met"),
        (PAIR | {"ratio": 7.99}, "≥ 8.0: missed"),
        (LIMIT, "≤ 120: missed"),
        (LIMIT | {"value": 120.0}, "≤ 120: met"),
        (MISSING, "not measured: pip install .[bench]"),
        ({key: value for key, value in PAIR.items() if key != "at least"}, "none"),
    ],
)
def test_a_missed_target_is_said_to_be_missed(row, shown):
    assert status.outcome(row).replace("\N{NO-BREAK SPACE}", " ") == shown


def test_pairs_have_both_times_and_what_is_not_measured_stays(folder):
    folder("benchmarks", {"rows": [PAIR, MISSING]})
    table = status.benchmarks()["Training"]
    assert table.header == (
        "what", "ensemble", "loop", "ratio", "share of the rate", "largest error, rad", "target",
    )  # fmt: skip
    assert plain(table.rows) == [
        ["window 21", "25.0 µs", "450 µs", "18.0 ×", "42%", "2.00 · 10⁻⁷", "≥ 8.0: met"],
        ["MuJoCo", "–", "–", "–", "–", "–", "not measured: pip install .[bench]"],
    ]


def test_every_group_has_its_table(folder):
    made = {"date": "2026-01-31", "processor": "X", "cores": 2, "load before": None}
    made |= {"python": "3.11", "versions": {"numpy": "2.4"}, "seconds": 9.0}
    folder("benchmarks", {"made by": made, "rows": [PAIR, LIMIT, MISSING]})
    assert "2026-01-31: X, 2 cores, Python 3.11, numpy 2.4; 9 s" in status.benchmark_machine()
    tables = status.benchmarks()
    assert {group: len(table.rows) for group, table in tables.items()} == {"Training": 2, "Time": 1}
    assert plain(tables["Time"].rows) == [["book", "130 s", "≤ 120: missed"]]


@pytest.mark.parametrize(("seconds", "verdict"), [(1560.0, "met"), (1560.1, "missed")])
def test_times_of_the_results_and_of_all_together(folder, tmp_path, seconds, verdict):
    for name, made in {
        "rivals": {"code": "2", "seconds": 750.0},
        "table-4-1": {"code": "1", "seconds": 100.0},
        "loop-conditions": {"code": "1", "seconds": 720.0},
        "benchmarks": {"seconds": 900.0},  # not of make reproduce
        "reproduce": {"seconds": seconds, "jobs": 2, "parts": 3},
    }.items():
        folder(name, {"made by": made})
    folder("verdicts", {})  # of other results
    rows = status.made_results().rows
    names = ["loop-conditions", "rivals", "table-4-1"]
    assert [row[0] for row in rows[:4]] == [*names, "sum"] and rows[3][1] == "1570 s"
    assert [row[1] for row in rows[4:-1]] == [
        "50 s; target ≤ 900 s: met",
        "375 s; target ≤ 300 s: missed",
        "360 s; target ≤ 360 s: met",
    ]
    assert rows[-1][0] == "make reproduce, 2 at a time, by the clock"
    assert rows[-1][1] == f"{seconds:.0f} s; target ≤ 1560 s: {verdict}"
    folder("c", {"made by": {"code": "3", "seconds": 1.0}})
    told = status.made_results().rows[-1][1]
    assert told.endswith(verdict) and "before results were added" in told
    (tmp_path / "reproduce.json").unlink()
    assert not status.made_results().rows[-1][0].startswith("make reproduce")


@pytest.mark.parametrize(
    ("seconds", "shown"),
    [
        (0.4, "about a second"),
        (3.6, "about 4 seconds"),
        (24.1, "about 25 seconds"),
        (88, "about 90 seconds"),
        (130, "about 2 minutes"),
    ],
)
def test_times_in_words(seconds, shown):
    assert dd_runtime.spoken_time(seconds) == shown


@pytest.mark.built
@pytest.mark.parametrize("name", CHAPTERS)
def test_a_chapter_tells_the_time_that_was_measured(name, built):
    status = BeautifulSoup((built / "book" / "status.html").read_text("utf-8"), "html.parser")
    rows = status.select("#chapters tr:has(td)")
    times = {row.a["href"]: row.find_all("td")[1].get_text() for row in rows if row.a}
    measured = float(times[f"{Path(name).name}.html"].split()[0])
    page = BeautifulSoup((built / f"{name}.html").read_text("utf-8"), "html.parser").article
    told = re.search(rf"Time to run\s+(.*?) {dd_runtime.MEASURED}", page.get_text())
    assert told[1] == dd_runtime.spoken_time(measured)


@pytest.mark.built
@pytest.mark.parametrize("name", CHAPTERS)
def test_a_chapter_tells_the_time_to_read_it(name, built):
    page = BeautifulSoup((built / f"{name}.html").read_text("utf-8"), "html.parser").article
    told = re.search(r"Time to read\s+(\d+) minutes, counted", page.get_text())
    assert abs(int(told[1]) - dd_runtime.words(source(name)) / dd_runtime.WORDS_A_MINUTE) <= 5


@pytest.mark.built
def test_every_notebook_has_its_time_and_share(built):
    page = BeautifulSoup(
        (built / "book" / "status.html").read_text(encoding="utf-8"), "html.parser"
    )
    rows = [
        [cell.get_text(strip=True) for cell in row.find_all("td")]
        for row in page.find(id="chapters").find_all("tr")
    ]
    *chapters, total = [row for row in rows if row]
    links = [a["href"].removesuffix(".html") for a in page.select("#chapters td a")]
    own = {"#": "status"}  # the page is a notebook itself
    notebooks = [p for p in PAGES if source(p).suffix == ".ipynb"]
    assert [f"book/{own.get(link, link)}" for link in links] == notebooks
    assert sum(float(row[1].split()[0]) for row in chapters) == pytest.approx(
        float(total[1].split()[0]), abs=0.5 + 0.05 * len(chapters)
    )
    assert sum(int(row[2].rstrip("%")) for row in chapters) == pytest.approx(100, abs=len(chapters))


def test_words_of_prose_are_counted(tmp_path):
    cells = [("markdown", ["# One two\n", "three"]), ("code", ["four = 5"])]
    cells = [{"cell_type": kind, "source": source} for kind, source in cells]
    path = tmp_path / "page.ipynb"
    path.write_text(json.dumps({"cells": cells}))
    assert dd_runtime.words(path) == 3
    assert dd_runtime.minutes([path]) == "5 minutes"
    words = [{"cell_type": "markdown", "source": ["word " * 12 * dd_runtime.WORDS_A_MINUTE]}]
    path.write_text(json.dumps({"cells": words}))
    assert dd_runtime.minutes([path]) == "10 minutes"


@pytest.mark.built
def test_reading_times_on_the_first_page(built):
    page = BeautifulSoup((built / "book" / "index.html").read_text(encoding="utf-8"), "html.parser")
    told = [item.get_text() for item in page.select("#four-ways-in > ul > li")]
    minutes = [int(re.search(r"(\d+) minutes", text)[1]) for text in told]
    ways = [
        [Path(a["href"]).stem for a in item.select("a[href]")]
        for item in page.select("#four-ways-in > ul > li")
    ]
    for number, pages in zip(minutes, ways, strict=True):
        total = sum(dd_runtime.words(ROOT / "book" / f"{name}.ipynb") for name in pages)
        assert abs(number - total / dd_runtime.WORDS_A_MINUTE) <= 5
