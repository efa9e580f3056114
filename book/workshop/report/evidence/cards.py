"""Cards: a sentence of the paper, a method it speaks of or a finding of this book, with its rows.

``book/cards.yml`` says which claims judge the same sentence. A card's word follows from those of
its rows that decide:

- "reproduced" if all are, "qualitative" if all hold at least in kind, "not reproduced" if none
  does, "in part" if some do;
- "undecided" if the undecided ones can still change that word.

Rows on the real arm decide only where no others do; those ``beside`` never do. Rows that hold by
construction or cannot be tested leave their card for one of two lists, as do cards of nothing else.
This book's own findings are "held", "failed" or "open" in place of that.

Rows may be sorted by the *reading* of section 4 under which they were measured, one of `READINGS`.
Of all readings together the word says what holds whatever the reading is; `Card.under` gives the
card of one of them. The authors ran one experiment, so both are counted: `tally`, `by_reading`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from operator import attrgetter
from pathlib import Path

import yaml

from ddlib.setups import SETUPS
from workshop import BOOK
from workshop.report.evidence.claims import NOT_IN_PAPER, Claim, load

_FILE = BOOK / "cards.yml"  # Where the cards are kept

KINDS = ("system", "methods", "own")  # The paper's own system, methods of others, own findings

READINGS = tuple(SETUPS)  # What may have damped the arm of "a proportional controller"

WORDS = ("reproduced", "qualitative", "in part", "not reproduced", "undecided")

LISTS = ("by construction", "not testable")  # Verdicts whose rows make a list each

_BEST_FIRST = ("reproduced", "qualitative", "in part", "undecided", "not reproduced")

# The same words of an own finding. "Open" are those whose rows disagree, too.
OWN = {
    "not reproduced": "failed",
    "reproduced": "held",
    "qualitative": "held",
    "in part": "open",
    "undecided": "open",
}


@dataclass(frozen=True)
class Card:
    """One entry of the cards file: its rows by reading, and those beside them."""

    id: str
    kind: str
    where: str
    says: str
    rows: Mapping[str, tuple[Claim, ...]]
    beside: tuple[Claim, ...] = ()

    @property
    def claims(self) -> list[Claim]:
        """All rows of the card."""
        return [*(claim for row in self.rows.values() for claim in row), *self.beside]

    @property
    def deciding(self) -> list[Claim]:
        """The rows from which the word follows."""
        rows = [claim for row in self.rows.values() for claim in row]
        return [claim for claim in rows if not claim.arm] or rows

    @property
    def readings(self) -> list[str]:
        """The readings under which it has rows of its own."""
        return [reading for reading in READINGS if reading in map(_reading, self.rows)]

    def under(self, reading: str) -> Card:
        """The card with the rows of one reading, and those that are of none.

        A card without rows of this reading stays as it is.
        """
        if reading not in self.readings:
            return self
        rows = {k: row for k, row in self.rows.items() if _reading(k) in (reading, "")}
        return replace(self, rows=rows)

    def verdict(self, verdict_of: Callable = attrgetter("verdict")) -> str:
        """The card's word, of `WORDS`, by the written verdicts or by another function of a row."""
        return _overall(map(verdict_of, self.deciding))

    def sign(self, verdict_of: Callable = attrgetter("verdict")) -> str:
        """The word whose sign stands for the card; an own finding whose rows disagree is open."""
        verdict = self.verdict(verdict_of)
        return "undecided" if self.kind == "own" and verdict == "in part" else verdict

    def word(self, verdict_of: Callable = attrgetter("verdict")) -> str:
        """The card's word as it is shown: with "in part" goes how many rows hold."""
        verdict = self.verdict(verdict_of)
        shown = OWN[verdict] if self.kind == "own" else verdict
        if verdict != "in part":
            return shown
        verdicts = [verdict_of(claim) for claim in self.deciding]
        held = sum(v in ("reproduced", "qualitative") for v in verdicts)
        return f"{shown} ({held} of {len(verdicts)}{' held' * (self.kind == 'own')})"

    def spread(self, verdict_of: Callable = attrgetter("verdict")) -> dict[str, str]:
        """Its word under each of its readings, the best first."""
        by_name = {reading: self.under(reading) for reading in self.readings}
        order = sorted(
            by_name, key=lambda name: _BEST_FIRST.index(by_name[name].verdict(verdict_of))
        )
        return {name: by_name[name].word(verdict_of) for name in order}


