"""Section 1.1: what tables, CMAC, polynomials and Fourier series reach, and where they fail.

Most functions measure what a claim says: `book/claims.yml` names them. They read results of
`beyond.studies.rivals_1988`, whose rows have a value for each day on which arms were recorded and
rivals trained. Errors are in units of the torque's deviation. Rivals see states estimated from
positions (`_KIND`).
"""

from __future__ import annotations

import numpy as np

from beyond.rivals.tables import table_size
from beyond.studies.rivals_1988 import KINDS, practised_distance
from ddlib import paper
from ddlib.learning import Weights
from ddlib.tables import significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

PRINTED = paper.TABLE_4_1[21].test  # error on trajectory 6 at window 21, the least of Table 4-1
STORED = Weights.random(1, 21)[0].count(biases=True)  # numbers in the network that has it
_KIND = KINDS[1]  # "positions only"


def _rows(name: str, **wanted) -> list[dict]:
    """The rows of a result whose entries have these values."""
    rows = results.read(name)["rows"]
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def row(name: str, **wanted) -> dict:
    """The one row of a result whose entries have these values."""
    (one_row,) = _rows(name, **wanted)
    return one_row


# --- tables -----------------------------------------------------------------------------------


def around(over: str) -> np.ndarray:
    """Errors of what learnt one trajectory, all over the square, shape (days, distances).

    `over` names what learnt it, as "states": a table over them. Distances are 0, 5, ..., 20
    degrees, the larger of both extents'; of all trajectories that far away it is the median.
    """
    errors = np.array(results.read("rivals-tables")["around"][_KIND][over]["errors"])
    away = practised_distance()
    distances = (0, 5, 10, 15, 20)
    return np.stack([np.median(errors[:, away == d], axis=1) for d in distances], 1)


def degrades(over: str = "states") -> Measured:
    """Error on trajectories 10 degrees from the practised one over the error on itself."""
    errors = around(over)
    there, away = (significant(np.median(errors[:, k]), 2) for k in (0, 2))  # at 0 and 10 degrees
    return judged(
        median,
        errors[:, 2] / errors[:, 0],
        text=lambda value: f"{significant(value, 2)} times: {away} for {there}",
    )


def full_cells(way: str) -> int:
    """Fewest cells of an axis at which a table of the whole square is as good as the network.

    Such a table has the right torque in every cell; `way` is "constant" in each, or "multilinear".
    """
    full = results.read("rivals-tables")["full"]
    return full["cells"][int(np.argmax(np.array(full[way]) <= PRINTED))]


def stored(way: str) -> Measured:
    """Numbers in the table of `full_cells` over the numbers in the paper's network."""
    cells = full_cells(way)
    size = table_size(cells + (way == "multilinear"))  # which stores corners, one more on each axis
    megabytes = significant(size.bytes / 1e6, 2)
    return Measured(
        size.numbers / STORED,
        f"{cells} cells an axis: {size.numbers:,} numbers, {megabytes} MB of four bytes each, "
        f"for {STORED:,}",
    )


def reached() -> Measured:
    """Share of the square's states whose cell the training runs visit, in the constant table."""
    full, cells = results.read("rivals-tables")["full"], full_cells("constant")
    share = full["reached"][full["cells"].index(cells)]
    return Measured(share, f"{100 * share:.0f} % at {cells} cells an axis")


# --- CMAC -------------------------------------------------------------------------------------


def hashed_rows() -> list[dict]:
    """Rows of CMAC with hashed weights, fewest slots first; a slot is a weight that cubes share."""
    rows = [row for row in _rows("rivals-cmac") if row["slots"]]
    return sorted(rows, key=lambda row: row["slots"])


def diverges_at() -> Measured:
    """Most slots at which training diverges on any day, over the cubes that training visits."""
    rows = hashed_rows()
    most = max((row["slots"] for row in rows if any(row["diverged"])), default=0)
    visited = np.median(rows[0]["visited"])
    return Measured(most / visited, f"up to {most} slots for {visited:.0f} cubes visited")


