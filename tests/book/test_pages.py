"""The built pages in a real browser: each is clean in both colours, wide and narrow."""

from __future__ import annotations

import gzip
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import chromium
import pytest
from axe import violations_in
from book_pages import LESSONS, PAGES, ROOT, WITH_WIDGETS

pytestmark = pytest.mark.browser

VIEW_TAG = '<script type="application/vnd.jupyter.widget-view+json">%s</script>'
VIEW = 'script[type="application/vnd.jupyter.widget-view+json"]'

WIDE, NARROW = 1280, 390  # px
GENERATED = ["search", "genindex", "py-modindex"]
OTHERS = ("evidence/feedback", "rivals", "use-it-on-your-arm", "ledger", "lessons", "teaching",
          "notation", "glossary", "status", "bibliography", "api/learning")  # fmt: skip
ONE_OF_EACH_KIND = [WITH_WIDGETS[0], *(f"book/{name}" for name in OTHERS)]
"""One page with a widget, and one of each kind that has none."""

# Where the first figure or widget begins, and the grey line; in px from the page's top.
FIRST = """
() => {
  const seen = (el) => el.checkVisibility() && el.getBoundingClientRect().height > 100;
  const all = [...document.querySelectorAll("article :is(.ddlib-figure, .ddlib-widget)")];
  const top = (el) => (el ? el.getBoundingClientRect().top + scrollY : null);
  return [top(all.find(seen)), top(document.querySelector("article p.needs"))];
}
"""
LOWEST = {1280: 700, 390: 744}  # px, on a laptop and on a phone

CHECKS = (ROOT / "tests" / "support" / "page_checks.js").read_text(encoding="utf-8")


def seen(opened, scheme: str, width: int) -> list[str]:
    """What a reader would see as wrong in a colour scheme and a width."""
    chromium.coloured(opened.page, scheme)
    opened.page.set_viewport_size({"width": width, "height": 800})
    chromium.settle(opened.page)
    found = opened.page.evaluate(CHECKS, {"width": width, "scheme": scheme})
    views = opened.page.locator(VIEW).count()
    alerts = opened.page.locator(".ddlib-widget-error").all_inner_texts()
    if opened.page.locator(".ddlib-widget").count() != views:
        found.append(f"of {views} widgets not all are there")
    return [f"{scheme}, {width} px: {fault}" for fault in found + alerts]


@cache
def compressed(path: Path) -> int:
    """Bytes of a file as hosts send it."""
    return len(gzip.compress(path.read_bytes(), 6))


def too_heavy(opened, site: str, built: Path) -> list[str]:
    """More than 500 kB for a page beside MathJax and the typeface, or 200 kB for the typeface."""
    if chromium.FIREFOX:  # it does not say what it got
        return []
    urls = {response.url.partition("?")[0] for response in opened.responses}
    own = {url for url in urls if url.startswith(site) and "/mathjax/" not in url}
    sizes = {url: compressed(built / unquote(url.removeprefix(f"{site}/"))) for url in own}
    assert sum(sizes.values()) > 20_000
    heaviest = sorted(sizes.items(), key=lambda entry: -entry[1])[:5]
    whole, fonts = sum(sizes.values()), sum(n for url, n in sizes.items() if "/fonts/" in url)
    return [f"{whole} bytes: {heaviest}"] * (whole - fonts > 500_000 or fonts > 200_000)


def result_comes_late(opened, width: int) -> list[str]:
    """That a lesson's first figure or widget does not begin above what the reader will do."""
    first, promise = opened.page.evaluate(FIRST)
    fine = None not in (first, promise) and first < min(LOWEST[width], promise)
    return [] if fine else [f"{width} px: the result begins at {first}, the promise at {promise}"]


@pytest.mark.parametrize("name", [*PAGES, *GENERATED])
def test_page_is_clean(name, site, built, visit):
    """Opened in the dark, then in light, wide, narrow, and unfolded: one load for all."""
    opened = visit(f"{site}/{name}.html", "dark")
    problems = too_heavy(opened, site, built)
    for scheme, width in (("dark", WIDE), ("light", NARROW), ("light", WIDE)):
        problems += seen(opened, scheme, width)
        problems += result_comes_late(opened, width) if name in LESSONS else []
    problems += opened.problems  # before axe asks for style sheets itself
    # What is around an article is the same on each page of a kind, and so is all of the reference
    where = "html" if name in {*ONE_OF_EACH_KIND, *GENERATED} else "main"
    if where == "html" or not name.startswith("book/api"):
        problems += violations_in(opened.page, "light", "dark", where=where)
    assert not problems


