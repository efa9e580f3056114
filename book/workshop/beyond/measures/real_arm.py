"""The window network of 1988 on a real arm, beside what beats it: the result "real-arm".

Errors are mean squares over five blocks and six joints, in deviations of the whole recording.
"""

from __future__ import annotations

import numpy as np

from workshop.report import results

_RATE = 100  # samples a second of the paper, and of all rows that name no other


def cell(width: int, rate: int = _RATE) -> dict:
    """What the grid has for a window and a rate."""
    grid = results.read("real-arm")["grid"]
    (row,) = [r for r in grid if (r["width"], r["rate"]) == (width, rate)]
    return row


def squares(width: int, model: str = "network", rate: int = _RATE) -> np.ndarray:
    """Mean squared errors of a model of the grid, ``(blocks, networks)``; others stand alone."""
    errors = np.array(cell(width, rate)[model])
    return errors if model.startswith("network") else errors[:, None]


def of(cell) -> np.ndarray:
    """Root of the mean square, over blocks and networks, one for each draw."""
    return np.sqrt(cell.mean((-2, -1)))


def variant(name: str, side: str = "test") -> np.ndarray:
    """Mean squared errors of window 21 with one thing changed, ``(blocks, networks)``."""
    return np.array(results.read("real-arm")["variants"][name][side])
