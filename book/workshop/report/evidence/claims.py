"""The paper's claims: read from ``book/claims.yml``, measured, judged.

Claims are listed by the chapter that deals with them. Each is an entry with these fields::

    - chapter: window-networks
      claims:
      - id: asymptote
        where: section 3.3
        claim: trained until the derivative of the error was nearly zero
        printed: nearly zero
        measure: windows.last_rate
        band: {to: 0.1}
        verdict: reproduced
        refuted: A last rate of more than {a tenth} of what training took off.
        why: What more training is worth is another row.

``chapter``
    The page of the book that deals with it; `LEDGER` if there is no other.
``id``
    A name, unique.
``where``
    Section, table, figure or appendix of the paper, like "section 3.1" or "Figure 5-4".
``arm``, ``again``
    Left out for most. Whose arm it is judged on if not on the simulated ones of this book, like
    "a real arm"; and the id of the claim whose sentence of the paper it judges once more. It is
    judged like the others and not counted twice among the paper's.
``claim``
    What the paper says, in a few words of our own or a short quotation.
``printed``
    The printed value: a number, or text such as "by eye"; `NOT_IN_PAPER` for what this book claims
    itself.
``measure`` or ``find``, ``with``
    A function of `workshop.report.measures` as "module.function", and its keyword arguments, or
    one of `workshop.chapters` with "chapters." before, or one of Part IV by its full name,
    "beyond.module.function";
    or an expression of `workshop.report.evidence.expressions`, and what its placeholders stand for.
``band``, ``loose``
    What makes the claim "reproduced", and what still makes it "qualitative": ``{factor: 1.5}``
    (of the printed number), ``{from: 0.9}``, ``{to: 2}``, both, or ``{is: true}``. Without
    ``loose`` a claim that misses its band is "not reproduced".
``verdict``
    What the band gives, written down so that a change is seen (`judging`). Two are chosen by hand:
    "by construction" if the band could hardly be missed; then it has ``certain`` in place of
    ``refuted`` and no ``loose``, and a miss is "not reproduced". And "not testable"; then without
    bands, and a ``measure`` only tells from which value of an assumed parameter on the claim would
    turn.
``after``
    Left out for most. What came before the band: "trial" if a first trial had been seen, "change"
    if it replaced another one, or "trial, change".
``why``
    One sentence: the reason for the verdict, the assumption that decides it.
``refuted``
    One sentence, by the verdict: the outcome that would have made it "not reproduced"; for a claim
    that is, the outcome that would have made it better; what a test would need, if not testable.
    An outcome is a noun with what belongs to it. The edge of the wider band stands in braces, in
    words or, by itself, as ``{}``: "more than {a tenth}".
``certain``
    One sentence in place of ``refuted``: why no outcome could refute it. `Claim.judge` says "by
    construction" by this field alone, so that the written word cannot decide itself.

What several claims have in common is said once, in an entry with ``claims`` below it, each of which
says what is its own. So one sentence of the paper is one entry, whatever it is tried with::

    - id: asymptote-{width}
      claim: trained until the derivative of the error was nearly zero, window {width}
      ...
      claims:
      - with: {width: 11}
        verdict: reproduced
      - with: {width: 21}
        verdict: qualitative
      - reading: joint damping
        with: {width: 21}
        verdict: undecided

``{width}`` in ``id`` and ``claim`` is an argument of ``with``. A ``reading`` of section 4 other
than the entry's is the argument ``setup``, and is named at the end of both: the last one is
"asymptote-21-damping".
"""

from __future__ import annotations

import importlib
import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, lru_cache
from pathlib import Path

import joblib
import numpy as np
import yaml

from ddlib._check import one_of
from ddlib.setups import STATE_FEEDBACK
from workshop import BOOK
from workshop.report import results
from workshop.report.evidence.expressions import find
from workshop.report.evidence.verdicts import (
    VERDICTS,
    Measured,
    not_contradicted,
    share_told,
    shares_of_draws,
    verdict_of_shares,
)

CLAIMS_FILE = BOOK / "claims.yml"  # Where the claims are kept

LEDGER = "ledger"  # The page of all claims, and the chapter of those that no other page deals with

