"""Rivals against the paper's network, day by day, on somebody else's table, and their intervals."""

from __future__ import annotations

from operator import itemgetter

import numpy as np

from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median


def row(rival: str, inputs: str = "positions", size=None) -> dict:
    """A row of the study ``rivals``: the largest size within the budget, or the smallest."""
    study = results.read("rivals")
    rows = [r for r in study["rows"] if (r["rival"], r["inputs"]) == (rival, inputs)]
    if size is not None:
        rows = [r for r in rows if r["size"] == size]
    within = [r for r in rows if r["count"] <= study["budget"]]
    by_count = itemgetter("count")
    return max(within, key=by_count) if within else min(rows, key=by_count)


def better(part: str = "trajectory 6") -> Measured:
    """Share of the tuned rivals within the budget that have less error than the tuned network."""
    study = results.read("tuned")
    network = np.array(study["rivals"][study["reference"]]["errors"][part])
    aside = study["reference"], study["own"]
    within = [name for name, r in study["rivals"].items() if r["within"] and name not in aside]
    mine = [np.array(study["rivals"][name]["errors"][part]) for name in within]
    cells = [(errors, network[: len(errors)]) for errors in mine]

    def share(*drawn):
        return np.mean([median(a / b) < 1 for a, b in drawn], axis=0)

    won = [name for name, (a, b) in zip(within, cells) if np.median(a / b) < 1]
    return judged(share, *cells, text=f"{len(won)} of {len(within)}: {', '.join(won) or 'none'}")
