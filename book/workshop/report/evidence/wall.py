"""Claims as tiles: a wall of them all at a glance, and each one to open.

A tile is a ``<details>`` with an address, ``#claim-ID``; ``book/_static/ledger.js`` adds filters on
a page that holds a `Wall`. Both can be read without a script.
"""

from __future__ import annotations

import html
import inspect
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ddlib.tables import significant, typeset
from workshop.report.evidence.claims import (
    _LEDGER,
    _OWN,
    _SECTIONS,
    Claim,
    _function,
    _of_chapter,
    _Printed,
    _printed,
    _sure,
    here,
)
from workshop.report.evidence.expressions import find
from workshop.report.evidence.ledger_tables import _HEADS, _bands, _page_of, window
from workshop.report.evidence.verdicts import VERDICTS

# A sign for each verdict, so that colour is not all that tells them apart
_MARKS = dict(zip(VERDICTS, "●◐✕?≡–"))

_CODE = "../_modules"  # The folder of the pages that show source, beside that of the chapters

# Titles of the paper's subsections
_PARTS = {
    "1.1": "Motivation",
    "1.2": "Backpropagation Networks",
    "2.1": "The CMU DD Arm II",
    "3.1": "Temporal Windows",
    "3.2": "Network Topology",
    "3.3": "Learning Parameters",
    "5.1": "Weight Displays",
    "5.2": "A More Global Perspective",
    "5.3": "Window Size vs. Generalization",
    "7.1": "Future Work",
}

_MIDDLE = (0.025, 0.5, 0.975)  # Quantiles of the draws that a tile's picture shows

_TABLE = 10  # a table's place among subsections
_WIDE = 20.0  # a scale is logarithmic from this ratio of its ends on


def _mark(verdict: str) -> str:
    """A verdict's sign, for the page."""
    name = verdict.replace(" ", "-")
    return f'<span class="sign v-{name}" aria-hidden="true">{_MARKS[verdict]}</span>'


@dataclass(frozen=True)
class Wall:
    """One small square for every claim, section by section: its verdict's sign and colour."""

    claims: Iterable[Claim]

    def __post_init__(self):
        object.__setattr__(self, "claims", sorted(self.claims, key=Claim.place))

    def _repr_markdown_(self) -> str:
        rows = []
        for section, title in _SECTIONS.items():
            inside = [claim for claim in self.claims if claim.place()[0] == section]
            if inside:
                squares = "".join(map(_square, inside))
                rows.append(f'<p class="wall-row"><span>{_text(title)}</span> {squares}</p>')
        legend = " ".join(f"<span>{_mark(name)} {name}</span>" for name in VERDICTS)
        return "\n".join(
            ['<div class="wall" role="group" aria-label="All claims, by section and verdict">',
             *rows, f'<p class="wall-legend">{legend}</p>', "</div>"]
        )  # fmt: skip


@dataclass(frozen=True)
class Tiles:
    """Claims to open: sentence and verdict outside; value, picture, bands and reasons inside."""

    claims: Iterable[Claim]
    on: str = _LEDGER

    def __post_init__(self):
        object.__setattr__(self, "claims", tuple(self.claims))

    def _repr_markdown_(self) -> str:
        return "\n\n".join(_tile(claim, self.on) for claim in self.claims)


def chapter_tiles(chapter: str) -> Tiles:
    """A chapter's "Paper and reproduction": its claims as `Tiles`."""
    return Tiles(_of_chapter(chapter), chapter)


def _square(claim: Claim) -> str:
    told = html.escape(f"{claim.judge()}: {typeset(claim.claim)}")
    return f'<a href="#claim-{claim.id}" title="{told}">{_mark(claim.judge())}</a>'


def _text(text: str) -> str:
    return html.escape(typeset(text), quote=False)


def _part(claim: Claim) -> str:
    """The subsection, table or figure in which a claim stands; empty for its section's own text."""
    section, below, number = claim.place()
    if number:
        return f"{'Table' if below == _TABLE else 'Figure'} {section}-{number}"
    name = f"{section}.{below}"
    return f"{name}. {_PARTS[name]}" if below else ""


