"""What all verdicts together say: on verdicts made up for the purpose, and on the ledger's own."""

import itertools

import numpy as np
import pytest

from beyond.chapters import verdict
from workshop.report.evidence.claims import Claim

pytestmark = pytest.mark.usefixtures("planted_members")


def claim(name, setup=None, found="reproduced", measure="beyond.chapters.verdict.reproduced_share"):
    return Claim(
        id=name, claim=name, verdict=found, refuted="-", measure=measure, band={"from": 0.0},
        arguments={} if setup is None else {"setup": setup},
        where="section 4", chapter="verdict", printed="no number", why="-",
    )  # fmt: skip


def test_agreement_against_all_permutations():
    first, second = "aabcc", "aabbc"
    found = verdict._agreement(zip(first, second))
    every = [sum(map(str.__eq__, first, p)) for p in itertools.permutations(second)]
    assert found.same == 4 and found.pairs == 5
    assert found.expected == pytest.approx(np.mean(every))
    assert found.chance == pytest.approx(np.mean(np.array(every) >= 4), abs=0.02)


def test_expected_changes_are_the_shares_that_disagree(monkeypatch):
    shares = {"a": {"reproduced": 0.9, "undecided": 0.1}, "b": {"reproduced": 0.2}, "c": {}}
    monkeypatch.setattr(Claim, "shares", lambda self: shares[self.id])
    number, turning = verdict._expected_changes(map(claim, shares))
    assert number == 2 and turning == pytest.approx(0.1 + 0.8)
