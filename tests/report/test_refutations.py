"""What would have refuted a claim lies on the right side of its bands."""

from dataclasses import replace

import pytest
from refutations import TURNED, bounds, points_right

from workshop.report.evidence import claims

ALL = {claim.id: claim for claim in claims.load()}


@pytest.mark.parametrize("claim", ALL.values(), ids=lambda claim: claim.id)
def test_a_refutation_points_the_right_way(claim):
    assert points_right(claim) is not False, (claim.verdict, claim.band, claim.loose, claim.refuted)


def test_most_refutations_are_understood():
    told = [points_right(claim) for claim in ALL.values()]
    judged = [c for c in ALL.values() if c.verdict not in ("by construction", "not testable")]
    assert sum(x is not None for x in told) > 0.75 * len(judged)


@pytest.mark.parametrize("name", sorted(TURNED))
def test_turned_ones_need_it(name):
    assert points_right(ALL[name])


def test_another_verdict_asks_for_another_sentence():
    """Of all sentences that are understood each is wrong where the verdict is the opposite."""
    judged = [claim for claim in ALL.values() if points_right(claim)]
    assert len(judged) > 250
    for claim in judged:
        other = "reproduced" if claim.verdict == "not reproduced" else "not reproduced"
        assert points_right(replace(claim, verdict=other)) is False, claim.id


@pytest.mark.parametrize(
    ("sentence", "found"),
    [
        ("An error of more than half of PD's.", [(True, 0.5)]),
        ("A share of at most 30 %.", [(False, 0.3)]),
        ("A count below 1,500 or above 2.5.", [(False, 1500.0), (True, 2.5)]),
        ("A drift of less than twice that.", [(False, 2.0)]),
        ("A rise by at least one in fifty.", [(True, 0.02)]),
        ("A larger error.", []),
    ],
)
def test_sides_and_numbers_are_read(sentence, found):
    assert bounds(sentence) == found