def _tile(claim: Claim, on: str) -> str:
    verdict = claim.judge()
    data = {
        "verdict": verdict,
        "section": claim.place()[0],
        "part": _part(claim),
        "chapter": claim.chapter,
    }
    given = " ".join(f'data-{name}="{html.escape(value)}"' for name, value in data.items())
    lines = [
        f'<details class="claim" id="claim-{claim.id}" {given}>',
        f"<summary>{_mark(verdict)} <b>{verdict}</b> {_text(claim.claim)}</summary>",
        "",
        *_body(claim, on),
        "",
        "</details>",
    ]
    return "\n".join(lines)


def _body(claim: Claim, on: str) -> list[str]:
    """What is inside a tile, as Markdown."""
    source = "This book's own claim" if claim.printed == _OWN else f"Printed: {_printed(claim)}"
    width, found = window(claim), here(claim)
    known = width is None or str(width) in f"{claim.claim} {found}"
    lines = [
        f"{typeset(source)} ({claim.where}). "
        f"**Here: {typeset(found)}{'' if known else f' (window {width})'}**",
        "",
    ]
    picture = _draws(claim)
    if picture:
        lines += [picture, ""]
    judged = f"Judged: {typeset(_sure(claim))} ({typeset(_bands(claim))}). " if claim.band else ""
    head = _HEADS.get(claim.verdict, "What would have refuted it")
    lines += [f"{judged}{typeset(claim.why)}", "", f"*{head}:* {typeset(claim.refuted)}", ""]
    lines.append(_links(claim, on))
    return lines


def _links(claim: Claim, on: str) -> str:
    page, links = _page_of(claim), []
    if page and claim.chapter != on:
        links.append(f"[chapter]({page})")
    if on != _LEDGER and claim.printed != _OWN and not claim.arm:
        links.append(f'<a href="ledger.html#claim-{claim.id}">in the ledger</a>')
    if claim.is_measured:
        links.append(f'<a href="{_source(claim)}">code</a>')
    return " · ".join(links)


def _source(claim: Claim) -> str:
    """Address of the lines that measure a claim, from the page of a chapter."""
    measure = inspect.unwrap(_function(claim.measure) if claim.measure else find)
    return f"{_CODE}/{measure.__module__.replace('.', '/')}.html#{measure.__name__}"


def _draws(claim: Claim) -> str:
    """A claim's draws in a small picture: 95 % of them, their median, band and printed value."""
    if not claim.band or "is" in claim.band:
        return ""
    replicates = claim.measured().replicates
    if replicates is None:
        return ""
    low, median, high = np.quantile(np.asarray(replicates, float), _MIDDLE)
    band = _range(claim)
    given = float(claim.printed) if isinstance(claim.printed, _Printed) else None
    place, ends = _scale([low, high, *filter(np.isfinite, band), *([given] if given else [])])
    parts = [
        ("band", *map(place, band)),
        ("draws", place(low), place(high)),
        ("median", place(median)),
    ]
    if given is not None:
        parts.append(("printed", place(given)))
    told = (
        f"95 % of the draws from {significant(low)} to {significant(high)}, median "
        f"{significant(median)}; reproduced {_words(band)}"
        + (f"; printed {claim.printed.text}" if given is not None else "")
    )
    spans = "".join(_span(*part) for part in parts)
    left, right = (significant(end, 2) for end in ends)
    return (
        f'<div class="claim-draws" role="img" aria-label="{html.escape(typeset(told))}">'
        f"<small>{typeset(left)}</small><span>{spans}</span><small>{typeset(right)}</small></div>"
    )


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


def _span(name: str, start: float, end: float | None = None) -> str:
    width = "" if end is None else f";width:{max(end - start, 0.5):.1f}%"
    return f'<i class="{name}" style="left:{start:.1f}%{width}"></i>'