# Tables, a trainer, and a page of Part IV, whose scripts lie in other folders
@pytest.mark.parametrize(
    "name",
    [
        *ONE_OF_EACH_KIND,
        *(f"book/{n}" for n in ("feedback", "window-networks", "adaptive-control")),
    ],
)
def test_page_is_clean_as_a_file(name, built, visit):
    """Opened from a folder, and narrow from the start."""
    opened = visit((built / f"{name}.html").as_uri(), "light", NARROW)
    assert not seen(opened, "light", NARROW) + opened.problems


def test_cards_on_a_phone_are_headed_like_their_table(site, visit):
    page = visit(f"{site}/book/ledger.html", "light", NARROW).page
    cells = page.evaluate("""() => [...document.querySelectorAll("table.cards")].flatMap((table) =>
      [...table.querySelectorAll("tbody td")].filter((cell) => cell.cellIndex > 0).map((cell) => [
        table.tHead.rows[0].cells[cell.cellIndex].textContent.trim(),
        cell.dataset.name, getComputedStyle(cell, "::before").content !== "none"]))""")
    assert len(cells) > 20
    assert all(shown and name == head for head, name, shown in cells)


FAULTS = {
    "overflows": '<p style="width:2000px">wide</p>',
    "no alternative text": '<img src="favicon.svg" alt="">',
    "broken image: gone": '<img src="gone.svg" alt="gone">',
    "a fold stands open": "<details open><summary>more</summary>text</details>",
    "a fold opens onto nothing": "<details><summary>more</summary></details>",
    "raw TeX": "<p>so \\frac{1}{2}</p>",
    "twice": "<p>it is is so</p>",
    "a figure cuts its text: label": '<div class="ddlib-figure"><svg width="90" height="90">'
    '<text x="80" y="50">label</text></svg></div>',
    "text of 7.0 px: small": '<div class="ddlib-figure"><svg width="90" height="90" '
    'viewBox="0 0 180 180"><text x="9" y="90" font-size="14">small</text></svg></div>',
    "marks overlap: 0.01 0.1": '<div class="ddlib-widget"><div class="ddlib-widget chart"><svg '
    'width="90" height="90"><g class="grid"><text x="20" y="50">0.01</text>'
    '<text x="30" y="50">0.1</text></g></svg></div></div>',
    "scrolls, but not by keyboard": '<div style="overflow-x:auto"><p style="width:2000px">a</p>'
    "</div>",
    "MathJax for 0 formulas": '<script type="text/x" src="mathjax.js"></script>',
    "of 1 widgets": VIEW_TAG % "{}",
    "theme is light": "",
}


@pytest.mark.chromium
def test_what_a_reader_would_see_is_seen(tmp_path, visit):
    page = tmp_path / "page.html"
    html = "<!doctype html><html data-theme='light' data-widgets='1'><meta charset='utf-8'>"
    page.write_text(f"{html}<main><article>{''.join(FAULTS.values())}</article></main>")
    found = seen(visit(page.as_uri(), "dark"), "dark", WIDE)
    assert not [fault for fault in FAULTS if not any(fault in line for line in found)]


@pytest.mark.parametrize("kind", ["file", "http"])
def test_root_leads_to_the_book(kind, built, site, visit):
    root = built.as_uri() if kind == "file" else site
    opened = visit(f"{root}/index.html", lands=f"**/{PAGES[0]}.html")
    assert opened.page.locator("article h1").count() == 1
    assert not opened.problems


@pytest.mark.chromium
def test_stills_stand_in_where_there_is_no_script(site, browser):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    problems = []
    page.on("console", lambda message: problems.append(message.text))
    page.on("requestfailed", lambda request: problems.append(request.url))
    for name in WITH_WIDGETS:
        page.goto(f"{site}/{name}.html")
        stills = page.locator("img.still")
        assert stills.count() == page.locator(VIEW).count() > 0, name
        for still in stills.all():
            assert still.is_visible() and still.bounding_box()["height"] > 50, name
            assert still.get_attribute("alt")
    assert not problems
    context.close()
