"""Claims as tiles: what they show against the claims, and where they lead."""

import html
import re
import subprocess
import sys

import numpy as np
import pytest
from book_pages import ROOT

from ddlib.tables import typeset
from workshop.report.evidence import cards, claims, expressions, wall
from workshop.report.evidence.claims import LEDGER, Claim, Printed
from workshop.report.evidence.verdicts import Measured

ALL = claims.load()


@pytest.fixture
def make(monkeypatch):
    """``make(band, draws)``: a claim that measures these draws."""

    def made(band, draws=None, printed="no number", **changes) -> Claim:
        fields = {
            "id": "a", "where": "section 4", "chapter": "verdict", "claim": "c < d", "why": "w",
            "refuted": "r", "verdict": "reproduced", "measure": "filters.untrained",
            "printed": printed, "band": band, **changes,
        }  # fmt: skip
        found = Measured(0.5, "told", None if draws is None else np.array(draws, float))
        monkeypatch.setattr(Claim, "measured", lambda self: found)
        return Claim(**fields)

    return made


def tiles(text) -> list[str]:
    return re.findall(r"<details class=\"claim\".*?</details>", text, re.DOTALL)


def code_of(claim) -> str:
    if not claim.measure:
        return f"{expressions.__name__.replace('.', '/')}.html#find"
    function = claims.measuring_function(claim.measure)
    return f"{function.__module__.replace('.', '/')}.html#{claim.measure.split('.')[-1]}"


def test_a_tile_for_each_claim_with_all_that_the_file_says():
    found = tiles(wall.Tiles(ALL)._repr_markdown_())
    for text, claim in zip(found, ALL, strict=True):
        head, inside = text.split("</summary>")
        assert f'id="claim-{claim.id}"' in head and ("†" in head) == bool(claim.after)
        assert html.escape(typeset(claim.claim), quote=False) in head
        assert f"<b>{cards.worded(claim, claim.judge())}</b>" in head
        assert typeset(claim.why) in inside and typeset(claim.outcome) in inside
        own = claim.printed == claims.NOT_IN_PAPER
        assert ("This book's own claim" if own else typeset(claim.as_printed())) in inside
        pages = re.findall(r"\[chapter\]\((.*?)\)", inside)
        assert len(pages) == (claim.chapter != LEDGER)
        assert all((ROOT / "book" / page).is_file() for page in pages), pages
        code = f'<a href="../_modules/{code_of(claim)}">code</a>'
        assert (code in inside) == claim.is_measured == (">code</a>" in inside)
        if width := wall.window(claim):
            assert re.search(rf"\b{width}\b", text), claim.id


def test_the_picture_of_the_draws(make):
    draws = np.linspace(0.2, 0.4, 2001)
    claim = make({"from": 0.1, "to": 0.5}, draws, Printed("0.30"))
    text = wall.Tiles([claim])._repr_markdown_()
    parts = re.findall(r'<i class="(\w+)" style="left:([\d.]+)%(?:;width:([\d.]+)%)?">', text)
    found = {name: (float(left), float(wide or 0)) for name, left, wide in parts}
    assert found["median"][0] == pytest.approx(50, abs=0.1)
    assert found["printed"][0] == pytest.approx(50, abs=0.1)
    scale = (found["band"][1]) / (0.5 - 0.1)  # per cent for a unit of the value
    assert found["draws"][1] == pytest.approx(scale * 0.95 * 0.2, abs=0.2)
    assert found["band"][0] == pytest.approx(100 - sum(found["band"]), abs=0.2)
    assert "from 0.205 to 0.395, median 0.300; reproduced from 0.100 to 0.500; printed 0.30" in text
    factor = make({"factor": 2}, np.linspace(9.0, 11.0, 50), Printed("10"))
    assert "; reproduced from 5.00 to 20.0" in wall.Tiles([factor])._repr_markdown_()


def test_what_would_have_changed_the_verdict(make, monkeypatch):
    for verdict, head in (
        ("reproduced", "What would have refuted it"),
        ("undecided", "What would have refuted it"),
        ("not reproduced", "What would have supported it"),
        ("by construction", "Why nothing could have refuted it"),
    ):
        claim = make({"to": 1}, verdict=verdict)
        monkeypatch.setattr(Claim, "judge", lambda self: self.verdict)
        text = wall.Tiles([claim])._repr_markdown_()
        assert f"*{head}:* r" in text and "c &lt; d" in text


def test_a_page_that_runs_in_the_browser_needs_no_templates():
    code = "import sys; sys.modules['jinja2'] = None; import beyond.chapters.verdict"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT / "book")
