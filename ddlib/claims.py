"""The paper's claims: read from ``book/claims.yml``, measured, judged.

An entry has these fields:

``id``
    A name, unique.
``where``
    Section, table, figure or appendix of the paper, like "section 3.1" or "Figure 5-4".
``chapter``
    The page of the book that deals with it; `LEDGER` if there is no other.
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
import math
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import NamedTuple

import joblib
import yaml

from ddlib._check import one_of
from ddlib.tables import Table, number

FILE = Path(__file__).parent.parent / "book" / "claims.yml"
"""Where the claims are kept."""

LEDGER = "ledger"
"""The page of all claims, and the chapter of those that no other page deals with."""

SHARED = "DDLIB_MEASURED"
"""Environment variable with a folder in which notebooks that are built together share what they
measured. Who sets it takes a new folder for other code or results."""

VERDICTS = ("reproduced", "qualitative", "not reproduced", "not testable")
"""All verdicts, best first."""

SECTIONS = {
    "0": "Abstract",
    "1": "1. Introduction",
    "2": "2. Problem definition",
    "3": "3. Network architecture",
    "4": "4. Results",
    "5": "5. Analysis",
    "6": "6. Preliminary results from simulation",
    "7": "7. Conclusion",
    "8": "Appendix I. Trajectories used",
}
"""Titles of the paper's sections; abstract and appendix are numbered so that they sort."""

_PLACE = re.compile(
    r"(?P<abstract>Abstract)|(?P<appendix>Appendix I\b)"
    r"|section (?P<section>\d)(?:\.(?P<part>\d))?|(?P<float>Table|Figure) (?P<in>\d)-(?P<no>\d)"
)


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


class MeasureError(RuntimeError):
    """A claim's measuring function failed; the message names the claim."""


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
        self.place()
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

    def place(self) -> tuple[str, int, int]:
        """Where the claim stands: key of `SECTIONS`, subsection, number of a table or figure.

        What comes first in ``where`` counts. Tables and figures come after their section's
        text, whose subsections come in order: sort by this.

        Raises
        ------
        ValueError
            If ``where`` names none of the paper's parts.
        """
        found = _PLACE.search(self.where)
        if found is None or (section := self._section(found)) not in SECTIONS:
            raise ValueError(
                f"where of claim {self.id!r} must name a section from 1 to 7, a table, a figure, "
                f"'Appendix I' or 'Abstract' of the paper, got {self.where!r}"
            )
        after_text = 10 if found["float"] == "Table" else 20
        if found["float"]:
            return section, after_text, int(found["no"])
        return section, int(found["part"] or 0), 0

    @staticmethod
    def _section(found: re.Match) -> str:
        if found["abstract"] or found["appendix"]:
            return "0" if found["abstract"] else "8"
        number = found["section"] or found["in"]
        return number if "1" <= number <= "7" else ""

    def measured(self) -> Measured:
        """What we find, by the claim's measuring function.

        Raises
        ------
        ValueError
            If the claim is not testable.
        MeasureError
            If its function is missing, fails, or returns what cannot be judged.
        """
        if not self.measure:
            raise ValueError(f"claim {self.id!r} is not testable: it has no measure")
        try:
            return _measured(self.measure, json.dumps(dict(self.arguments), sort_keys=True))
        except Exception as error:
            given = ", ".join(f"{name}={value!r}" for name, value in self.arguments.items())
            raise MeasureError(
                f"claim {self.id!r} could not be measured by {self.measure}({given}): "
                f"{type(error).__name__}: {error}"
            ) from error

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
    """`_measure`, once in a process, and once in all that share the folder `SHARED` names."""
    folder = os.environ.get(SHARED)
    if not folder:
        return _measure(measure, arguments)
    return joblib.Memory(folder, verbose=0).cache(_measure)(measure, arguments)


def _measure(measure: str, arguments: str) -> Measured:
    module, _, function = measure.partition(".")
    found = getattr(importlib.import_module(f"ddlib.measures.{module}"), function)
    result = found(**json.loads(arguments))
    if not isinstance(result, Measured):
        raise TypeError(f"{measure} must return a Measured, got {result!r}")
    if not math.isfinite(result.value) or not str(result.text).strip():
        raise ValueError(f"{measure} must return a finite value and a text, got {result!r}")
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


def of_section(section: str) -> list[Claim]:
    """The claims of a section of the paper, in the paper's order.

    Parameters
    ----------
    section : str
        Key of `SECTIONS`: "0" for the abstract, "1" to "7", "8" for Appendix I.
    """
    one_of("section", section, tuple(SECTIONS))
    return sorted((c for c in load() if c.place()[0] == section), key=Claim.place)


def ledger_table(section: str) -> Table:
    """All claims of a section of the paper, in its order: values, verdicts, bands, reasons.

    The place in the paper is a link to the chapter that deals with the claim.

    Parameters
    ----------
    section : str
        Key of `SECTIONS`: "0" for the abstract, "1" to "7", "8" for Appendix I.
    """
    header = ("claim", "printed", "here", "verdict (judged by)", "why")
    return Table(
        header,
        [
            (f"{c.claim} ({_linked(c)})", _printed(c), _found(c), _judged(c), c.why)
            for c in of_section(section)
        ],
    )


def _judged(claim: Claim) -> str:
    return f"{claim.judge()} ({bands(claim)})" if claim.measure else claim.judge()


def bands(claim: Claim) -> str:
    """The value that is judged and what decides the verdict, in words.

    Parameters
    ----------
    claim : Claim
    """
    if not claim.measure:
        return "not measured"
    value = claim.measured().value
    shown = ("no", "yes")[bool(value)] if "is" in claim.band else number(float(value), 2)
    text = f"{shown}; reproduced {_bounds(claim.band)}"
    return f"{text}, qualitative {_bounds(claim.loose)}" if claim.loose else text


def _bounds(bounds: Mapping) -> str:
    if "is" in bounds:
        return "if yes" if bounds["is"] else "if no"
    if "factor" in bounds:
        return f"within a factor of {bounds['factor']:g}"
    words = [f"{name} {bounds[name]:g}" for name in ("from", "to") if name in bounds]
    return " ".join(words)


def _linked(claim: Claim) -> str:
    """The claim's place in the paper, as a link to its chapter."""
    names = (f"{claim.chapter}.ipynb", f"{claim.chapter}.md")
    page = next((name for name in names if FILE.with_name(name).is_file()), None)
    own = claim.chapter == LEDGER or page is None
    return claim.where if own else f"[{claim.where}]({page})"


def counts(claims: Iterable[Claim]) -> dict[str, dict[str, int]]:
    """How many claims of each section of the paper have which verdict.

    Returns
    -------
    dict
        ``{title of the section: {verdict: number}}``, sections without claims left out.
    """
    found: dict[str, dict[str, int]] = {}
    for claim in sorted(claims, key=Claim.place):
        row = found.setdefault(SECTIONS[claim.place()[0]], dict.fromkeys(VERDICTS, 0))
        row[claim.judge()] += 1
    return found


def summary(claims: Iterable[Claim]) -> Table:
    """How many claims have which verdict."""
    verdicts = [claim.judge() for claim in claims]
    rows = [(verdict, str(verdicts.count(verdict))) for verdict in VERDICTS]
    return Table(("verdict", "claims"), [*rows, ("all", str(len(verdicts)))])