# Environment variable with a folder in which notebooks that are built together share what they
# measured: each runs in a process of its own, which an argument does not reach. Who sets it takes
# a new folder for other code or results.
SHARED = "DDLIB_MEASURED"

# As `printed`: a claim of this book, to explain what the paper's section reports. It is judged
# like the others, in its chapter, and is not counted among the paper's.
NOT_IN_PAPER = "not in the paper"

# Titles of the paper's sections; abstract and appendix are numbered so that they sort
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

# What ends id and sentence of a claim under a reading of section 4 other than its entry's
_READINGS = {
    "": ("", ""),
    "state feedback": ("-state", ", with state feedback"),
    "position feedback": ("-position", ", with position feedback alone"),
    "joint damping": ("-damping", ", with damping in the joints"),
}

_PLACE = re.compile(
    r"(?P<abstract>Abstract)|(?P<appendix>Appendix I\b)"
    r"|section (?P<section>[1-7])(?:\.(?P<part>\d))?"
    r"|(?P<float>Table|Figure) (?P<in>[1-7])-(?P<no>\d)"
)


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
    refuted: str = ""
    certain: str = ""
    measure: str = ""
    find: Mapping = field(default_factory=dict)
    arguments: Mapping = field(default_factory=dict)
    band: Mapping = field(default_factory=dict)
    loose: Mapping = field(default_factory=dict)
    arm: str = ""
    again: str = ""
    after: str = ""

    def __post_init__(self):
        if bool(self.refuted) == bool(self.certain):
            raise ValueError(f"claim {self.id!r} must have either refuted or certain")
        for name in ("id", "where", "chapter", "claim", "why", "outcome"):
            value = getattr(self, name)
            if not isinstance(value, str) or not value.strip():
                raise ValueError(f"{name} of claim {self.id!r} must be text, got {value!r}")
        self.place()
        one_of(f"verdict of claim {self.id!r}", self.verdict, VERDICTS)
        one_of(f"after of claim {self.id!r}", self.after, ("", "trial", "change", "trial, change"))
        testable = self.verdict != "not testable"
        if testable != bool(self.band) or (testable and bool(self.measure) == bool(self.find)):
            raise ValueError(
                f"claim {self.id!r} must have measure or find, and band, or be 'not testable' "
                "without band"
            )
        for bounds in filter(None, (self.band, self.loose)):
            if set(bounds) not in ({"factor"}, {"is"}, {"from"}, {"to"}, {"from", "to"}):
                raise ValueError(
                    f"band of claim {self.id!r} must be factor, is, from, to, or from and to, "
                    f"got {sorted(bounds)}"
                )
            if "factor" in bounds and (isinstance(self.printed, str) or not bounds["factor"] >= 1):
                raise ValueError(
                    f"factor of claim {self.id!r} must be at least 1 and the printed value a "
                    f"number, got {bounds['factor']} and {self.printed!r}"
                )

    @property
    def outcome(self) -> str:
        """What would have refuted it, or why nothing could have."""
        return self.refuted or self.certain

    @property
    def is_measured(self) -> bool:
        """Whether anything measures it."""
        return bool(self.measure or self.find)

    def key_and_setup(self) -> tuple[str, str]:
        """What measures it without the argument ``setup``, and that: a reading of the loop."""
        rest = {name: value for name, value in self.arguments.items() if name != "setup"}
        key = json.dumps([self.measure, self.find, rest], sort_keys=True)
        return key, self.arguments.get("setup", STATE_FEEDBACK.name)

    def place(self) -> tuple[str, int, int]:
        """Where the claim stands: key of `SECTIONS`, subsection, number of a table or figure.

        What comes first in ``where`` counts. Tables and figures come after their section's
        text, whose subsections come in order: sort by this.
        """
        match = _PLACE.search(self.where)
        if match is None:
            raise ValueError(
                f"where of claim {self.id!r} must name a section from 1 to 7, a table, a figure, "
                f"'Appendix I' or 'Abstract' of the paper, got {self.where!r}"
            )
        if match["abstract"] or match["appendix"]:
            return "0" if match["abstract"] else "8", 0, 0
        if match["float"]:
            return match["in"], 10 if match["float"] == "Table" else 20, int(match["no"])
        return match["section"], int(match["part"] or 0), 0

    def measured(self) -> Measured:
        """What we find, by the claim's measuring function or expression."""
        if not self.is_measured:
            raise ValueError(f"claim {self.id!r} is not testable: it has no measure")
        try:
            return _measured(json.dumps([self.measure, self.find, self.arguments]))
        except Exception as error:
            given = ", ".join(f"{name}={value!r}" for name, value in self.arguments.items())
            raise RuntimeError(
                f"claim {self.id!r} could not be measured by {self.measure or 'find'}({given}): "
                f"{type(error).__name__}: {error}"
            ) from error

    def judge(self) -> str:
        """The verdict: of the committed results `fresh`; of others the written one while it stands.

        Whether it stands: see `verdicts`. Without replicates it has to be `fresh`.
        """
        shares = self.shares()
        stands = shares and not results._committed() and not_contradicted(self.verdict, shares)
        return self.verdict if stands else self.fresh()

    def fresh(self) -> str:
        """The verdict of the bands for the measured value alone, whatever is written."""
        if not self.band:
            return "not testable"
        shares = self.shares()
        return verdict_of_shares(shares) if shares else self._verdicts([self.measured().value])[0]

    def shares(self) -> dict[str, float]:
        """Share of the replicates in which each verdict comes out; empty without replicates."""
        replicates = self.measured().replicates if self.band else None
        return {} if replicates is None else shares_of_draws(self._verdicts(replicates))

    def _verdicts(self, values) -> list[str]:
        """The verdict that the bands give for each of some values."""
        values = np.asarray(values)
        best = "by construction" if self.certain else "reproduced"
        nearly = self._within(self.loose, values) if self.loose else False
        rest = np.where(nearly, "qualitative", "not reproduced")
        return np.where(self._within(self.band, values), best, rest).tolist()

    def edges(self) -> list[float]:
        """Values at which the verdict turns."""
        edges = []
        for bounds in (self.band, self.loose):
            edges += [bounds[name] for name in ("from", "to") if name in bounds]
            if "factor" in bounds:
                edges += [self.printed / bounds["factor"], self.printed * bounds["factor"]]
        return sorted(set(edges))

    def as_printed(self) -> str:
        """What the paper prints, for a table."""
        if isinstance(self.printed, (str, Printed)):
            return getattr(self.printed, "text", self.printed)
        return f"{self.printed:,g}"

    def our_value(self) -> str:
        """What we find, for a table."""
        return self.measured().text if self.is_measured else "–"

    def verdict_with_share(self) -> str:
        """The verdict, and in which share of the draws it comes out where that was found."""
        verdict, shares = self.judge(), self.shares()
        if not shares:
            return verdict
        if verdict == "undecided":
            words = ", ".join(f"{share_told(share)} {name}" for name, share in shares.items())
            return f"undecided: {words} of draws"
        return f"{verdict}, {share_told(shares[verdict])} of draws"

    def _within(self, bounds, values: np.ndarray) -> np.ndarray:
        if "is" in bounds:
            return values == bounds["is"]
        if "factor" in bounds:
            ratios = values / self.printed
            return (1 / bounds["factor"] <= ratios) & (ratios <= bounds["factor"])
        return (bounds.get("from", -np.inf) <= values) & (values <= bounds.get("to", np.inf))


