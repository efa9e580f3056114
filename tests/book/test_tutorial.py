"""*Use it on your arm*: as short as it says, and free of the chapters and of committed results."""

import json
import re

from book_pages import BACK_MATTER, source

PAGE = "book/use-it-on-your-arm"
LINES = 40  # of code that a reader sees, imports included


def code() -> str:
    cells = json.loads(source(PAGE).read_text(encoding="utf-8"))["cells"]
    shown = [
        "".join(cell["source"])
        for cell in cells
        if cell["cell_type"] == "code" and "remove-cell" not in cell["metadata"].get("tags", ())
    ]
    return "\n".join(shown)


def test_it_takes_forty_lines():
    assert PAGE in BACK_MATTER
    assert 20 < len([line for line in code().splitlines() if line.strip()]) <= LINES


def test_it_needs_nothing_of_the_book():
    packages = set(re.findall(r"from (?:ddlib\.)?(\w+)", code()))
    assert {"dynamics", "simulation", "identification", "learning", "analysis"} <= packages
    assert not packages & {"paper", "experiments", "evidence", "widgets"}