def hashing_saves() -> Measured:
    """Fewest slots that suffice, over the cubes that training visits.

    They suffice if training does not diverge, and the error on the training motions, recorded
    again, is at most 1.5 times what it is without hashing.
    """
    rows = hashed_rows()
    same_cubes = {name: rows[0][name] for name in ("layers", "width")}
    unhashed = row("rivals-cmac", kind=_KIND, slots=None, **same_cubes)
    level = 1.5 * np.median(unhashed["again"])
    enough = [r for r in rows if not any(r["diverged"]) and np.median(r["again"]) <= level]
    slots, visited = enough[0]["slots"], np.median(unhashed["visited"])
    return Measured(slots / visited, f"{slots:,} slots for {visited:.0f} cubes visited")


# --- polynomials and Fourier series -----------------------------------------------------------


def basis(name: str, order: int, ridge: float = 0.0, kind: str = _KIND) -> dict:
    """The row of a polynomial or a Fourier series: errors by day under the names of the test sets.

    `name` is "chebyshev", "monomials" or "fourier"; `ridge` is the penalty on squared coefficients.
    """
    return row("rivals-bases", kind=kind, basis=name, order=order, ridge=ridge)


def orders(name: str) -> list[int]:
    """Degrees of a polynomial, or orders of a Fourier series, that were tried."""
    return sorted({row["order"] for row in _rows("rivals-bases", basis=name, kind=_KIND)})


def _chosen(name: str, where: str) -> np.ndarray:
    """Errors by day on the test set `where`; leaving out trajectories chose order and penalty."""
    settings = results.read("rivals-bases")["chosen"][name]
    return np.array(
        [
            basis(name, chosen["order"], chosen["ridge"])[where][day]
            for day, chosen in enumerate(settings)
        ]
    )


def medium() -> Measured:
    """Error of the chosen degree and penalty over that of the lowest or highest degree.

    Of the two, which have no penalty, the better one counts on each day. Errors are those on
    trajectories outside the hull of the training trajectories.
    """
    tried = orders("chebyshev")
    ends = np.min([basis("chebyshev", k)["outside"] for k in (tried[0], tried[-1])], axis=0)
    settings = results.read("rivals-bases")["chosen"]["chebyshev"]
    degrees = ", ".join(str(k) for k in sorted({chosen["order"] for chosen in settings}))
    errors = _chosen("chebyshev", "outside")
    text = f"{significant(np.median(errors), 3)} for {significant(np.median(ends), 3)}"
    return judged(median, errors / ends, text=f"{text}; chosen degree {degrees}")


def penalty() -> Measured:
    """Error of the highest degree without penalty over its error with the best penalty.

    Errors are those on trajectories outside the hull of the training trajectories.
    """
    degree = orders("chebyshev")[-1]
    rows = _rows("rivals-bases", kind=_KIND, basis="chebyshev", order=degree)
    without = next(np.array(row["outside"]) for row in rows if row["ridge"] == 0)
    best = min((np.array(row["outside"]) for row in rows if row["ridge"]), key=np.median)
    text = f"{significant(np.median(without), 2)} without, {significant(np.median(best), 2)} with"
    return judged(median, without / best, text=text)


def good(name: str = "chebyshev") -> Measured:
    """Error on trajectory 6 of the order and penalty chosen."""
    errors = _chosen(name, "trajectory 6")
    return judged(median, errors, text=spread(errors))


def coefficients() -> Measured:
    """Numbers in the smallest sum as good as the network on trajectory 6, over the network's.

    Sums are polynomials and Fourier series without penalty.
    """
    rows = _rows("rivals-bases", kind=_KIND, ridge=0)
    enough = [row["count"] for row in rows if np.median(row["trajectory 6"]) <= PRINTED]
    fewest = min(int(np.median(numbers)) for numbers in enough)
    return Measured(fewest / STORED, f"{fewest} for {STORED}")
