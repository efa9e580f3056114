"""Pages on paper: white, numbered, with open answers, and nothing that waits for a click."""

from __future__ import annotations

import re

import pytest
from book_pages import CHAPTERS, PAGES

pytestmark = [pytest.mark.browser, pytest.mark.chromium]

PAPER = 718  # px: A4 between margins of 1 cm

# As the browser's own print does it: before the pages are laid out.
PRINTED = r"""() => {
  document.getElementById("pst-back-to-top").style.display = "block"; // as after scrolling
  dispatchEvent(new Event("beforeprint"));
  const all = (selector) => [...document.querySelectorAll(selector)];
  const seen = (el) => el.checkVisibility() && el.getBoundingClientRect().height > 0;
  const words = (list) => list.filter(seen).map((el) => el.innerText?.trim() || el.className);
  const edge = document.documentElement.clientWidth + 1;
  return {
    titles: words(all("h1")),
    headings: words(all("article h2")),
    clicks: words(all("body :is(button, select, input, nav, .bd-header, .copybtn, .headerlink)")),
    told: words(all(".ddlib-widget :is(.remark, .footer)")),
    signs: all("details.claim > summary").filter(
      (el) => getComputedStyle(el, "::after").display !== "none").length,
    bars: words(all("article details:not(.answer, .claim) > summary")),
    closed: all("article details:not([open])").filter(seen).length,
    answers: all("article .tag_hide-cell .cell_input pre, article details.answer p").map(seen),
    moving: all("article details *").filter(
      (el) => seen(el) && getComputedStyle(el).animationName !== "none").length,
    cut: all("article :is(.ddlib-figure svg, .ddlib-widget svg, img, pre, canvas)").filter(
      (el) => seen(el) && (el.getBoundingClientRect().right > edge
        || (el.matches("pre") && el.scrollWidth > el.clientWidth + 1))).length,
    figures: all("article .ddlib-figure").map(seen),
  };
}"""


def test_paper_is_white_and_has_the_answers(site, visit):
    """And the page is as before when it has been printed."""
    look = """[getComputedStyle(document.body).backgroundColor,
      document.querySelectorAll('article details:not([open])').length]"""
    opened = visit(f"{site}/{PAGES[1]}.html", scheme="dark")
    opened.page.evaluate(
        f"() => addEventListener('beforeprint', () => {{ window.printed = {look}; }})"
    )
    before = opened.page.evaluate(look)
    assert opened.page.pdf().startswith(b"%PDF")
    assert opened.page.evaluate("window.printed") == ["rgb(255, 255, 255)", 0]
    assert opened.page.evaluate(look) == before
    assert before[0] != "rgb(255, 255, 255)" and before[1] > 0


@pytest.mark.parametrize("name", [CHAPTERS[0], CHAPTERS[5]])
def test_a_chapter_on_paper(name, site, visit):
    opened = visit(f"{site}/{name}.html", width=PAPER)
    opened.page.emulate_media(media="print")
    printed = opened.page.evaluate(PRINTED)
    number = CHAPTERS.index(name) + 1
    assert len(printed["titles"]) == 1 and printed["titles"][0].startswith(f"{number}. ")
    assert len(printed["headings"]) > 3
    assert all(re.match(rf"{number}\.\d+\. ", heading) for heading in printed["headings"])
    assert not printed["clicks"] and not printed["bars"]
    assert not printed["told"] and not printed["signs"]
    assert not printed["closed"] and not printed["moving"] and not printed["cut"]
    assert printed["answers"] and all(printed["answers"])
    assert printed["figures"] and all(printed["figures"])
