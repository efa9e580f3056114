"""Claims as tiles to open.

A tile is a ``<details>`` with an address, ``#claim-ID``, that can be read without a script;
``book/_static/ledger.js`` opens it for its address.
"""

from __future__ import annotations

import html
import inspect
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from ddlib.tables import significant, typeset
from workshop.report.evidence.cards import LISTS, WORDS, worded
from workshop.report.evidence.claims import (
    CLAIMS_FILE,
    LEDGER,
    NOT_IN_PAPER,
    Claim,
    Printed,
    measuring_function,
    of_chapter,
)
from workshop.report.evidence.expressions import find

# A sign for each verdict, so that colour is not all that tells them apart
_MARKS = dict(zip((*WORDS, *LISTS), "●◐◔✕?≡–"))

# What a claim's `refuted` tells, if not what would have refuted it
_HEADS = {
    "not reproduced": "What would have supported it",
    "by construction": "Why nothing could have refuted it",
    "not testable": "What a test would need",
}

# What came before the band of a claim
_AFTER = {
    "trial": "set after a first trial had been seen",
    "change": "changed after it was first written",
    "trial, change": "set after a first trial had been seen, and changed later",
}

_CODE = "../_modules"  # The folder of the pages that show source, beside that of the chapters

_MIDDLE = (0.025, 0.5, 0.975)  # Quantiles of the draws that a tile's picture shows

_WIDE = 20.0  # a scale is logarithmic from this ratio of its ends on


def mark(verdict: str) -> str:
    """A verdict's sign, for the page."""
    name = verdict.replace(" ", "-")
    return f'<span class="sign v-{name}" aria-hidden="true">{_MARKS[verdict]}</span>'


def rendered(name: str, /, **values) -> str:
    """A template of the folder beside this module, as Markdown: it says itself what it escapes."""
    return _templates().get_template(f"{name}.md.jinja").render(mark=mark, **values)


@cache
def _templates():
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # not in a reader's browser

    home = FileSystemLoader(Path(__file__).with_name("templates"))
    return Environment(loader=home, trim_blocks=True, undefined=StrictUndefined)


@dataclass(frozen=True)
class Tiles:
    """Claims to open: sentence and verdict outside; value, picture, bands and reasons inside."""

    claims: Iterable[Claim]
    on: str = LEDGER

    def __post_init__(self):
        object.__setattr__(self, "claims", tuple(self.claims))

    def _repr_markdown_(self) -> str:
        return "\n\n".join(_tile(claim, self.on) for claim in self.claims)


def chapter_tiles(chapter: str) -> Tiles:
    """A chapter's "Paper and reproduction": its claims as `Tiles`."""
    return Tiles(of_chapter(chapter), chapter)


def _tile(claim: Claim, on: str) -> str:
    verdict, width, ours = claim.judge(), window(claim), claim.our_value()
    own = claim.printed == NOT_IN_PAPER
    judged = f"Judged: {claim.verdict_with_share()} ({_bands(claim)})." if claim.band else ""
    return rendered(
        "claim",
        claim=claim,
        verdict=verdict,
        word=worded(claim, verdict),
        changed=_AFTER.get(claim.after),
        says=html.escape(typeset(claim.claim), quote=False),
        source=typeset("This book's own claim" if own else f"Printed: {claim.as_printed()}"),
        ours=typeset(ours),
        width=None if str(width) in f"{claim.claim} {ours}" else width,
        draws=_draws(claim),
        judged=typeset(worded(claim, judged)),
        why=typeset(claim.why),
        head=_HEADS.get(claim.verdict, "What would have refuted it"),
        refuted=typeset(claim.outcome),
        links=_links(claim, on),
    )


def _links(claim: Claim, on: str) -> list[str]:
    page, links = _page_of(claim), []
    up = "" if on == LEDGER else "../"  # evidence pages have a folder of their own
    if page and claim.chapter != on:
        links.append(f"[chapter]({page})")
    if on != LEDGER:
        links.append(f'<a href="{up}ledger.html#claim-{claim.id}">in the ledger</a>')
    if claim.is_measured:
        links.append(f'<a href="{up}{_source(claim)}">code</a>')
    return links


def _source(claim: Claim) -> str:
    """Address of the lines that measure a claim, from the page of a chapter."""
    measure = inspect.unwrap(measuring_function(claim.measure) if claim.measure else find)
    return f"{_CODE}/{measure.__module__.replace('.', '/')}.html#{measure.__name__}"


@dataclass(frozen=True)
class _Draws:
    """A claim's draws in a small picture: 95 % of them, their median, band and printed value."""

    description: str
    left: str  # the scale's ends, in words
    right: str
    spans: list[tuple[str, float, float | None]]  # name, start and width, per cent of the scale


