"""What programs read of the built pages: claims as data, pages as plain text."""

import json
import re

import pytest

from workshop.report.evidence.claims import load


@pytest.mark.built
def test_every_claim_is_data_with_an_address(built, parsed):
    found = json.loads((built / "claims.json").read_text(encoding="utf-8"))
    claims = {one["id"]: one for one in found["claims"]}
    assert set(claims) == {claim.id for claim in load()}
    ids = {tag["id"] for tag in parsed("book/ledger").select("[id^=claim-]")}
    for claim in load():
        one = claims[claim.id]
        assert one["verdict"] == claim.verdict and (one["ours"] is None) == (not claim.is_measured)
        page, _, anchor = one["address"].partition("#")
        assert page == "book/ledger.html" and anchor in ids, claim.id
        assert (built / one["page"]).is_file(), claim.id
        draws = one["middle 95 % of draws"]
        assert draws is None or draws[0] <= draws[1]
    assert all(
        re.fullmatch("[0-9a-f]{16}", h) for h in found["code that made each result"].values()
    )


@pytest.mark.built
def test_every_page_is_plain_text(built):
    told = (built / "llms.txt").read_text(encoding="utf-8")
    assert told.startswith("# ") and "\n> " in told
    links = re.findall(r"\]\((\S+?)\)", told)
    notebooks = {path.relative_to(built / "_sources" / "book").with_suffix("").as_posix()
                 for path in (built / "_sources" / "book").rglob("*.ipynb")}  # fmt: skip
    texts = {link.removeprefix("text/").removesuffix(".md") for link in links if "text/" in link}
    assert notebooks == texts and "claims.json" in links
    for link in links:
        text = (built / link).read_text(encoding="utf-8")
        assert link == "claims.json" or text.startswith("# "), link
        assert not re.search(r"\{[\w:-]+\}`|<abbr|Your copy of a notebook", text), link
