"""Judges answers to exercises: right, or wrong and why, without the solution."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np


def judge(
    mine,
    right,
    told: str,
    slips: Iterable[tuple] = (),
    otherwise: str = "Read the question again.",
    tolerance: float = 0.02,
) -> None:
    """Print what is to be said to an answer.

    Parameters
    ----------
    mine : object
        The reader's answer; `...` as long as there is none.
    right : float, array_like or callable
        What it has to be, within a relative `tolerance`; or tells of an answer whether it is right.
    told : str
        Follows "Right: ".
    slips : iterable of (float, array_like or callable, str)
        Answers that come from a known slip, and what follows "Wrong: " to each.
    otherwise : str
        Follows "Wrong: " to all other answers.
    tolerance : float
        Relative to the size of what is right.
    """
    if mine is ...:
        print("Put your answer in place of the dots, and run this cell again.")
        return
    for wanted, verdict in ((right, f"Right: {told}"), *((s, f"Wrong: {w}") for s, w in slips)):
        if _is(mine, wanted, tolerance):
            print(verdict)
            return
    print(f"Wrong: {otherwise}")


def _is(mine, wanted, tolerance: float) -> bool:
    if isinstance(wanted, Callable):
        try:
            return bool(wanted(mine))
        except (TypeError, ValueError, IndexError, KeyError, AttributeError, ArithmeticError):
            return False
    wanted = np.asarray(wanted, dtype=float)
    try:
        mine = np.asarray(mine, dtype=float)
    except (TypeError, ValueError):
        return False
    close = tolerance * np.abs(wanted).max()
    return mine.shape == wanted.shape and bool(np.all(np.abs(mine - wanted) <= close))
