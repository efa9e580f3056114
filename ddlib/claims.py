"""The paper's claims: read from ``book/claims.yml``, measured, judged.

An entry has these fields:

``id``
    A name, unique.
``where``
    Section, table, figure or page of the paper.
``chapter``
    The page of the book that deals with it.
``claim``
    What the paper says, in a few words of our own or a short quotation.
``printed``
    The printed value: a number, or text such as "by eye".
``measure``, ``with``
    A function of `ddlib.measures` as "module.function", and its keyword arguments.
``band``, ``loose``
    What makes the claim "reproduced", and what still makes it "qualitative": ``{factor: 1.5}``
    (of the printed number), ``{from: 0.9}``, ``{to: 2}``, both, or ``{is: true}``. Without
    ``loose`` a claim that misses its band is "not reproduced".
``verdict``
    What the band gives, written down so that a change of verdict is seen; or "not testable",
    then without ``measure`` and bands.
``why``
    One sentence: the reason for the verdict, the assumption that decides it.
"""

from __future__ import annotations

import importlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import NamedTuple

import yaml

from ddlib._check import one_of
from ddlib.tables import Table, number

FILE = Path(__file__).parent.parent / "book" / "claims.yml"
"""Where the claims are kept."""

VERDICTS = ("reproduced", "qualitative", "not reproduced", "not testable")
"""All verdicts, best first."""


class Measured(NamedTuple):
    """What a measuring function returns.

    Attributes
    ----------
    value : float or bool
        What the bands judge; a median, if there are many.
    text : str
        What the tables show, spread included.
    """

    value: float | bool
    text: str


@dataclass(frozen=True)
class Claim:
    """One entry of the claims file; see the module for the fields."""

    id: str
    where: str
    chapter: str
    claim: str
    printed: float | str
    verdict: str
    why: str
    measure: str = ""
    arguments: Mapping = field(default_factory=dict)
    band: Mapping = field(default_factory=dict)
    loose: Mapping = field(default_factory=dict)

    def __post_init__(self):
        for name in ("id", "where", "chapter", "claim", "why"):
            value = getattr(self, name)
            if not isinstance(value, str) or not value.strip():
                raise ValueError(f"{name} of claim {self.id!r} must be text, got {value!r}")
        one_of(f"verdict of claim {self.id!r}", self.verdict, VERDICTS)
        testable = self.verdict != "not testable"
        if testable != bool(self.measure) or testable != bool(self.band):
            raise ValueError(
                f"claim {self.id!r} must have measure and band, or be 'not testable' without them"
            )
        for bounds in (self.band, self.loose):
            self._check_band(bounds)

    def _check_band(self, bounds):
        kinds = set(bounds)
        if kinds and kinds not in ({"factor"}, {"is"}, {"from"}, {"to"}, {"from", "to"}):
            raise ValueError(
                f"band of claim {self.id!r} must be factor, is, from, to, or from and to, "
                f"got {sorted(kinds)}"
            )
        if "factor" in kinds and (isinstance(self.printed, str) or not bounds["factor"] >= 1):
            raise ValueError(
                f"factor of claim {self.id!r} must be at least 1 and the printed value a number, "
                f"got {bounds['factor']} and {self.printed!r}"
            )

    def measured(self) -> Measured:
        """What we find, by the claim's measuring function.

        Raises
        ------
        ValueError
            If the claim is not testable.
        """
        if not self.measure:
            raise ValueError(f"claim {self.id!r} is not testable: it has no measure")
        return _measured(self.measure, json.dumps(dict(self.arguments), sort_keys=True))

    def judge(self) -> str:
        """The verdict that the bands give for the measured value."""
        if not self.measure:
            return "not testable"
        value = self.measured().value
        if self._within(self.band, value):
            return "reproduced"
        return "qualitative" if self.loose and self._within(self.loose, value) else VERDICTS[2]

    def _within(self, bounds, value) -> bool:
        if "is" in bounds:
            return bool(value) == bounds["is"]
        if "factor" in bounds:
            ratio = value / self.printed
            return 1 / bounds["factor"] <= ratio <= bounds["factor"]
        return bounds.get("from", float("-inf")) <= value <= bounds.get("to", float("inf"))


@cache
def _measured(measure: str, arguments: str) -> Measured:
    module, _, function = measure.partition(".")
    found = getattr(importlib.import_module(f"ddlib.measures.{module}"), function)
    result = found(**json.loads(arguments))
    if not isinstance(result, Measured):
        raise TypeError(f"{measure} must return a Measured, got {result!r}")
    return result


def load(path: Path = FILE) -> list[Claim]:
    """All claims, in the order of the file.

    Raises
    ------
    ValueError
        If an entry has unknown or missing fields, or an id twice.
    """
    entries = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    claims, seen = [], set()
    for entry in entries:
        entry = dict(entry)
        entry["arguments"] = entry.pop("with", {})
        try:
            claim = Claim(**entry)
        except TypeError as error:
            raise ValueError(
                f"claim {entry.get('id')!r} must have the known fields: {error}"
            ) from None
        if claim.id in seen:
            raise ValueError(f"id must be unique, got {claim.id!r} twice")
        seen.add(claim.id)
        claims.append(claim)
    return claims


def of_chapter(chapter: str) -> list[Claim]:
    """The claims that a page of the book deals with; an error if there are none."""
    found = [claim for claim in load() if claim.chapter == chapter]
    if not found:
        raise ValueError(f"chapter must have claims in {FILE.name}, got {chapter!r}")
    return found


def _printed(claim: Claim) -> str:
    return claim.printed if isinstance(claim.printed, str) else f"{claim.printed:g}"


def _found(claim: Claim) -> str:
    return claim.measured().text if claim.measure else "–"


def chapter_table(chapter: str) -> Table:
    """A chapter's "Paper and reproduction": claim, printed value, ours, verdict, reason.

    Parameters
    ----------
    chapter : str
        Name of the page, like "window-networks".
    """
    header = ("claim", "printed", "here", "verdict", "why")
    return Table(
        header,
        [
            (f"{c.claim} ({c.where})", _printed(c), _found(c), c.judge(), c.why)
            for c in of_chapter(chapter)
        ],
    )


def summary(claims: Iterable[Claim]) -> Table:
    """How many claims have which verdict."""
    verdicts = [claim.judge() for claim in claims]
    rows = [(verdict, number(float(verdicts.count(verdict)), 3)) for verdict in VERDICTS]
    return Table(("verdict", "claims"), [*rows, ("all", str(len(verdicts)))])
