"""Rivals on somebody else's table, and what a Gaussian process says of its own error."""

from __future__ import annotations

import numpy as np

from ddlib.tables import scientific, significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import (
    FEWEST,
    Measured,
    judged,
    largest_median,
    mean,
    median,
)


def tested(rival: str, part: str = "torque", split: str = "loader") -> np.ndarray:
    """Errors of a rival on the test characters, one for each seed.

    Parameters
    ----------
    rival : str
        As in the study ``characters``.
    part : {"torque", "inertial", "coriolis", "gravity", "mass_matrix", "hurried"}
        Squared error in (N m)^2, both joints; relative errors of the mass matrix, and of the torque
        at twice the speed.
    split : {"loader", "figure"}
        Which characters are the test.
    """
    rows = results.read("characters")["rivals"][split][rival]["test"]
    return np.array([row[part] for row in rows])


def _judged(statistic, *cells, text) -> Measured:
    """`judged`, or the value alone if nothing random is in it."""
    if min(map(len, cells)) >= FEWEST:
        return judged(statistic, *cells, text=text)
    return Measured(float(statistic(*(cell[None] for cell in cells))[0]), text)


def against_published(rival: str, part: str = "torque") -> Measured:
    """Error over the published one: the larger of the medians of both splits.

    Parameters
    ----------
    rival, part
        As in `tested`.
    """
    published = results.read("characters")["published"][part]
    splits = ("loader", "figure")
    cells = [tested(rival, part, split) / published for split in splits]
    text = " and ".join(significant(np.median(c), 2) for c in cells) + " of the published error"
    return _judged(largest_median, *cells, text=text)


def as_published() -> Measured:
    """Error over the published one, at the end of the networks with the public code's settings."""
    study = results.read("characters")
    last, published = study["as published"]["marks"][-1], study["published"]["torque"]
    ratios = [one["course"][-1]["torque"] / published for one in study["as published"]["networks"]]
    text = f"{spread(ratios)} times the published error after {last:,} epochs"
    return judged(median, np.array(ratios), text=text)


def dead_starts() -> Measured:
    """Share of initial weights that leave a joint without inertia that can be learnt."""
    dead = np.array(results.read("characters")["as published"]["dead starts"], dtype=float)
    return judged(mean, dead, text=lambda share: f"{100 * share:.0f} % of {dead.size} starts")


def error(rival: str, part: str = "torque") -> Measured:
    """Error of a rival as in `tested`, with the loader's split: the median over seeds.

    Parameters
    ----------
    rival, part
        As in `tested`.
    """
    cell = tested(rival, part)
    return _judged(median, cell, text=_few(cell))


def _few(cell) -> str:
    low, middle, high = (scientific(f(cell)) for f in (np.min, np.median, np.max))
    return f"{middle} ({low} to {high})" if len(cell) > 1 else middle


def ratio(first: str, second: str, part: str = "torque") -> Measured:
    """Error of one rival over another's: medians over seeds, the larger ratio of both splits.

    Parameters
    ----------
    first, second, part
        As in `tested`.
    """
    pairs = [[tested(r, part, s) for r in (first, second)] for s in ("loader", "figure")]

    def larger(*cells):
        found = [median(a) / median(b) for a, b in zip(cells[::2], cells[1::2])]
        return np.max(found, axis=0)

    text = "; ".join(f"{_few(a)} against {_few(b)}" for a, b in pairs)
    return _judged(larger, *(cell for pair in pairs for cell in pair), text=text)


def asked(process: str, part: str = "trajectory 6", what: str = "covered") -> np.ndarray:
    """What the study ``gaussian-intervals`` found, one value for each day.

    Parameters
    ----------
    process : str
        As in the study.
    part : {"trajectory 6", "kept out"}
    what : {"covered", "rmss"}
    """
    rows = results.read("gaussian-intervals")["processes"][process][part]
    return np.array([row[what] for row in rows])


def covered(process: str, part: str = "trajectory 6") -> Measured:
    """Share of measured torques in a process's 95 % intervals: the median over days.

    Parameters
    ----------
    process, part
        As in `asked`.
    """
    cell = asked(process, part)
    return judged(median, cell, text=f"{spread(cell)} of the torques")


def beside_structure() -> Measured:
    """Error of structure and process on trajectory 6 over that of the better of the two alone.

    Day by day; the median over days.
    """
    names = ("beside known structure", "known structure", "estimated states")
    both, structure, process = (asked(name, what="rmss") for name in names)
    text = f"{spread(both)}; structure {spread(structure)}, process {spread(process)}"
    return judged(median, both / np.minimum(structure, process), text=text)
