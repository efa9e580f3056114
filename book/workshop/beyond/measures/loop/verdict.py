"""What all verdicts together say: how far they hang on a reading, on an arm, on a draw."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from workshop.report.evidence import cards, claims
from workshop.report.evidence.claims import Claim
from workshop.report.evidence.verdicts import Measured

_SHUFFLES = 10_000  # permutations that stand for chance


def by_reading(sentences: Iterable[Claim]) -> list[dict[str, Claim]]:
    """Sentences judged under two or more readings of section 4: claims by the reading's name."""
    groups: dict[tuple, dict[str, Claim]] = {}
    for claim in sentences:
        if claim.is_measured:
            key, setup = claim.but_for_reading()
            groups.setdefault(key, {})[setup] = claim
    return [group for group in groups.values() if len(group) > 1]


class _Agreement(NamedTuple):
    """How many pairs are alike, how many would be, shuffled, and how often as many are."""

    pairs: int
    same: int
    expected: float
    chance: float


def agreement(pairs: Iterable[tuple[str, str]]) -> _Agreement:
    """Whether pairs of verdicts agree more often than shuffled ones."""
    pairs = list(pairs)
    if len(pairs) < 2:
        raise ValueError(f"pairs must be two or more, got {len(pairs)}")
    first, second = np.array(pairs).T
    same, rng = int((first == second).sum()), np.random.default_rng(0)
    drawn = np.array([(first == rng.permutation(second)).sum() for _ in range(_SHUFFLES)])
    expected = sum((first == v).sum() * (second == v).sum() for v in set(first)) / len(pairs)
    return _Agreement(len(pairs), same, float(expected), float((drawn >= same).mean()))


def changed_by_reading() -> Measured:
    """Share of the sentences judged under several readings whose verdict is not the same in all."""
    groups = by_reading(claims.of_the_paper())
    changed = sum(len({claim.verdict for claim in group.values()}) > 1 for group in groups)
    return Measured(changed / len(groups), f"{changed} of {len(groups)} sentences")


def carried_over(arm: str) -> Measured:
    """Chance that shuffled verdicts agree as often as those on two arms do."""
    found = agreement(pairs_on(arm))
    text = f"{found.same} of {found.pairs} alike, {found.expected:.1f} by chance"
    return Measured(found.chance, text)


def pairs_on(arm: str) -> list[tuple[str, str]]:
    """Verdicts of sentences on the simulated arm and on another one, where both were tested."""
    pairs = [(first.verdict, again.verdict) for first, again in claims.judged_again(arm)]
    return [pair for pair in pairs if "not testable" not in pair]


def reproduced_share() -> Measured:
    """Share of the paper's sentences that are reproduced, each counted once."""
    found = cards.tally(cards.of_kind("system", "methods"))
    count, total = found["reproduced"], sum(found.values())
    return Measured(count / total, f"{count} of {total}")
