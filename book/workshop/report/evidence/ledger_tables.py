"""The ledger's tables of claims: by section of the paper, and counted."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Mapping

from ddlib._check import one_of
from ddlib.setups import POSITION_FEEDBACK, SETUPS, STATE_FEEDBACK
from ddlib.tables import Table, number_beside, significant, typeset
from workshop.report.evidence.claims import (
    _FILE,
    _LEDGER,
    _SECTIONS,
    Claim,
    _function,
    _printed,
    _sure,
    here,
    judged_again,
    load,
)
from workshop.report.evidence.verdicts import VERDICTS

_SHOWN = {"table": "Table 4-1", "figures": "Figure 5-"}

# What a claim's `refuted` tells, if not what would have refuted it
_HEADS = {
    "not reproduced": "What would have supported it",
    "by construction": "Why nothing could have refuted it",
    "not testable": "What a test would need",
}


# Ids of the claims on which the paper's theses and this book's answers hang
_FINDINGS = (
    "headline",
    "headline-damping",
    "saturated-21-damping",
    "generalised-well",
    "conventional-filters",
    "conventional-filters-inertia-11",
    "conventional-filters-stiffness-21",
    "changes-predicted",
    "hidden-units-contribute-test",
    "tradeoff",
    "network-against-identification",
    "run-time-torques",
    "kawato-different",
    "stirring-hand-worse",
    "joints-three-and-four",
)


def findings() -> Table:
    """The main findings, `_FINDINGS`, as `chosen` shows them."""
    return chosen(_FINDINGS)


def chosen(ids: Iterable[str]) -> Table:
    """Some claims: claim and its chapter, printed value, ours, verdict, reason.

    The verdict comes with the share of the draws in which it comes out.
    """
    known = {claim.id: claim for claim in load()}
    header = ("claim", "printed", "here", "verdict", "why")
    rows = [
        (f"{c.claim} ({{doc}}`{c.chapter}`)", _printed(c), _here(c), _sure(c), c.why)
        for c in (known[one_of("ids", name, tuple(known))] for name in ids)
    ]
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def again_table(arm: str) -> Table:
    """Sentences that are judged again on another arm: both verdicts side by side."""
    pairs = judged_again(arm)
    if not pairs:
        raise ValueError(f"arm must be named by claims, got {arm!r}")
    rows = [
        (f"{c.claim} ({_linked(c)})", _printed(c), _sure(first), _judged(c), here(c))
        for first, c in sorted(pairs, key=lambda pair: pair[1].place())
    ]
    header = ("claim", "printed", "verdict on the simulated arm", f"verdict on {arm}", "there")
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def _here(claim: Claim) -> str:
    """What we find, and at which window size if the words beside it do not tell."""
    text, width = here(claim), window(claim)
    named = rf"(window|at) {width}\b|\b{width} samples"
    known = width is None or re.search(named, f"{claim.claim} {text}")
    return text if known else f"{text} (window {width})"


def window(claim: Claim) -> int | None:
    """The window size that a claim is measured at; None if there is none or there are several."""
    if not claim.measure:
        return claim.arguments.get("width")
    given = inspect.signature(_function(claim.measure)).bind(**claim.arguments)
    given.apply_defaults()
    return given.arguments.get("width")


def left_out(claims: Iterable[Claim]) -> Table:
    """Claims that are not testable: why, what a test would need, where the verdict would turn."""
    rows = [
        (c.where, c.claim, c.why, c.refuted, here(c))
        for c in sorted(claims, key=Claim.place)
        if c.verdict == "not testable"
    ]
    header = ("where", "claim", "why", "a test would need", "here, and where it would turn")
    return Table(header, [tuple(map(typeset, row)) for row in rows])


def _judged(claim: Claim) -> str:
    return f"{_sure(claim)} ({_bands(claim)})" if claim.band else claim.judge()


def _bands(claim: Claim) -> str:
    """The value that is judged and what decides the verdict, in words."""
    if not claim.band:
        return "not judged"
    value = claim.measured().value
    told = number_beside(float(value), claim.edges())
    shown = ("no", "yes")[bool(value)] if "is" in claim.band else told
    best = "holds" if claim.verdict == "by construction" else "reproduced"
    text = f"{shown}; {best} {_bounds(claim.band)}"
    return f"{text}, qualitative {_bounds(claim.loose)}" if claim.loose else text


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


def _linked(claim: Claim) -> str:
    """The claim's place in the paper, as a link to its chapter."""
    page = _page_of(claim)
    return claim.where if claim.chapter == _LEDGER or not page else f"[{claim.where}]({page})"


def _page_of(claim: Claim) -> str:
    """The file of the page that deals with a claim, beside the others; empty if there is none."""
    names = (f"{claim.chapter}.ipynb", f"{claim.chapter}.md")
    return next((name for name in names if _FILE.with_name(name).is_file()), "")


def counts(claims: Iterable[Claim]) -> dict[str, dict[str, int]]:
    """How many claims of each section of the paper have which verdict."""
    found: dict[str, dict[str, int]] = {}
    for claim in sorted(claims, key=Claim.place):
        row = found.setdefault(_SECTIONS[claim.place()[0]], dict.fromkeys(VERDICTS, 0))
        row[claim.judge()] += 1
    return found


def summary(claims: Iterable[Claim]) -> Table:
    """How many claims have which verdict."""
    verdicts = [claim.judge() for claim in claims]
    rows = [(verdict, str(verdicts.count(verdict))) for verdict in VERDICTS]
    return Table(("verdict", "claims"), [*rows, ("all", str(len(verdicts)))])


def readings(claims: Iterable[Claim]) -> dict[str, tuple[int, dict[str, int]]]:
    """Claims judged under both feedbacks, and how many each reading reproduces.

    They have the same measure and arguments but for the argument ``setup``; without it the
    reading is state feedback. Joint damping counts where it is judged by all of them, too.
    """
    verdicts = {"table": {}, "figures": {}}
    for claim in claims:
        kinds = [k for k, place in _SHOWN.items() if claim.where.startswith(place)]
        for kind in kinds:
            key, setup = claim.but_for_reading()
            verdicts[kind].setdefault(key, {})[setup] = claim.verdict
    found = {}
    for kind, cells in verdicts.items():
        two = {POSITION_FEEDBACK.name, STATE_FEEDBACK.name}
        both = [cell for cell in cells.values() if two <= set(cell)]
        names = [name for name in SETUPS if all(name in cell for cell in both)]
        found[kind] = (
            len(both),
            {name: sum(cell[name] == "reproduced" for cell in both) for name in names},
        )
    return found
