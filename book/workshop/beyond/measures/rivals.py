"""Rivals against the paper's network, day by day: the study ``rivals``."""

from __future__ import annotations

import numpy as np

from ddlib.tables import significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median


def row(rival: str, inputs: str = "positions", size=None) -> dict:
    """A row of the study.

    Parameters
    ----------
    rival : str
        As the study names it.
    inputs : {"positions", "exact states"}
    size : optional
        Default: the largest within the stored numbers of the paper's network, or the smallest.

    Raises
    ------
    ValueError
        If there is no such row.
    """
    study = results.read("rivals")
    rows = [r for r in study["rows"] if (r["rival"], r["inputs"]) == (rival, inputs)]
    if size is not None:
        rows = [r for r in rows if r["size"] == size]
    if not rows:
        raise ValueError(f"rival must be one of the study, got {rival!r}, {inputs!r}, {size!r}")
    within = [r for r in rows if r["count"] <= study["budget"]]
    return max(within, key=_count) if within else min(rows, key=_count)


def _count(one: dict) -> int:
    return one["count"]


def _pair(first: dict, second: dict, what) -> tuple[np.ndarray, np.ndarray]:
    """Values of two rows on the days that both have."""
    both = [np.array(what(one), dtype=float) for one in (first, second)]
    days = min(map(len, both))
    return both[0][:days], both[1][:days]


def ratio(
    rival: str,
    part: str = "trajectory 6",
    inputs: str = "positions",
    size=None,
    against: str | None = None,
    against_size=None,
) -> Measured:
    """Error of a rival over that of another one on the same day: the median over days.

    Parameters
    ----------
    rival, inputs, size
        As in `row`.
    part : str
        Of the tests: "training", "trajectory 6", "inside", "outside".
    against, against_size
        The other one and its size; default: the paper's network.
    """
    other = results.read("rivals")["reference"] if against is None else against
    rows = row(rival, inputs, size), row(other, inputs if against else "positions", against_size)
    mine, others = _pair(*rows, lambda one: one["errors"][part])
    text = f"{spread(mine)} with {rows[0]['count']:,} numbers, "
    text += f"{spread(others)} with {rows[1]['count']:,}"
    return judged(median, mine / others, text=lambda value: f"{significant(value, 2)}: {text}")


def time(rival: str) -> Measured:
    """Training time of a rival over that of the paper's network: the median over days.

    Parameters
    ----------
    rival : str
        As in `row`.
    """
    rows = row(rival), row(results.read("rivals")["reference"])
    mine, others = _pair(*rows, lambda one: one["seconds"])
    return judged(
        median,
        np.maximum(mine, 1e-4) / others,
        text=lambda value: f"about {significant(value, 1)} of its time",
    )


def above_floor(rival: str, inputs: str = "exact states", part: str = "trajectory 6") -> Measured:
    """Error of a rival over the error that the noise of the sensors leaves.

    Parameters
    ----------
    rival, inputs
        As in `row`.
    part : str
        As in `ratio`.
    """
    errors = np.array(row(rival, inputs)["errors"][part])
    floor = results.read("rivals")["floor"][inputs][part]
    return judged(
        median, errors / floor, text=f"{spread(errors)} for noise of {significant(floor, 2)}"
    )


def better(part: str = "trajectory 6", margin: float = 1.0) -> Measured:
    """Share of the rivals with no more stored numbers than the network that have less error.

    Parameters
    ----------
    part : str
        As in `ratio`.
    margin : float
        How much of the network's error a rival may have.
    """
    study = results.read("rivals")
    names = [name for name in study["lines"] if name != study["reference"]]
    within = [r for r in map(row, names) if r["count"] <= study["budget"]]
    network = row(study["reference"])
    cells = [_pair(one, network, lambda one: one["errors"][part]) for one in within]

    def share(*drawn):
        return np.mean([median(mine / others) < margin for mine, others in drawn], axis=0)

    won = [one["rival"] for one, (a, b) in zip(within, cells) if np.median(a / b) < margin]
    return judged(share, *cells, text=f"{len(won)} of {len(within)}: {', '.join(won)}")
