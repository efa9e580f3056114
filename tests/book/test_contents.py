"""Contents, *Next* and evidence: one order for all."""

from itertools import pairwise

import pytest
from book_pages import CHAPTERS, EVIDENCE, EVIDENCE_OF, PAGES


@pytest.mark.built
def test_the_pages_lead_along_the_walk(parsed):
    for page, after in pairwise(CHAPTERS):
        for own in (page, *EVIDENCE_OF[page]):
            link = parsed(own).select_one("a.right-next")["href"]
            assert link.endswith(f"{after.removeprefix('book/')}.html"), own


@pytest.mark.built
def test_evidence_has_no_numbers_and_is_folded(parsed):
    assert len(EVIDENCE) > 20
    for page in EVIDENCE:
        assert not parsed(page).select("article :is(h1, h2, h3) .section-number"), page
    entries = parsed(PAGES[0]).select("nav.bd-links > .bd-toc-item > ul > li")
    assert len(entries) < 40
