"""Section 1.1: what tables, CMAC, polynomials and Fourier series reach, and where they fail."""

from __future__ import annotations

import numpy as np

from beyond.rivals.tables import table_size
from beyond.studies.rivals_1988 import _KINDS, _practised_distance
from ddlib import paper
from ddlib.learning import Weights
from ddlib.tables import significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

PRINTED = paper.TABLE_4_1[21].test  # of trajectory 6, the least of Table 4-1
STORED = Weights.random(1, 21)[0].count(biases=True)  # numbers in that network


def _rows(name: str, **wanted) -> list[dict]:
    rows = results.read(name)["rows"]
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def row(name: str, **wanted) -> dict:
    """The one row of a result whose entries have these values."""
    rows = _rows(name, **wanted)
    if len(rows) != 1:
        raise ValueError(f"wanted must name one row of {name}, got {wanted}: {len(rows)} rows")
    return rows[0]


# --- tables -----------------------------------------------------------------------------------


def around(over: str) -> np.ndarray:
    """Errors of what learnt one trajectory, by day and by distance from it."""
    errors = np.array(results.read("rivals-tables")["around"][_KINDS[1]][over]["errors"])
    far = _practised_distance()
    return np.stack([np.median(errors[:, far == d], axis=1) for d in (0, 5, 10, 15, 20)], 1)


def degrades(over: str = "states") -> Measured:
    """Error on trajectories 10 degrees from the practised one over the error on itself."""
    errors = around(over)
    there, away = (significant(np.median(errors[:, k]), 2) for k in (0, 2))
    return judged(
        median,
        errors[:, 2] / errors[:, 0],
        text=lambda value: f"{significant(value, 2)} times: {away} for {there}",
    )


def full_cells(way: str) -> int:
    """Cells of each axis at which a table of the whole square is as good as the network."""
    full = results.read("rivals-tables")["full"]
    good = np.array(full[way]) <= PRINTED
    if not good.any():
        raise ValueError(f"way must reach {PRINTED} with some number of cells, got {way!r}")
    return full["cells"][int(np.argmax(good))]


def stored(way: str) -> Measured:
    """Numbers in that table over the numbers in the paper's network."""
    cells = full_cells(way)
    size = table_size(cells + (way == "multilinear"))
    memory = significant(size.bytes / 1e6, 2)
    return Measured(
        size.numbers / STORED,
        f"{cells} cells an axis: {size.numbers:,} numbers, {memory} MB of four bytes each, "
        f"for {STORED:,}",
    )


def reached() -> Measured:
    """Share of the square's states whose cell the training runs fill, in the constant table."""
    full, cells = results.read("rivals-tables")["full"], full_cells("constant")
    share = full["reached"][full["cells"].index(cells)]
    return Measured(share, f"{100 * share:.0f} % at {cells} cells an axis")


# --- CMAC -------------------------------------------------------------------------------------


def hashed_rows() -> list[dict]:
    """Rows of CMAC with hashed weights, fewest slots first."""
    rows = [row for row in _rows("rivals-cmac") if row["slots"]]
    return sorted(rows, key=lambda row: row["slots"])


def diverges_at() -> Measured:
    """Most slots at which training diverges on any day, over the cubes that it visits."""
    rows = hashed_rows()
    most = max((row["slots"] for row in rows if any(row["diverged"])), default=0)
    visited = np.median(rows[0]["visited"])
    return Measured(most / visited, f"up to {most} slots for {visited:.0f} cubes visited")


def hashing_saves() -> Measured:
    """Slots over cubes visited that suffice: half as much error again, on practised motions."""
    rows = hashed_rows()
    shape = {name: rows[0][name] for name in ("layers", "width")}
    free = row("rivals-cmac", kind=_KINDS[1], slots=None, **shape)
    level = 1.5 * np.median(free["again"])
    enough = [r for r in rows if not any(r["diverged"]) and np.median(r["again"]) <= level]
    slots, visited = enough[0]["slots"], np.median(free["visited"])
    return Measured(slots / visited, f"{slots:,} slots for {visited:.0f} cubes visited")


# --- polynomials and Fourier series -----------------------------------------------------------


def basis(name: str, order: int, ridge: float = 0.0, kind: str = _KINDS[1]) -> dict:
    """Errors of a polynomial or a Fourier series by day: lists under the names of the sets."""
    return row("rivals-bases", kind=kind, basis=name, order=order, ridge=ridge)


def orders(name: str) -> list[int]:
    """Degrees or orders that were tried."""
    return sorted({row["order"] for row in _rows("rivals-bases", basis=name, kind=_KINDS[1])})


def _chosen(name: str, where: str) -> np.ndarray:
    """Errors, by day, of the order and penalty that leaving out trajectories chose."""
    picked = results.read("rivals-bases")["chosen"][name]
    return np.array(
        [basis(name, each["order"], each["ridge"])[where][k] for k, each in enumerate(picked)]
    )


def medium() -> Measured:
    """Error outside the hull of the degree and penalty chosen, over the better of both ends."""
    tried = orders("chebyshev")
    ends = np.min([basis("chebyshev", k)["outside"] for k in (tried[0], tried[-1])], axis=0)
    picked = results.read("rivals-bases")["chosen"]["chebyshev"]
    degrees = ", ".join(str(k) for k in sorted({each["order"] for each in picked}))
    errors = _chosen("chebyshev", "outside")
    text = f"{significant(np.median(errors), 3)} for {significant(np.median(ends), 3)}"
    return judged(median, errors / ends, text=f"{text}; chosen degree {degrees}")


def penalty() -> Measured:
    """Error outside the hull of the highest degree without penalty over that with the best one."""
    degree = orders("chebyshev")[-1]
    rows = _rows("rivals-bases", kind=_KINDS[1], basis="chebyshev", order=degree)
    free = next(np.array(row["outside"]) for row in rows if row["ridge"] == 0)
    best = min((np.array(row["outside"]) for row in rows if row["ridge"]), key=np.median)
    text = f"{significant(np.median(free), 2)} without, {significant(np.median(best), 2)} with"
    return judged(median, free / best, text=text)


def good(name: str = "chebyshev") -> Measured:
    """Error on trajectory 6 of the order and penalty chosen."""
    errors = _chosen(name, "trajectory 6")
    return judged(median, errors, text=spread(errors))


def coefficients() -> Measured:
    """Numbers in the smallest polynomial as good as the network on trajectory 6, over its own."""
    rows = _rows("rivals-bases", kind=_KINDS[1], ridge=0)
    enough = [row["count"] for row in rows if np.median(row["trajectory 6"]) <= PRINTED]
    least = min(int(np.median(count)) for count in enough)
    return Measured(least / STORED, f"{least} for {STORED}")