@cache
def _measured(way: str) -> Measured:
    """`_measure`, once in a process, and once in all that share the folder `SHARED` names."""
    folder = os.environ.get(SHARED)
    return joblib.Memory(folder, verbose=0).cache(_measure)(way) if folder else _measure(way)


def measuring_function(measure: str) -> Callable:
    """The function that a claim names: "module.function", with another room's name in front."""
    room = measure.partition(".")[0]
    places = {"beyond": measure, "chapters": f"workshop.{measure}"}
    module, _, name = places.get(room, f"workshop.report.measures.{measure}").rpartition(".")
    return getattr(importlib.import_module(module), name)


def _measure(way: str) -> Measured:
    """What a function of some name or an expression finds with some arguments."""
    measure, expression, arguments = json.loads(way)
    result = measuring_function(measure)(**arguments) if measure else find(expression, arguments)
    if not isinstance(result, Measured):
        raise TypeError(f"{measure} must return a Measured, got {result!r}")
    unclear = result.replicates is not None and np.isnan(result.replicates).any()
    if not math.isfinite(result.value) or unclear or not str(result.text).strip():
        raise ValueError(f"{measure} must return a finite value and a text, got {result!r}")
    return result


class Printed(float):
    """A number that keeps the digits it is printed with."""

    def __new__(cls, text: str):
        """From the text, like "0.10"."""
        number = super().__new__(cls, text)
        number.text = text
        return number

    def __getnewargs__(self):
        return (self.text,)


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
    """Numbers with a point are `Printed`; the parser in C is seven times as fast, where it is."""


