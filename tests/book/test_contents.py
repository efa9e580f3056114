"""Contents, *Next* and evidence: one order for all."""

from itertools import pairwise

import pytest
from book_pages import CHAPTERS, EVIDENCE, EVIDENCE_OF, PAGES, TEN


@pytest.mark.built
def test_the_pages_lead_along_the_walk(parsed):
    for page, after in pairwise(CHAPTERS):
        for own in (page, *EVIDENCE_OF[page]):
            link = parsed(own).select_one("a.right-next")["href"]
            assert link.endswith(f"{after.removeprefix('book/')}.html"), own


@pytest.mark.built
def test_the_walk_alone_has_numbers_and_dots(parsed):
    titles = [parsed(page).h1.find_all(string=True, recursive=False)[0] for page in TEN]
    for k, page in enumerate(TEN, 1):
        strip = parsed(page).select_one("article nav.walk")
        links = strip.select("a")
        assert strip.span.text == f"{k} of 10"
        assert [a.text for a in links] == [f"Lesson {n}: {t}" for n, t in enumerate(titles, 1)]
        assert [a for a in links if a.get("aria-current")] == [links[k - 1]]
    for page in {*CHAPTERS, *EVIDENCE} - {*TEN}:
        assert not parsed(page).select("article :is(h1, h2, h3) .section-number, nav.walk"), page


@pytest.mark.built
def test_evidence_is_folded(parsed):
    entries = parsed(PAGES[0]).select("nav.bd-links > .bd-toc-item > ul > li")
    assert len(EVIDENCE) > 20
    assert len(entries) < 40
