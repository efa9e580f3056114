"""What all verdicts together say: on verdicts made up for the purpose, and on the ledger's own."""

import itertools

import numpy as np
import pytest

from workshop.beyond.measures.loop import verdict
from workshop.report.evidence import claims
from workshop.report.evidence.claims import Claim

TEXTS = {"where": "section 4", "chapter": "verdict", "printed": "no number", "why": "-"}


def claim(name, setup=None, found="reproduced", measure="loop.verdict.reproduced_share"):
    arguments = {} if setup is None else {"setup": setup}
    return Claim(
        id=name, claim=name, verdict=found, refuted="-", measure=measure, arguments=arguments,
        band={"from": 0.0}, **TEXTS,
    )  # fmt: skip


def test_sentences_of_one_measure_belong_together():
    found = verdict.by_reading(
        [claim("a"), claim("b, position", "position feedback", "undecided"),
         claim("other", measure="loop.verdict.changed_by_reading")]
    )  # fmt: skip
    (group,) = found
    assert {k: v.id for k, v in group.items()} == {
        "state feedback": "a",
        "position feedback": "b, position",
    }
    table = verdict.readings_table(found, ("position feedback", "joint damping"))
    assert table.rows == [("a (section 4)", "undecided", "–")]


def test_sentences_on_which_readings_agree_come_last():
    same = {"x": claim("same"), "y": claim("same, y")}
    differ = {"x": claim("differ"), "y": claim("differ, y", found="undecided")}
    rows = verdict.readings_table([same, differ], ("x", "y")).rows
    assert [row[0].split()[0] for row in rows] == ["differ", "same"]


def test_agreement_against_all_permutations():
    first, second = "aabcc", "aabbc"
    found = verdict.agreement(zip(first, second))
    every = [sum(map(str.__eq__, first, p)) for p in itertools.permutations(second)]
    assert found.same == 4 and found.pairs == 5
    assert found.expected == pytest.approx(np.mean(every))
    assert found.chance == pytest.approx(np.mean(np.array(every) >= 4), abs=0.02)


def test_lists_that_have_nothing_to_do_with_each_other_agree_by_chance():
    rng = np.random.default_rng(3)
    chances = [
        verdict.agreement(rng.choice(list("abc"), (20, 2)).tolist(), seed=k).chance
        for k in range(20)
    ]
    assert np.mean(np.array(chances) < 0.05) < 0.3


def test_one_pair_is_too_few():
    with pytest.raises(ValueError, match="pairs must be two or more"):
        verdict.agreement([("a", "a")])


def test_expected_changes_are_the_shares_that_disagree(monkeypatch):
    shares = {"a": {"reproduced": 0.9, "undecided": 0.1}, "b": {"reproduced": 0.2}, "c": {}}
    monkeypatch.setattr(Claim, "shares", lambda self: shares[self.id])
    number, turning = verdict.expected_changes(claim(name) for name in shares)
    assert number == 2 and turning == pytest.approx(0.1 + 0.8)


def test_shares_of_the_ledger_are_counted_from_its_file():
    kept = [c for c in claims.of_the_paper() if c.band and c.verdict != "by construction"]
    share = np.mean([c.verdict == "reproduced" for c in kept])
    assert verdict.reproduced_share().value == pytest.approx(share)


def test_sentences_that_could_not_be_tested_on_the_first_arm_are_left_out():
    pairs = verdict.pairs_on("a real arm")
    assert 2 < len(pairs) < len(claims.judged_again("a real arm"))
    assert "not testable" not in {name for pair in pairs for name in pair}
