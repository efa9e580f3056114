"""The page *Status* and times that pages tell: what their tables say of ratios and targets."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from book_pages import CHAPTERS, PAGES, ROOT, source

from workshop.chapters import status
from workshop.report import results

sys.path.insert(0, str(ROOT / "book" / "_ext"))
import dd_runtime
import lessons

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


def plain(rows) -> list[list[str]]:
    return [[cell.replace("\N{NO-BREAK SPACE}", " ") for cell in row] for row in rows]


def test_every_group_has_its_table(monkeypatch):
    """Pairs have both times; what is not measured stays."""
    made = {"date": "2026-01-31", "processor": "X", "cores": 2, "load before": None}
    made |= {"python": "3.11", "versions": {"numpy": "2.4"}, "seconds": 9.0}
    planted = {"benchmarks": {"made by": made, "rows": [PAIR, LIMIT, MISSING]}}
    monkeypatch.setattr(results, "read", planted.__getitem__)
    assert "2026-01-31: X, 2 cores, Python 3.11, numpy 2.4; 9 s" in status.benchmark_machine()
    tables = status.benchmarks()
    assert plain(tables.pop("Time").rows) == [["book", "130 s", "≤ 120: missed"]]
    (table,) = tables.values()
    assert plain([table.header, *table.rows]) == [
        ["what", "ensemble", "loop", "ratio", "share of the rate", "largest error, rad", "target"],
        ["window 21", "25.0 µs", "450 µs", "18.0 ×", "42%", "2.00 · 10⁻⁷", "≥ 8.0: met"],
        ["MuJoCo", "–", "–", "–", "–", "–", "not measured: pip install .[bench]"],
    ]


@pytest.mark.built
def test_every_notebook_has_its_time_and_share(parsed):
    """And every chapter tells the time that was measured."""
    table = parsed("book/status").find(id="chapters")
    rows = [row.find_all("td") for row in table.find_all("tr") if row.td]
    cells = [[cell.get_text(strip=True) for cell in row] for row in rows]
    links = [row[0].a["href"].removesuffix(".html") for row in rows[:-1]]
    names = [f"book/{'status' if link == '#' else link}" for link in links]  # the page itself
    assert names == [page for page in PAGES if source(page).suffix == ".ipynb"]
    seconds = {name: float(row[1].split()[0]) for name, row in zip(names, cells)}
    total = float(cells[-1][1].split()[0])
    assert sum(seconds.values()) == pytest.approx(total, abs=0.5 + 0.05 * len(names))
    shares = [int(row[2].rstrip("%")) for row in cells[:-1]]
    assert sum(shares) == pytest.approx(100, abs=len(names))
    pattern = re.compile(rf"Time to run\s+(.*?) {dd_runtime.MEASURED}")
    told = {name: pattern.search(parsed(name).article.get_text())[1] for name in CHAPTERS}
    assert told == {name: dd_runtime.spoken_time(seconds[name]) for name in CHAPTERS}


@pytest.mark.built
def test_pages_tell_the_time_to_read_them(parsed):
    """Each chapter, and the ten stations of the walk on the first page."""
    told = []
    for name in CHAPTERS:
        text = parsed(name).article.get_text()
        told.append((re.search(r"Time to read\s+(\d+) minutes, counted", text)[1], [name]))
    for way in parsed("book/index").select("#the-walk > .tag_station + p"):
        pages = [Path(a["href"]).stem for a in way.select("a[href]")]
        minutes = re.search(r"(\d+) minutes", way.get_text())[1]
        told.append((minutes, [f"book/{name}" for name in pages]))
    assert len(told) == len(CHAPTERS) + 10
    for minutes, pages in told:
        words = sum(lessons.lesson(ROOT, page).words for page in pages)
        assert abs(int(minutes) - words / lessons.WORDS_A_MINUTE) <= 5, pages
