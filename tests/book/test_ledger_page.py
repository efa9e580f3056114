"""The ledger in a browser: cards that open, filters, and an address for every row."""

import pytest

from workshop.report.evidence import cards, claims, wall

pytestmark = pytest.mark.browser

ROWS = claims.load()
CARDS = len(cards._cards()) + len(cards.LISTS)


@pytest.fixture
def ledger(site, visit):
    """``ledger(address)``: the open page; nothing may go wrong on it."""
    opened = []

    def open_at(address=""):
        opened.append(visit(f"{site}/book/ledger.html{address}"))
        return opened[-1].page

    yield open_at
    assert not [problem for each in opened for problem in each.problems]


def shown(page) -> int:
    return page.locator("details.card-of-rows[data-verdict]:not([data-verdict='']):visible").count()


def test_signs_of_a_grid_open_their_rows(ledger):
    page = ledger("#card-saturated")
    sign = page.locator("#card-saturated[open] .claim-grid a").nth(3)
    name = sign.get_attribute("href")
    assert not page.locator(name).evaluate("(el) => el.open")
    sign.focus()
    page.keyboard.press("Enter")
    page.locator(f"{name}[open] p").first.wait_for(state="visible")
    assert page.url.endswith(name)


def test_every_row_has_an_address_that_opens_it_and_its_card(ledger):
    page = ledger()
    card = page.locator("details.card-of-rows").nth(3)
    card.locator("summary").first.click()
    assert page.url.endswith("#" + card.get_attribute("id"))
    addresses = page.evaluate("[...document.querySelectorAll('details.claim')].map((el) => el.id)")
    assert {f"claim-{row.id}" for row in ROWS} <= set(addresses)
    for row in (ROWS[0], ROWS[-1]):
        page = ledger(f"#claim-{row.id}")
        tile = page.locator(f"#claim-{row.id}")
        assert tile.evaluate("(el) => el.open && el.parentElement.closest('details').open")
        assert 0 <= tile.bounding_box()["y"] < page.viewport_size["height"]


def test_filters_leave_what_fits_and_the_address_restores_them(ledger):
    page = ledger()
    bar = page.locator(".claim-filter")
    for verdict in ("undecided", "in part", "qualitative", "qualitative"):
        bar.locator(f'[data-verdict="{verdict}"]').click()  # the first alone, others are added
    wanted = sum(card.sign() in ("undecided", "in part") for card in cards._cards())
    assert wanted and shown(page) == wanted
    assert bar.locator("output").inner_text() == f"{wanted} of {CARDS} cards"
    again = ledger("#" + page.url.partition("#")[2])
    assert shown(again) == wanted
    hidden = next(f"#card-{card.id}" for card in cards._cards() if card.sign() == "reproduced")
    again.evaluate("(name) => { location.hash = name; }", hidden)
    again.locator(f"{hidden}[open]").wait_for(state="visible")
    again.locator(".claim-filter input").fill("simple velocity filter")
    assert 1 <= shown(again) < 5
    again.locator(".claim-filter button", has_text="Show all").click()
    assert shown(again) == CARDS and "#" not in again.url


def test_code_leads_to_the_lines_that_measure(ledger, visit):
    page = ledger()
    for claim in (next(c for c in ROWS if c.measure), next(c for c in ROWS if c.find)):
        link = page.locator(f"#claim-{claim.id} a", has_text="code").first
        where = link.evaluate("(a) => a.href")
        assert where.endswith(wall._source(claim).removeprefix(".."))
        name = where.partition("#")[2]
        assert f"def {name}" in visit(where).page.locator(f'[id="{name}"]').inner_text()


@pytest.mark.chromium
def test_rows_can_be_read_without_a_script(site, browser):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{site}/book/ledger.html#claim-{ROWS[-1].id}")
    row = page.locator(f"#claim-{ROWS[-1].id}")
    row.locator("summary").click()  # the browser has opened its card
    assert row.locator("p").first.is_visible()
    context.close()