def _reading(rows: str) -> str:
    """The reading in the name of some rows, before a comma; empty if there is none."""
    name = rows.partition(",")[0]
    return name if name in READINGS else ""


def _overall(verdicts: Iterable[str]) -> str:
    """The word for rows that have these verdicts; see the module."""
    verdicts = list(verdicts)
    ways = {
        _settled({way if verdict == "undecided" else verdict for verdict in verdicts})
        for way in ("reproduced", "not reproduced")
    }
    return ways.pop() if len(ways) == 1 else "undecided"


def _settled(verdicts: set[str]) -> str:
    if "not reproduced" in verdicts:
        return "in part" if len(verdicts) > 1 else "not reproduced"
    return "qualitative" if "qualitative" in verdicts else "reproduced"


@cache
def _cards(path: Path = _FILE) -> tuple[Card, ...]:
    """All cards, in the order of the file, that have rows to judge."""
    known, cards = {claim.id: claim for claim in load()}, []

    def rows(card: str, ids: Iterable[str]) -> tuple[Claim, ...]:
        if unknown := set(ids) - set(known):
            raise ValueError(f"rows of card {card!r} must be ids of claims, got {sorted(unknown)}")
        return tuple(known[name] for name in ids if known[name].verdict not in LISTS)

    for kind, entries in yaml.safe_load(path.read_text(encoding="utf-8")).items():
        for entry in entries:
            by_name = entry["rows"]
            if not isinstance(by_name, dict):
                by_name = {"": by_name}
            filled = {name: rows(entry["id"], ids) for name, ids in by_name.items()}
            filled = {name: row for name, row in filled.items() if row}
            beside = rows(entry["id"], entry.get("beside", ()))
            texts = (entry["id"], kind, entry["where"], entry["says"])
            cards.append(Card(*texts, filled or {"": beside}, beside if filled else ()))
    return tuple(card for card in cards if card.claims)


def of_kind(*kinds: str) -> list[Card]:
    """The cards of some kinds."""
    return [card for card in _cards() if card.kind in kinds]


def tally(cards: Iterable[Card], verdict_of: Callable = attrgetter("verdict")) -> dict[str, int]:
    """How many cards have which word of `WORDS`."""
    verdicts = [card.verdict(verdict_of) for card in cards]
    return {word: verdicts.count(word) for word in WORDS}


def by_reading(
    cards: Iterable[Card], verdict_of: Callable = attrgetter("verdict")
) -> dict[str, dict[str, int]]:
    """The tally if one reading is the right one, for each of `READINGS`, the best-fitting first.

    That is the one with most cards that are reproduced, then with most that hold in kind.
    """
    cards = list(cards)
    tallies = {name: tally([card.under(name) for card in cards], verdict_of) for name in READINGS}

    def fits(name):
        return tallies[name]["reproduced"], tallies[name]["qualitative"]

    return {name: tallies[name] for name in sorted(READINGS, key=fits, reverse=True)}


def worded(claim: Claim, text: str) -> str:
    """A text about a claim's verdict, in the words for own findings if it is one."""
    if claim.printed != NOT_IN_PAPER and claim.id not in _of_findings():
        return text
    words = {**OWN, "qualitative": "held in kind"}
    return re.sub("|".join(words), lambda match: words[match[0]], text)


@cache
def _of_findings() -> frozenset[str]:
    return frozenset(claim.id for card in of_kind("own") for claim in card.claims)
