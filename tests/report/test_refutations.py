"""What would have refuted a claim lies on the right side of its bands, and its words say so."""

from dataclasses import replace

import pytest
import yaml

from workshop.report.evidence import claims
from workshop.report.evidence.claims import Claim

ALL = claims.load()
NUMBERS = {
    "a thousandth": 1e-3, "one in fifty": 0.02, "one in twenty": 0.05, "a twentieth": 0.05,
    "one in ten": 0.1, "one of ten": 0.1, "a tenth": 0.1, "a fifth": 0.2, "a quarter": 0.25,
    "three tenths": 0.3, "a third": 1 / 3, "two rivals in five": 0.4, "half": 0.5, "a half": 0.5,
    "two thirds": 2 / 3, "four fifths": 0.8, "nine of ten": 0.9, "nine tenths": 0.9,
    "nine recordings of ten": 0.9, "one standard deviation": 1.0, "one and a half times": 1.5,
    "twice": 2.0, "two": 2.0, "ten times": 10.0,
}  # fmt: skip


def contradicts(claim: Claim) -> bool:
    """Whether the outcome is an edge of the bands, on the side that the verdict excludes."""
    edges, inside = claim.loose or claim.band, claim.verdict == "not reproduced"
    sides = {"from": "above", "to": "below", "factor": "within"} if inside else \
        {"from": "below", "to": "above", "factor": "outside"}  # fmt: skip
    allowed = {(sides[end], edge) for end, edge in edges.items() if end != "is"}
    return set(claim.outcome.items()) <= allowed


def test_outcomes_are_edges_on_the_side_that_the_verdict_excludes():
    told = [claim for claim in ALL if claim.outcome]
    judged = [c for c in ALL if c.verdict not in ("by construction", "not testable")]
    assert set(map(id, told)) <= set(map(id, judged)) and len(told) > 0.8 * len(judged)
    for claim in told:
        assert contradicts(claim), claim.id
        other = "reproduced" if claim.verdict == "not reproduced" else "not reproduced"
        assert not contradicts(replace(claim, verdict=other)), claim.id


def test_words_stand_for_the_bound():
    """For the bound, or for the quotient the other way round, or for what is more or less of 1."""
    entries = yaml.safe_load(claims.CLAIMS_FILE.read_text(encoding="utf-8"))
    told = [
        e["refuted"] for e in entries if isinstance(e["refuted"], dict) and "as" in e["refuted"]
    ]
    assert len(told) > 100
    for says, words, (bound, *_) in ((t.pop("says"), t.pop("as"), [*t.values()]) for t in told):
        number, per_cent = words.removesuffix(" %"), words.endswith(" %")
        value = NUMBERS.get(words) or float(number) / (100 if per_cent else 1)
        ways = (bound, bound - 1, 1 - bound, 1 / bound if bound else bound)
        assert any(value == pytest.approx(way, rel=0.012) for way in ways), says
