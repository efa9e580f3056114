"""Cards: every row in one of them, and the word that follows from their rows."""

import re
from collections import Counter

from workshop.chapters import ledger
from workshop.report.evidence import cards, claims
from workshop.report.evidence.claims import Claim

ALL = claims.load()


def row(verdict, **changes) -> Claim:
    fields = {
        "id": verdict, "where": "section 4", "chapter": "verdict", "claim": "c", "printed": "p",
        "verdict": verdict, "why": "w", "refuted": "r", "measure": "m.f", "band": {"from": 1},
    }  # fmt: skip
    return Claim(**{**fields, **changes})


def card(*verdicts, kind="system", real=(), beside=()) -> cards.Card:
    rows = {"": tuple(map(row, verdicts)), "real": tuple(row(v, arm="real") for v in real)}
    return cards.Card("a", kind, "section 4", "says", rows, tuple(map(row, beside)))


def test_every_row_is_in_one_card():
    named = Counter(claim.id for card in cards._cards() for claim in card.claims)
    listed = {claim.id for claim in ALL if claim.verdict in cards.LISTS}
    assert named == Counter(claim.id for claim in ALL if claim.id not in listed)


def test_no_card_counts_a_measurement_twice():
    """A row that measures what another one does cannot come out otherwise."""
    for card in cards._cards():
        ways = [repr((c.measure, c.find, c.arguments, c.band, c.loose)) for c in card.deciding]
        assert len(set(ways)) == len(ways), card.id


def test_cards_are_of_their_kind():
    found = cards._cards()
    assert len({card.id for card in found}) == len(found)
    for card in found:
        paper = [c for c in card.deciding if c.printed != claims.NOT_IN_PAPER]
        assert card.deciding, card.id
        assert card.kind == "own" or len(paper) == len(card.deciding), card.id


def test_the_word_follows_from_the_rows_that_decide():
    good, kind, bad, unsure = cards.WORDS[0], "qualitative", "not reproduced", "undecided"
    for verdicts, word, own in (
        ((good, good), "reproduced", "held"),
        ((good, kind), "qualitative", "held"),
        ((bad, bad), "not reproduced", "failed"),
        ((good, bad, bad), "in part (1 of 3)", "open (1 of 3 held)"),
        ((kind, bad), "in part (1 of 2)", "open (1 of 2 held)"),
        ((good, unsure), "undecided", "open"),  # all, or in part
        ((kind, unsure), "undecided", "open"),
        ((bad, unsure), "undecided", "open"),  # none, or in part
        ((good, bad, unsure), "in part (1 of 3)", "open (1 of 3 held)"),  # either way
        ((unsure, unsure), "undecided", "open"),
    ):
        assert (card(*verdicts).word(), card(*verdicts, kind="own").word()) == (word, own)
    assert card(good, real=[bad], beside=[bad]).word() == "reproduced"
    assert card(real=[bad]).word() == "not reproduced"
    planted = card(bad, bad).word(lambda claim: good)
    assert planted == "reproduced" and card(good, bad, kind="own").sign() == unsure


def sorted_card(**rows) -> cards.Card:
    named = {name.replace("_", " "): tuple(map(row, v)) for name, v in rows.items()}
    return cards.Card("a", "system", "section 4", "says", named)


def test_a_card_under_one_reading_has_its_rows_and_those_of_none():
    good, bad, unsure = "reproduced", "not reproduced", "undecided"
    mixed = sorted_card(joint_damping=[good], state_feedback=[bad, good], simulated=[good])
    assert mixed.word() == "in part (3 of 4)"
    assert mixed.readings == ["state feedback", "joint damping"]
    assert mixed.spread() == {"joint damping": good, "state feedback": "in part (2 of 3)"}
    assert mixed.under("position feedback") is mixed  # was not tried on it
    further = cards.Card("a", "system", "section 4", "says", {"joint damping, 5 days": (row(bad),)})
    assert further.readings == ["joint damping"]
    plain = sorted_card(simulated=[bad])
    found = cards.by_reading([mixed, plain, sorted_card(position_feedback=[unsure])])
    assert list(found) == ["joint damping", "position feedback", "state feedback"]
    assert found["joint damping"][good] == 1 and found["position feedback"][good] == 0
    assert {name: each[bad] for name, each in found.items()} == dict.fromkeys(cards.READINGS, 1)


def test_a_card_that_has_readings_has_all_three():
    for system in cards.of_kind("system"):
        assert not system.readings or set(system.readings) == set(cards.READINGS), system.id


def test_own_findings_are_never_called_reproduced():
    told = ledger.cards("own")._repr_markdown_()
    words = re.findall(r"<b>(.*?)</b>", told)
    assert len(words) > 100
    assert all(re.match(r"(held|failed|open)\b", word) for word in words)
    assert not re.search(r"Judged:[^.]*reproduced", told)
    own = next(claim for claim in ALL if claim.printed == claims.NOT_IN_PAPER)
    assert cards.worded(own, "not reproduced, reproduced") == "failed, held"


def test_a_card_shows_each_row_once_and_its_grid_leads_to_them():
    text = "".join(ledger.cards(kind)._repr_markdown_() for kind in cards.KINDS)
    text += ledger.lists()._repr_markdown_()
    assert sorted(re.findall(r'id="claim-(.*?)"', text)) == sorted(claim.id for claim in ALL)
    assert text.count("<details") == text.count("</details>")
    (saturated,) = re.findall(r'id="card-saturated".*?</table>', text, re.S)
    heads = re.findall(r"<th>(.*?)</th>", saturated)
    assert heads == ["11", "21", "41", "any"]
    cells = re.findall(r'<tr><th scope="row">state feedback</th>(.*?)</tr>', saturated)
    links = re.findall(r'href="#claim-(.*?)"', cells[0])
    assert links == ["saturated", "saturated-21", "saturated-41"]
    assert set(re.findall(r'href="#claim-(.*?)"', text)) <= {claim.id for claim in ALL}


def test_bands_that_were_set_after_a_trial_are_marked():
    """Where the reason tells of a first trial, the row has the mark."""
    told = re.compile(r"(?i)first trials? had been seen|set after a (first )?trial")
    judged = [claim for claim in ALL if claim.verdict not in cards.LISTS]
    bare = [claim.id for claim in judged if told.search(claim.why) and "trial" not in claim.after]
    assert not bare