_Loader.add_constructor("tag:yaml.org,2002:float", lambda _, node: Printed(node.value))


def load(path: Path = CLAIMS_FILE) -> list[Claim]:
    """All claims, in the order of the file."""
    return list(_parsed(path.read_text(encoding="utf-8")))


@lru_cache(maxsize=4)
def _parsed(text: str) -> tuple[Claim, ...]:
    """The claims of a file's text; a ledger asks for the same ones many times."""
    claims = {}
    for fields in _entries({"claims": yaml.load(text, _Loader)}, {}):
        try:
            claim = _claim(**fields)
        except (TypeError, LookupError, StopIteration) as error:
            raise ValueError(
                f"claim {fields.get('id')!r} must have the known fields: {error}"
            ) from None
        if claim.id in claims:
            raise ValueError(f"id must be unique, got {claim.id!r} twice")
        claims[claim.id] = claim
    for claim in claims.values():
        if claim.again and claim.again not in claims:
            raise ValueError(f"again of claim {claim.id!r} must be an id, got {claim.again!r}")
    return tuple(claims.values())


def _entries(entry: Mapping, around: Mapping) -> Iterator[dict]:
    """The fields of each claim that an entry stands for, with what is said around it."""
    arguments = {**around.get("with", {}), **entry.get("with", {})}
    fields = {**around, **entry, "with": arguments}
    inner = fields.pop("claims", None)
    if inner is None:
        yield fields
    for claim in inner or ():
        yield from _entries(claim, fields)


def _claim(*, id: str, claim: str, refuted: str = "", reading: str = "", **fields) -> Claim:
    """A claim of the fields that an entry gives it."""
    arguments = fields.pop("with")
    end, words = _READINGS[reading]
    if reading:
        arguments["setup"] = reading
    edges = iter((fields.get("loose") or fields.get("band") or {}).values())
    return Claim(
        id=id.format(**arguments) + end,
        claim=claim.format(**arguments) + words,
        refuted=re.sub(r"\{(.*?)\}", lambda words: words[1] or f"{next(edges):,g}", refuted),
        arguments=arguments,
        **fields,
    )


def measured(id: str) -> Measured:
    """What we find for one claim, for a page that quotes it."""
    by_id = {claim.id: claim for claim in load()}
    if id not in by_id:
        raise ValueError(f"id must be of a claim in {CLAIMS_FILE.name}, got {id!r}")
    return by_id[id].measured()


def of_the_paper() -> list[Claim]:
    """All claims but this book's own and those that are judged again on another arm."""
    return [claim for claim in load() if claim.printed != NOT_IN_PAPER and not claim.arm]


def judged_again(arm: str) -> list[tuple[Claim, Claim]]:
    """Sentences of the paper that are judged twice: the first claim and the one on another arm."""
    first = {claim.id: claim for claim in load()}
    return [(first[c.again], c) for c in first.values() if c.arm == arm and c.again]


def of_chapter(chapter: str) -> list[Claim]:
    """The claims that a page of the book deals with; an error if there are none."""
    claims = [claim for claim in load() if claim.chapter == chapter]
    if not claims:
        raise ValueError(f"chapter must have claims in {CLAIMS_FILE.name}, got {chapter!r}")
    return claims
