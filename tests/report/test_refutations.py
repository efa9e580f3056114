"""What would have refuted a claim: the words say the side that its bands leave, and the edge."""

import re

import pytest
import yaml

from workshop.report.evidence import claims

UP = {"more than", "above", "at least", "over"}
DOWN = {"less than", "fewer than", "below", "at most", "within"}
NUMBERS = {
    "one in fifty": 0.02, "one in twenty": 0.05, "a twentieth": 0.05, "one in ten": 0.1,
    "one of ten": 0.1, "a tenth": 0.1, "a fifth": 0.2, "a quarter": 0.25, "three tenths": 0.3,
    "two rivals in five": 0.4, "half": 0.5, "a half": 0.5, "two thirds": 2 / 3,
    "four fifths": 0.8, "nine of ten": 0.9, "nine tenths": 0.9, "nine recordings of ten": 0.9,
    "one and a half times": 1.5, "twice": 2.0, "two": 2.0, "ten times": 10.0,
}  # fmt: skip


def number(words: str) -> float:
    if words in NUMBERS:
        return NUMBERS[words]
    assert words[:1].isdigit(), f"{words!r} is none of NUMBERS"
    return float(words.removesuffix(" %")) / (100 if words.endswith(" %") else 1)


def sides(claim) -> dict[float, set[str]]:
    """At each edge of the wider band: the words for what lies beyond it, seen from the verdict."""
    turned = claim.verdict == "not reproduced"  # then what lies within would have supported it
    beyond = {"from": UP if turned else DOWN, "to": DOWN if turned else UP}
    beyond["factor"] = {"within"} if turned else {"more than"}
    return {edge: beyond[end] for end, edge in (claim.loose or claim.band).items()}


def agree(words: str, told: str, edge: float, beyond: set[str]) -> bool:
    """Whether words tell an edge from beyond; in its quotient or in what is left they turn."""
    value, other = number(told) if told else edge, DOWN if beyond == UP else UP
    ways = [(edge, beyond), (edge - 1, beyond), (1 - edge, other)]
    ways += [(1 / edge, other), (1 - 1 / edge, beyond)] if edge else []
    return any(value == pytest.approx(way, rel=0.012) and words in side for way, side in ways)


def test_words_and_numbers_are_those_of_the_band():
    text = claims.CLAIMS_FILE.read_text(encoding="utf-8")
    entries = claims._entries({"claims": yaml.load(text, claims._Loader)}, {})
    bad, count = [], 0
    for claim, entry in zip(claims.load(), entries, strict=True):
        before = ""
        for words, told in re.findall(r"([^{}]*)\{(.*?)\}", entry.get("refuted", "")):
            before = (re.findall("|".join(UP | DOWN), words) or [before])[-1]
            count += 1
            if not any(agree(before, told, *side) for side in sides(claim).items()):
                bad.append((claim.id, before, told, sides(claim)))
    assert not bad and count > 300
