"""*The verdict*: verdicts by section and by reading; how far they hang on it, an arm, a draw."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ddlib._check import one_of
from ddlib.figures import COLOURS, INK, Illustration, illustrate, legend_above
from ddlib.tables import Table, typeset
from workshop.report.evidence import cards, claims
from workshop.report.evidence.cards import of_kind, tally, worded
from workshop.report.evidence.claims import SECTIONS, Claim, load
from workshop.report.evidence.verdicts import Measured
from workshop.report.evidence.wall import window

# How a bar's parts look, in the order of the words
_LOOKS = (
    {"color": COLOURS[2]},
    {"color": COLOURS[0], "alpha": 0.75},
    {"facecolor": f"{COLOURS[2]}33", "edgecolor": COLOURS[2], "lw": 1},
    {"color": COLOURS[1]},
    {"color": COLOURS[3], "alpha": 0.75},
)

_DIGIT = 5.4  # Width of a digit in a bar, points

_SHUFFLES = 10_000  # permutations that stand for chance


def by_section() -> dict[str, dict[str, int]]:
    """How many sentences of each section of the paper have which word."""
    groups: dict[str, list] = {}
    for card in sorted(of_kind("system", "methods"), key=lambda card: card.deciding[0].place()):
        groups.setdefault(SECTIONS[card.deciding[0].place()[0]], []).append(card)
    return {section: tally(group) for section, group in groups.items()}


def chosen(ids: Iterable[str]) -> Table:
    """Some rows of the ledger: claim and its chapter, printed value, ours, verdict, reason."""
    known, rows = {claim.id: claim for claim in load()}, []
    for claim in (known[one_of("ids", name, tuple(known))] for name in ids):
        width, found = window(claim), claim.here()
        told = rf"(window|at) {width}\b|\b{width} samples"
        if width and not re.search(told, f"{claim.claim} {found}"):
            found += f" (window {width})"
        sentence = f"{claim.claim} ({{doc}}`{claim.chapter}`)"
        rows.append((sentence, claim.as_printed(), found, worded(claim, claim.sure()), claim.why))
    header = ("claim", "printed", "here", "verdict", "why")
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def verdicts(counts: Mapping[str, Mapping[str, int]]) -> Illustration:
    """Sentences by section: one bar each below its title, a part for every word.

    A part has its number in it, unless it is too narrow to hold that.
    """
    if not counts:
        raise ValueError("counts must hold one section or more, got none")
    names = list(next(iter(counts.values())))

    def draw(figure: Figure):
        axis = figure.subplots()
        starts = [0] * len(counts)
        places = range(len(counts))
        most = max(sum(row.values()) for row in counts.values())
        room = (72 * figure.get_figwidth() - 24) / (1.05 * most)  # points for each sentence
        for name, look in zip(names, _LOOKS):
            numbers = [row[name] for row in counts.values()]
            bars = axis.barh(places, numbers, left=starts, height=0.5, label=name, **look)
            fits = [number * room > _DIGIT * len(str(number)) + 1 for number in numbers]
            words = [str(number) if number and fit else "" for number, fit in zip(numbers, fits)]
            axis.bar_label(bars, words, label_type="center", color=INK, size=8.5)
            starts = [a + b for a, b in zip(starts, numbers)]
        for place, title in zip(places, counts):
            axis.text(0, place - 0.3, title, size=9, va="bottom")
        axis.set_yticks([])
        axis.set_ylim(len(counts) - 0.6, -0.85)
        axis.set_xlim(0, 1.05 * most)
        axis.spines["left"].set_visible(False)
        axis.set_xlabel("sentences")
        legend_above(figure, *axis.get_legend_handles_labels())

    rows = "; ".join(
        f"{section}: " + ", ".join(f"{number} {name}" for name, number in row.items() if number)
        for section, row in counts.items()
    )
    height = 1.3 + 0.46 * len(counts)
    return illustrate(draw, f"Sentences by section of the paper. {rows}.", 7.0, height)


def readings_table(groups: Iterable[dict[str, Claim]], readings: Iterable[str]) -> Table:
    """Verdicts of sentences by reading: a row for each, those that agree last."""
    readings, rows = tuple(readings), []
    for group in groups:
        first = min(group.values(), key=lambda claim: len(claim.claim))
        verdicts = [group[name].verdict if name in group else "–" for name in readings]
        same = len({claim.verdict for claim in group.values()}) == 1
        rows.append((same, (f"{first.claim} ({first.where})", *verdicts)))
    rows.sort(key=lambda row: row[0])
    return Table(("sentence", *readings), [tuple(map(typeset, row)) for _, row in rows])


def expected_changes(sentences: Iterable[Claim]) -> tuple[int, float]:
    """How many decided verdicts rest on draws, and how many of them another draw would change."""
    decided = [claim for claim in sentences if claim.verdict != "undecided"]
    agree = [c.shares().get(c.verdict, 0.0) for c in decided if c.shares()]
    return len(agree), float(len(agree) - sum(agree))


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
