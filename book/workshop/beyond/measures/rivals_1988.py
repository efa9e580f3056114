"""Section 1.1: what tables, CMAC, polynomials and Fourier series reach, and where they fail."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.learning import Weights
from ddlib.tables import significant, spread
from workshop.beyond.rivals.tables import table_size
from workshop.beyond.studies.rivals_1988 import KINDS, practised_distance
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

PRINTED = paper.TABLE_4_1[21].test
"""Error of the paper's network on trajectory 6, the least of Table 4-1."""

STORED = Weights.random(1, 21)[0].count(biases=True)
"""Weights and biases of that network."""


def row(name: str, **wanted) -> dict:
    """The row of a result with some values.

    Parameters
    ----------
    name : str
        "rivals-tables", "rivals-cmac" or "rivals-bases".
    **wanted
        Values of its entries.

    Raises
    ------
    ValueError
        If there is not one such row.
    """
    found = [
        each
        for each in results.read(name)["rows"]
        if all(each[key] == value for key, value in wanted.items())
    ]
    if len(found) != 1:
        raise ValueError(f"wanted must name one row of {name}, got {wanted}: {len(found)} rows")
    return found[0]


def around(over: str, kind: str = KINDS[1]) -> np.ndarray:
    """Errors of what learnt one trajectory, by day and by distance from it.

    Parameters
    ----------
    over : str
        The rival, as in the result.
    kind : str
        How it sees states.

    Returns
    -------
    ndarray, shape (days, distances)
        Medians over the trajectories that differ from it by 0, 5, 10, 15 and 20 degrees in the
        extent that differs more, in units of its torque's deviation.
    """
    errors = np.array(results.read("rivals-tables")["around"][kind][over]["errors"])
    far = practised_distance()
    return np.stack([np.median(errors[:, far == d], axis=1) for d in (0, 5, 10, 15, 20)], 1)


def degrades(over: str = "states", kind: str = KINDS[1]) -> Measured:
    """Error on trajectories 10 degrees from the practised one over the error on itself.

    Parameters
    ----------
    over, kind : str
        As in `around`.
    """
    errors = around(over, kind)
    ratios = errors[:, 2] / errors[:, 0]
    there, away = (significant(np.median(errors[:, k]), 2) for k in (0, 2))
    return judged(
        median, ratios, text=lambda value: f"{significant(value, 2)} times: {away} for {there}"
    )


def on_the_trajectory(over: str = "states", kind: str = KINDS[1]) -> Measured:
    """Error on the practised trajectory itself over the noise of its torque.

    Parameters
    ----------
    over, kind : str
        As in `around`.
    """
    found = results.read("rivals-tables")["around"][kind]
    there, floor = np.array(found[over]["there"])[:, -1], np.array(found["floor"])
    return judged(
        median,
        there / floor,
        text=f"{significant(np.median(there), 2)} for noise of {significant(np.median(floor), 2)}",
    )


def full_cells(way: str) -> int:
    """Cells of each axis at which a table that is right everywhere is as good as the network.

    Parameters
    ----------
    way : {"constant", "multilinear"}
        One torque in a cell, or interpolation between its corners.
    """
    full = results.read("rivals-tables")["full"]
    good = np.array(full[way]) <= PRINTED
    if not good.any():
        raise ValueError(f"way must reach {PRINTED} with some number of cells, got {way!r}")
    return full["cells"][int(np.argmax(good))]


def stored(way: str) -> Measured:
    """Numbers in that table over the numbers in the paper's network.

    Parameters
    ----------
    way : {"constant", "multilinear"}
        As in `full_cells`.
    """
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


def cmac(motions: str) -> Measured:
    """Error of CMAC at the width that does best on what it has not seen.

    Parameters
    ----------
    motions : {"practised", "new"}
        The training trajectories on another day, or trajectory 6.
    """
    found = np.array(results.read("rivals-cmac")["chosen"][motions])
    return judged(median, found, text=spread(found))


def hashed_rows() -> list[dict]:
    """Rows of CMAC with hashed weights, fewest slots first."""
    rows = [each for each in results.read("rivals-cmac")["rows"] if each["slots"]]
    return sorted(rows, key=lambda each: each["slots"])


def diverges_at() -> Measured:
    """Most slots at which training diverges on any day, over the cubes that it visits."""
    bad = [each for each in hashed_rows() if any(each["diverged"])]
    most = max((each["slots"] for each in bad), default=0)
    visited = np.median(hashed_rows()[0]["visited"])
    return Measured(most / visited, f"up to {most} slots for {visited:.0f} cubes visited")


