"""The suite itself: the tests of pages lie where `make pages` looks for them."""

import re

from book_pages import ROOT

MARKED = r"mark\.(browser|built)\b"


def test_page_tests_lie_where_make_looks_for_them():
    folders = re.search(r"^PAGE_TESTS = (.+)$", (ROOT / "Makefile").read_text("utf-8"), re.M)[1]
    known = [ROOT / folder for folder in folders.split()]
    tests = [path for path in (ROOT / "tests").rglob("test_*.py") if path.name != "test_suite.py"]
    marked = [path for path in tests if re.search(MARKED, path.read_text(encoding="utf-8"))]
    assert not [path for path in marked if not set(known) & set(path.parents)]
    for folder in known:
        assert [path for path in marked if folder in path.parents], f"{folder.name} has none"
