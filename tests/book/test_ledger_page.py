"""The ledger in a browser: a wall of signs, filters, and an address for every claim."""

import pytest

from workshop.report.evidence import claims, wall

pytestmark = pytest.mark.browser

PAPER = claims.of_the_paper()


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
    return page.locator("details.claim:not([hidden])").count()


def test_signs_open_their_claims(ledger):
    page = ledger()
    assert shown(page) == len(PAPER) == page.locator(".wall-row a").count()
    sign = page.locator(".wall-row a").nth(len(PAPER) // 2)
    name = sign.get_attribute("href")
    tile = page.locator(name)
    assert not tile.evaluate("(el) => el.open")
    sign.focus()
    page.keyboard.press("Enter")
    page.wait_for_function("(name) => document.querySelector(name).open", arg=name)
    assert tile.locator("p").first.is_visible() and page.url.endswith(name)


def test_a_claim_has_an_address_that_opens_it(ledger):
    page = ledger()
    tile = page.locator("details.claim").nth(3)
    tile.locator("summary").click()
    assert page.url.endswith("#" + tile.get_attribute("id"))
    page = ledger(f"#claim-{PAPER[-1].id}")
    tile = page.locator(f"#claim-{PAPER[-1].id}")
    assert tile.evaluate("(el) => el.open")
    assert 0 <= tile.bounding_box()["y"] < page.viewport_size["height"]


def test_filters_leave_what_fits_and_the_address_restores_them(ledger):
    page = ledger()
    bar = page.locator(".claim-filter")
    for verdict in ("undecided", "by construction", "qualitative", "qualitative"):
        bar.locator(f'[data-verdict="{verdict}"]').click()  # the first alone, others are added
    bar.locator('[name="s"]').select_option("5")
    kinds = ("undecided", "by construction")
    wanted = [c for c in PAPER if c.place()[0] == "5" and c.judge() in kinds]
    assert wanted and shown(page) == len(wanted)
    assert bar.locator("output").inner_text() == f"{len(wanted)} of {len(PAPER)} claims"
    assert page.locator(".wall-row a.off").count() == len(PAPER) - len(wanted)
    again = ledger("#" + page.url.partition("#")[2])
    assert shown(again) == len(wanted)
    again.locator(".claim-filter button", has_text="Show all").click()
    assert shown(again) == len(PAPER) and "#" not in again.url


def test_code_leads_to_the_lines_that_measure(ledger, visit):
    page = ledger()
    for claim in (next(c for c in PAPER if c.measure), next(c for c in PAPER if c.find)):
        link = page.locator(f"#claim-{claim.id} a", has_text="code").first
        where = link.evaluate("(a) => a.href")
        assert where.endswith(wall._source(claim).removeprefix(".."))
        name = where.partition("#")[2]
        assert f"def {name}" in visit(where).page.locator(f'[id="{name}"]').inner_text()


def test_a_hidden_claim_is_shown_when_its_sign_is_followed(ledger):
    page = ledger("#v=undecided")
    name = next(f"#claim-{c.id}" for c in PAPER if c.judge() == "reproduced")
    assert not page.locator(name).is_visible()
    page.locator(f'.wall-row a[href="{name}"]').click()
    page.locator(name).wait_for(state="visible")
    assert page.locator(name).evaluate("(el) => el.open")


def test_claims_can_be_read_without_a_script(site, browser):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{site}/book/ledger.html")
    tile = page.locator("details.claim").first
    tile.locator("summary").click()
    assert tile.locator("p").first.is_visible()
    context.close()
