"""Which way the sentence "what would have refuted it" points, against the claim's bands.

A sentence like "An error of more than half of PD's" names an edge and a side of it. For a claim
that holds or is undecided the side must be outside the bands; for one that is not reproduced,
inside. Sentences whose words are not understood are not judged.
"""

from __future__ import annotations

import re

from workshop.report.evidence.claims import Claim

ABOVE = ("above", "more than", "over", "at least", "no less than", "larger than")
BELOW = ("below", "less than", "under", "at most", "within", "fewer than", "no more than")
NUMBERS = {
    "a thousandth": 1e-3, "one in fifty": 0.02, "one in twenty": 0.05, "a twentieth": 0.05,
    "one in ten": 0.1, "one of ten": 0.1, "a tenth": 0.1, "a fifth": 0.2, "a quarter": 0.25,
    "three tenths": 0.3, "a third": 1 / 3, "half": 0.5, "a half": 0.5, "two thirds": 2 / 3,
    "three quarters": 0.75, "four fifths": 0.8, "nine of ten": 0.9, "nine recordings of ten": 0.9,
    "nine tenths": 0.9,
    "one standard deviation": 1.0, "one and a half times": 1.5, "twice": 2.0, "ten times": 10.0,
    "two rivals in five": 0.4,
}  # fmt: skip
MORE = r"above (?:that|the)\b|(?<!no )larger|more error|more than that|adds to"
LESS = r"below (?:that|the)\b|smaller|less error|no larger|at most that"

TURNED = {
    # what is taken away, of a measure that is what is left, or the other way round
    "more-hidden-units", "learnt-by-solver", "penalty-tames",
    # of the other one of the two that the measure compares
    "process-generalises-real-arm", "process-on-the-rest-real-arm", "run-time-best-window",
}  # fmt: skip


def _any(words) -> str:
    return "|".join(sorted(words, key=len, reverse=True))


_BOUND = re.compile(
    rf"\b(?P<word>{_any(ABOVE + BELOW)})\s+(?:(?P<name>{_any(NUMBERS)})\b"
    r"|(?P<number>−?\d[\d,]*(?:\.\d+)?(?:e−?-?\d+)?)\s*(?P<percent>%)?)"
)


def bounds(sentence: str) -> list[tuple[bool, float]]:
    """Whether it speaks of more (or less) than a number, and the number, all through it."""
    found = []
    for match in _BOUND.finditer(sentence):
        number = match["number"]
        value = (
            float(number.replace(",", "").replace("−", "-")) if number else NUMBERS[match["name"]]
        )
        found.append((match["word"] in ABOVE, value / 100 if match["percent"] else value))
    return found


def _same(a: float, b: float) -> bool:
    return abs(a - b) <= 0.012 * max(abs(a), abs(b))  # 0.67 is two thirds


def _side(edge: float, above: bool, value: float) -> bool | None:
    """Whether the sentence means more of the measure than the edge; None if another number."""
    if _same(value, edge) or _same(value, edge - 1):  # "a tenth larger"
        return above
    if (edge and _same(value, 1 / edge)) or _same(value, 1 - edge):
        return not above  # the quotient the other way round; "falls by"
    return None


def points_right(claim: Claim) -> bool | None:
    """Whether a claim's sentence names the side that its verdict asks for; None if not told."""
    if claim.verdict in ("by construction", "not testable"):
        return None
    edges, inside = claim.loose or claim.band, claim.verdict == "not reproduced"
    if "factor" in edges:
        told = re.search(r"(within|off\b.*by more than) a factor of", claim.refuted)
        return (told[1] == "within") == inside if told else None
    found = []
    for end, edge in edges.items():
        if end == "is":
            continue
        sides = [_side(edge, *bound) for bound in bounds(claim.refuted)]
        if not bounds(claim.refuted) and edge in (0.0, 1.0):
            sides += [True] * bool(re.search(MORE, claim.refuted))
            sides += [False] * bool(re.search(LESS, claim.refuted))
        wanted = (end == "from") == inside
        found += [(side == wanted) != (claim.id in TURNED) for side in sides if side is not None]
    return all(found) if found else None
