"""The API pages: every public module is documented, once, on the page of its package."""

from __future__ import annotations

import re
from collections import Counter

import pytest
from book_pages import API, ROOT, source
from bs4 import BeautifulSoup

PACKAGE = ROOT / "ddlib"


def documented(page: str) -> list[str]:
    """Modules that a page documents."""
    return re.findall(r"automodule:: ([\w.]+)", source(page).read_text(encoding="utf-8"))


def name_of(path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def page_of(module: str) -> str:
    """Where a module belongs: a module beside the packages is one of the basics."""
    _, *inside = module.split(".")
    if not inside:
        return "book/api"
    is_package = (PACKAGE / inside[0]).is_dir()
    return f"book/api/{inside[0] if is_package else 'basics'}"


MODULES = [
    name_of(path) for path in sorted(PACKAGE.rglob("*.py")) if not re.match("_[a-z]", path.stem)
]


def test_every_module_is_documented_once():
    assert Counter(name for page in API for name in documented(page)) == Counter(MODULES)


@pytest.mark.parametrize("page", API)
def test_a_page_documents_its_own_package(page):
    assert documented(page)
    assert {page_of(module) for module in documented(page)} == {page}


def test_the_index_leads_to_every_page():
    text = source("book/api").read_text(encoding="utf-8")
    assert re.findall(r"\{doc\}`(api/\w+)`", text) == [page[5:] for page in API[1:]]


@pytest.mark.parametrize("page", API)
def test_a_heading_names_the_module_below_it(page):
    text = source(page).read_text(encoding="utf-8")
    pairs = re.findall(r"^#+ ([\w.]+)\n\n```\{eval-rst\}\n\.\. automodule:: (\S+)", text, re.M)
    assert len(pairs) >= len(documented(page)) - 1
    assert not [pair for pair in pairs if not pair[1].endswith(pair[0])]


@pytest.mark.built
def test_what_a_constant_is_stands_whole(built):
    """No part of its docstring is taken for a type."""
    entries = [
        entry
        for page in API[1:]
        for entry in BeautifulSoup((built / f"{page}.html").read_bytes(), "html.parser").select(
            "dl.py.data"
        )
    ]
    assert len(entries) > 100
    assert not [e.get_text()[:80] for e in entries if e.select("dd > .field-list")]


@pytest.mark.built
@pytest.mark.parametrize("page", API)
def test_the_value_of_a_constant_fits_a_few_lines(page, built):
    soup = BeautifulSoup((built / f"{page}.html").read_text(encoding="utf-8"), "html.parser")
    values = [el.get_text() for el in soup.select("dl.py.data > dt > .property")]
    assert all(len(value) < 200 for value in values)


@pytest.mark.built
def test_a_short_value_is_whole_and_a_long_one_says_that_it_goes_on(built):
    html = (built / "book/api/dynamics.html").read_text(encoding="utf-8")
    dynamics = BeautifulSoup(html, "html.parser")
    arm, free_fall = (
        dynamics.find(id=f"ddlib.dynamics.{name}").select_one(".property").get_text()
        for name in ("joints.DD_ARM_II_IN_SPACE", "arm.STANDARD_GRAVITY")
    )
    assert free_fall.split() == ["=", "9.81"]
    assert arm.startswith(" = ") and arm.endswith("…")