def hashing_saves(factor: float = 1.5) -> Measured:
    """Slots that suffice over cubes visited.

    Parameters
    ----------
    factor : float
        What suffices: an error on the training trajectories of another day at most so many times
        that of CMAC without collisions.
    """
    rows = hashed_rows()
    free = row("rivals-cmac", kind=KINDS[1], layers=rows[0]["layers"], width=rows[0]["width"],
               slots=None)  # fmt: skip
    level = factor * np.median(free["again"])
    enough = [r for r in rows if not any(r["diverged"]) and np.median(r["again"]) <= level]
    slots, visited = enough[0]["slots"], np.median(free["visited"])
    return Measured(slots / visited, f"{slots:,} slots for {visited:.0f} cubes visited")


def basis(name: str, order: int, ridge: float = 0.0, kind: str = KINDS[1]) -> dict:
    """Errors of a polynomial or a Fourier series by day: lists under the names of the sets.

    Parameters
    ----------
    name : {"chebyshev", "monomials", "fourier"}
    order : int
        Degree or order.
    ridge : float
        Penalty.
    kind : str
        How states are seen.
    """
    return row("rivals-bases", kind=kind, basis=name, order=order, ridge=ridge)


def orders(name: str, kind: str = KINDS[1]) -> list[int]:
    """Degrees or orders that were tried.

    Parameters
    ----------
    name, kind : str
        As in `basis`.
    """
    rows = results.read("rivals-bases")["rows"]
    return sorted({r["order"] for r in rows if r["basis"] == name and r["kind"] == kind})


def low_order(order: int = 2) -> Measured:
    """Training error of a low degree on exact states over the noise of the torque.

    Parameters
    ----------
    order : int
        The degree.
    """
    errors = np.array(basis("chebyshev", order, kind=KINDS[0])["training"])
    floor = np.array(results.read("rivals-bases")["floor"])
    text = f"{significant(np.median(errors), 2)} for noise of {significant(np.median(floor), 2)}"
    return judged(median, errors / floor, text=text)


def high_order(where: str = "outside") -> Measured:
    """Error of the highest degree over that of the lowest, neither with a penalty.

    Parameters
    ----------
    where : str
        Set of cases.
    """
    tried = orders("chebyshev")
    low, high = (np.array(basis("chebyshev", k)[where]) for k in (tried[0], tried[-1]))
    text = f"{significant(np.median(high), 2)} for {significant(np.median(low), 2)}"
    return judged(median, high / low, text=f"{text}, degree {tried[-1]} for {tried[0]}")


def chosen(name: str, where: str) -> np.ndarray:
    """Errors of the order and penalty that leaving out trajectories chose, by day.

    Parameters
    ----------
    name : {"chebyshev", "fourier"}
    where : str
        Set of cases.
    """
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
    found = chosen("chebyshev", "outside")
    text = f"{significant(np.median(found), 3)} for {significant(np.median(ends), 3)}"
    return judged(median, found / ends, text=f"{text}; chosen degree {degrees}")


def penalty() -> Measured:
    """Error outside the hull of the highest degree without penalty over that with the best one."""
    degree = orders("chebyshev")[-1]
    rows = [
        r
        for r in results.read("rivals-bases")["rows"]
        if (r["kind"], r["basis"], r["order"]) == (KINDS[1], "chebyshev", degree)
    ]
    free = next(np.array(r["outside"]) for r in rows if r["ridge"] == 0)
    best = min((np.array(r["outside"]) for r in rows if r["ridge"]), key=np.median)
    text = f"{significant(np.median(free), 2)} without, {significant(np.median(best), 2)} with"
    return judged(median, free / best, text=text)


def good(name: str = "chebyshev") -> Measured:
    """Error on trajectory 6 of the order and penalty chosen.

    Parameters
    ----------
    name : {"chebyshev", "fourier"}
        Family of functions.
    """
    found = chosen(name, "trajectory 6")
    return judged(median, found, text=spread(found))


def coefficients() -> Measured:
    """Numbers in the smallest polynomial as good as the network on trajectory 6, over its own."""
    rows = [
        r
        for r in results.read("rivals-bases")["rows"]
        if r["kind"] == KINDS[1] and r["ridge"] == 0 and np.median(r["trajectory 6"]) <= PRINTED
    ]
    least = min(int(np.median(r["count"])) for r in rows)
    return Measured(least / STORED, f"{least} for {STORED}")
