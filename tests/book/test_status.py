"""The page *Status* and times that pages tell: what their tables say of ratios and targets."""

from __future__ import annotations

import re

import dd_runtime
import pytest
from book_pages import CHAPTERS, PAGES, source


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
    pattern = re.compile(rf"It runs in\s+(.*?) {dd_runtime.MEASURED}")
    told = {name: pattern.search(parsed(name).article.get_text())[1] for name in CHAPTERS}
    assert told == {name: dd_runtime.spoken_time(seconds[name]) for name in CHAPTERS}