def _draws(claim: Claim) -> _Draws | None:
    if not claim.band or "is" in claim.band:
        return None
    replicates = claim.measured().replicates
    if replicates is None:
        return None
    low, median, high = np.quantile(np.asarray(replicates, float), _MIDDLE)
    band = _range(claim)
    given = float(claim.printed) if isinstance(claim.printed, Printed) else None
    place, ends = _scale([low, high, *filter(np.isfinite, band), *([given] if given else [])])

    def span(name: str, start: float, end: float) -> tuple[str, float, float]:
        return name, place(start), max(place(end) - place(start), 0.5)

    spans = [span("band", *band), span("draws", low, high), ("median", place(median), None)]
    if given is not None:
        spans.append(("printed", place(given), None))
    description = (
        f"95 % of the draws from {significant(low)} to {significant(high)}, median "
        f"{significant(median)}; {worded(claim, 'reproduced')} {_words(band)}"
        + (f"; printed {claim.printed.text}" if given is not None else "")
    )
    left, right = (typeset(significant(end, 2)) for end in ends)
    return _Draws(typeset(description), left, right, spans)


def _range(claim: Claim) -> tuple[float, float]:
    if "factor" in claim.band:
        return claim.printed / claim.band["factor"], claim.printed * claim.band["factor"]
    return claim.band.get("from", -np.inf), claim.band.get("to", np.inf)


def _words(band: Sequence[float]) -> str:
    low, high = band
    if np.isinf(low):
        return f"up to {significant(high)}"
    return f"from {significant(low)}" + ("" if np.isinf(high) else f" to {significant(high)}")


def _scale(values: Sequence[float]):
    """A function from values to per cent of the width, and the values at both ends."""
    least, most = min(values), max(values)
    wide = least > 0 and most / least > _WIDE
    way, back = (np.log, np.exp) if wide else (np.asarray, np.asarray)
    first, last = float(way(least)), float(way(most))
    margin = 0.08 * (last - first) or 0.08 * abs(first) or 1.0
    first, last = first - margin, last + margin

    def place(value: float) -> float:
        if np.isinf(value):
            return 0.0 if value < 0 else 100.0
        return float(np.clip(100 * (way(value) - first) / (last - first), 0, 100))

    return place, (float(back(first)), float(back(last)))


def window(claim: Claim) -> int | None:
    """The window size that a claim is measured at; None if there is none or there are several."""
    if not claim.measure:
        return claim.arguments.get("width")
    given = inspect.signature(measuring_function(claim.measure)).bind(**claim.arguments)
    given.apply_defaults()
    return given.arguments.get("width")


def _bands(claim: Claim) -> str:
    """The value that is judged and what decides the verdict, in words."""
    if not claim.band:
        return "not judged"
    value = claim.measured().value
    number = _number_beside(float(value), claim.edges())
    shown = ("no", "yes")[bool(value)] if "is" in claim.band else number
    best = "holds" if claim.verdict == "by construction" else "reproduced"
    text = f"{shown}; {best} {_bounds(claim.band)}"
    return f"{text}, qualitative {_bounds(claim.loose)}" if claim.loose else text


def _number_beside(value: float, edges: Iterable[float], digits: int = 2, most: int = 6) -> str:
    """A number with the digits (`most` of them) that show on which side of others it lies."""
    edges = np.array(list(edges), dtype=float)
    for places in range(digits, most + 1):
        shown = float(f"{value:.{places - 1}e}")
        if (np.sign(shown - edges) == np.sign(value - edges)).all():
            return significant(value, places)
    return significant(value, most)


def _bounds(bounds: Mapping) -> str:
    if "is" in bounds:
        return "if yes" if bounds["is"] else "if no"
    if "factor" in bounds:
        return f"within a factor of {bounds['factor']:g}"
    edges = (
        f"{name} {significant(edge) if isinstance(edge, int) else f'{edge:g}'}"
        for name, edge in sorted(bounds.items())
    )
    return ("" if "from" in bounds else "up ") + " ".join(edges)


_BEHIND = {"whose-filters": "why-smooth-filters"}  # a lesson's evidence page of another name


def home(claim: Claim) -> str:
    """The page of a claim's chapter, as ``{doc}`` takes it: a lesson, or evidence that has none."""
    lesson = any(
        (CLAIMS_FILE.parent / f"{claim.chapter}.{end}").is_file() for end in ("ipynb", "md")
    )
    return claim.chapter if lesson else f"/book/evidence/{claim.chapter}"


def _page_of(claim: Claim) -> str:
    """The file of the page that deals with a claim, beside the others; empty if there is none."""
    behind = _BEHIND.get(claim.chapter, claim.chapter)
    names = (f"evidence/{behind}.ipynb", f"{claim.chapter}.ipynb", f"{claim.chapter}.md")
    return next((name for name in names if (CLAIMS_FILE.parent / name).is_file()), "")
