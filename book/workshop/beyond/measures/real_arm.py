"""The window network of 1988 on a real arm, beside what beats it: the result "real-arm".

Errors are mean squares over five blocks of the recording, each predicted by what was learnt on the
others, and all six joints, in units of the deviation of the whole recording. Replicates draw blocks
and, in each, networks; five blocks are few, and "undecided" often means just that.
"""

from __future__ import annotations

import numpy as np

from ddlib.analysis import savitzky_golay
from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

RATE = 100  # samples a second of the paper, and of all rows that name no other


def cell(width: int, rate: int = RATE) -> dict:
    """What the grid has for a window and a rate."""
    grid = results.read("real-arm")["grid"]
    (row,) = [r for r in grid if (r["width"], r["rate"]) == (width, rate)]
    return row


def squares(width: int, model: str = "network", rate: int = RATE) -> np.ndarray:
    """Mean squared errors of a model of the grid, ``(blocks, networks)``; others stand alone."""
    errors = np.array(cell(width, rate)[model])
    return errors if model.startswith("network") else errors[:, None]


def of(cell) -> np.ndarray:
    """Root of the mean square, over blocks and networks, one for each draw."""
    return np.sqrt(cell.mean((-2, -1)))


def variant(name: str, side: str = "test") -> np.ndarray:
    """Mean squared errors of window 21 with one thing changed, ``(blocks, networks)``."""
    return np.array(results.read("real-arm")["variants"][name][side])


def error(width: int = 21) -> Measured:
    """Test error of the networks at the paper's rate, told block by block."""
    blocks = squares(width)
    told = ", ".join(significant(float(of(block[None])), 2) for block in blocks)
    return judged(of, blocks, text=f"blocks: {told}", nested=True)


def magnitudes() -> Measured:
    """Largest weight of window 41 over that of window 21, medians over networks."""
    weights = tuple(np.array(cell(w)["largest weight"]) for w in (41, 21))
    taps = [np.abs(savitzky_golay(w, 2, 1 / RATE, degree=2)).max() for w in (41, 21)]
    a, b = (significant(np.median(x), 2) for x in weights)
    text = f"{a} at 41, {b} at 21; the ratio of acceleration filters is "
    return judged(
        lambda drawn: median(drawn[0]) / median(drawn[1]),
        weights,
        text=text + significant(taps[0] / taps[1], 2),
        nested=True,
    )
