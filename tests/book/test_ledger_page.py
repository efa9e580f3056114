"""The ledger in a browser: a wall of signs, filters, and an address for every claim."""

import pytest

from workshop.report.evidence import claims, wall

pytestmark = pytest.mark.browser

PAPER = claims.of_the_paper()
SHOWN = "details.claim:not([hidden])"


@pytest.fixture
def ledger(site, visit):
    def open_at(address=""):
        return visit(f"{site}/book/ledger.html{address}")

    return open_at


def shown(opened) -> int:
    return opened.page.locator(SHOWN).count()


def test_signs_open_their_claims(ledger):
    opened = ledger()
    assert shown(opened) == len(PAPER) == opened.page.locator(".wall-row a").count()
    sign = opened.page.locator(".wall-row a").nth(len(PAPER) // 2)
    name = sign.get_attribute("href")
    tile = opened.page.locator(name)
    assert not tile.evaluate("(el) => el.open")
    sign.focus()
    opened.page.keyboard.press("Enter")
    opened.page.wait_for_function("(name) => document.querySelector(name).open", arg=name)
    assert tile.locator("p").first.is_visible()
    assert opened.page.url.endswith(name) and not opened.problems


def test_a_claim_that_is_opened_can_be_shared(ledger):
    opened = ledger()
    tile = opened.page.locator("details.claim").nth(3)
    tile.locator("summary").click()
    assert opened.page.url.endswith("#" + tile.get_attribute("id"))


def test_an_address_opens_its_claim(ledger):
    claim = PAPER[-1]
    opened = ledger(f"#claim-{claim.id}")
    tile = opened.page.locator(f"#claim-{claim.id}")
    assert tile.evaluate("(el) => el.open")
    place = tile.bounding_box()
    assert 0 <= place["y"] < opened.page.viewport_size["height"]


def test_filters_leave_what_fits_and_the_address_restores_them(ledger):
    opened = ledger()
    bar = opened.page.locator(".claim-filter")
    for verdict in ("undecided", "by construction", "qualitative", "qualitative"):
        bar.locator(f'[data-verdict="{verdict}"]').click()  # the first alone, others are added
    bar.locator('[name="s"]').select_option("5")
    kinds = ("undecided", "by construction")
    wanted = [c for c in PAPER if c.place()[0] == "5" and c.judge() in kinds]
    assert wanted and shown(opened) == len(wanted)
    assert bar.locator("output").inner_text() == f"{len(wanted)} of {len(PAPER)} claims"
    assert opened.page.locator(".wall-row a.off").count() == len(PAPER) - len(wanted)
    again = ledger("#" + opened.page.url.partition("#")[2])
    assert shown(again) == len(wanted)
    again.page.locator(".claim-filter button", has_text="Show all").click()
    assert shown(again) == len(PAPER) and "#" not in again.page.url
    assert not opened.problems + again.problems


def test_a_subsection_and_a_table_can_be_chosen(ledger):
    opened = ledger()
    bar = opened.page.locator(".claim-filter")
    for value, name in (("7.1", "7.1. Future Work"), ("Table 4-1", "Table 4-1")):
        bar.locator('[name="s"]').select_option(value)
        wanted = [c for c in PAPER if wall.part(c) == name]
        assert wanted and shown(opened) == len(wanted)
    again = ledger("#s=7.1")
    assert shown(again) == len([c for c in PAPER if wall.part(c).startswith("7.1")])


def test_code_leads_to_the_lines_that_measure(ledger, site, visit):
    opened = ledger()
    link = opened.page.locator("details.claim a", has_text="code").first
    where = link.evaluate("(a) => a.href")
    assert "/_modules/book/workshop/report/measures/" in where
    source = visit(where)
    name = where.partition("#")[2]
    assert f"def {name}" in source.page.locator(f'[id="{name}"]').inner_text()


def test_words_filter_too_and_empty_sections_go(ledger):
    opened = ledger()
    opened.page.locator('.claim-filter [name="q"]').fill("parity")
    parity = [c for c in PAPER if "parity" in f"{c.claim} {c.why} {c.refuted}".lower()]
    assert len(parity) <= shown(opened) < 20 and shown(opened) > 0
    assert not opened.page.get_by_role("heading", name="Abstract").is_visible()


def test_a_hidden_claim_is_shown_when_its_sign_is_followed(ledger):
    opened = ledger("#v=undecided")
    (claim, *_) = [c for c in PAPER if c.judge() == "reproduced"]
    tile = opened.page.locator(f"#claim-{claim.id}")
    assert not tile.is_visible()
    opened.page.locator(f'.wall-row a[href="#claim-{claim.id}"]').click()
    tile.wait_for(state="visible")
    assert tile.evaluate("(el) => el.open")


def test_claims_can_be_read_without_a_script(site, browser):
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{site}/book/ledger.html")
    tile = page.locator("details.claim").first
    tile.locator("summary").click()
    assert tile.locator("p").first.is_visible()
    context.close()
