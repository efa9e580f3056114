"""What does not fit a line: names, numbers, formulas and tables on screens wide and narrow."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.browser

# Pieces of text that are cut in the middle although a line would hold them.
CUT = r"""([selector, ends]) => {
  const lines = (text) => {
    const range = document.createRange();
    range.selectNodeContents(text);
    return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size;
  };
  const found = [];
  let seen = 0;
  for (const el of document.querySelectorAll(selector)) {
    if (!el.checkVisibility()) continue;
    for (const node of el.childNodes) {
      if (node.nodeType !== 3 || !new RegExp(ends).test(node.data)) continue;
      seen += 1;
      if (lines(node) > 1) found.push(node.data);
    }
  }
  return [seen, found];
}"""
WORD = r"^[^\s,(]{2,}$"
NUMBER = r"^[≤≥]?\s?[\d.]+\s(s|ms|µs|×|GiB)$"


@pytest.mark.chromium
@pytest.mark.parametrize(
    ("name", "width", "selector", "ends"),
    [
        ("book/notation", 1280, "td code .pre", WORD),
        ("book/provenance", 390, ":is(td, th) code .pre", WORD),
        ("book/status", 390, "td, td > p", NUMBER),
        ("book/api/control", 390, "dt.sig .pre", WORD),
        ("book/api/workshop", 390, "article h2", r"^[\w.]+$"),
        ("book/glossary", 390, ".prev-next-title", r"^\w+$"),
        ("genindex", 390, ".indextable a", r"^[\w.]+$"),
    ],
)
def test_names_and_numbers_are_whole(name, width, selector, ends, site, visit):
    page = visit(f"{site}/{name}.html", width=width).page
    seen, cut = page.evaluate(CUT, [selector, ends])
    assert seen and not cut


# How far boxes reach beyond their width, px, and the size of the letters in them, px.
BEYOND = """([selector, text]) => [...document.querySelectorAll(selector)]
  .filter((el) => el.clientWidth)
  .map((el) => [el.scrollWidth - el.clientWidth,
    parseFloat(getComputedStyle(text ? el.querySelector(text) : el).fontSize)])"""


def test_formulas_fit_a_phone(site, visit):
    """Set smaller where they must be, but never too small to read."""
    for name in (
        "adaptive-control",
        "convolution-filters",
        "rivals",
        "inertia-in-the-weights",
    ):
        page = visit(f"{site}/book/{name}.html", width=390).page
        formulas = page.evaluate(BEYOND, ["article div.math > mjx-container", ""])
        assert formulas and all(over <= 1 and size >= 10.5 for over, size in formulas), name
