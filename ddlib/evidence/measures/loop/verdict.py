"""What all verdicts together hang on: written verdicts of the ledger, compared."""

from __future__ import annotations

from ddlib.evidence import claims
from ddlib.evidence.summing_up import agreement, by_reading
from ddlib.evidence.verdicts import Measured


def changed_by_reading() -> Measured:
    """Share of the sentences judged under several readings whose verdict is not the same in all."""
    groups = by_reading(claims.of_the_paper())
    changed = sum(len({claim.verdict for claim in group.values()}) > 1 for group in groups)
    return Measured(changed / len(groups), f"{changed} of {len(groups)} sentences")


def carried_over(arm: str) -> Measured:
    """Chance that shuffled verdicts agree as often as those on two arms do.

    Parameters
    ----------
    arm : str
        As in the field ``arm`` of a claim. Sentences that could not be tested on the first arm
        are left out.
    """
    found = agreement(pairs_on(arm))
    text = f"{found.same} of {found.pairs} alike, {found.expected:.1f} by chance"
    return Measured(found.chance, text)


def pairs_on(arm: str) -> list[tuple[str, str]]:
    """Verdicts of sentences on the simulated arm and on another one, where both were tested.

    Parameters
    ----------
    arm : str
        As in the field ``arm`` of a claim.
    """
    pairs = [(first.verdict, again.verdict) for first, again in claims.judged_again(arm)]
    return [pair for pair in pairs if "not testable" not in pair]


def reproduced_share() -> Measured:
    """Share of reproduced sentences among the paper's that could have been refuted."""
    left_out = ("by construction", "not testable")
    verdicts = [c.verdict for c in claims.of_the_paper() if c.verdict not in left_out]
    count = verdicts.count("reproduced")
    return Measured(count / len(verdicts), f"{count} of {len(verdicts)}")
