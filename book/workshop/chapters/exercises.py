"""Judges answers to exercises: right, or wrong and why, without the solution.

An answer that is a number, some numbers or a word can be judged in the page as well, where nothing
runs: see `Waiting`.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from IPython.display import display


@dataclass(frozen=True)
class Between:
    """A number from `low` to `high`, both included; or some numbers, each in its own range."""

    low: float | Sequence[float]
    high: float | Sequence[float] = math.inf

    def __call__(self, mine) -> bool:
        low, mine = np.asarray(self.low, dtype=float), np.asarray(mine, dtype=float)
        return mine.shape == low.shape and bool(np.all((low <= mine) & (mine <= self.high)))


def judge(
    mine,
    right,
    told: str,
    slips: Iterable[tuple] = (),
    otherwise: str = "Read the question again.",
    tolerance: float = 0.02,
) -> None:
    """Say what is to be said to an answer.

    Parameters
    ----------
    mine : object
        The reader's answer; `...` as long as there is none.
    right : float, array_like, str, Between or callable
        What it has to be, numbers within a relative `tolerance`; or tells of an answer whether it
        is right. The page judges all but what only a function can tell.
    told : str
        Follows "Right: ".
    slips : iterable of (float, array_like, str, Between or callable, str)
        Answers that come from a known slip, and what follows "Wrong: " to each.
    otherwise : str
        Follows "Wrong: " to all other answers.
    tolerance : float
        Relative to the size of what is right.
    """
    cases = [(right, f"Right: {told}"), *((slip, f"Wrong: {why}") for slip, why in slips)]
    if mine is ...:
        display(Waiting(cases, f"Wrong: {otherwise}", tolerance))
        return
    for wanted, verdict in cases:
        if _is(mine, wanted, tolerance):
            print(verdict)
            return
    print(f"Wrong: {otherwise}")


def _is(mine, wanted, tolerance: float) -> bool:
    if isinstance(wanted, str):
        return isinstance(mine, str) and mine.strip().lower() == wanted.lower()
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


class Waiting:
    """What stands below an exercise that nobody has answered.

    With a kernel it says where the answer goes. In the page `_static/answers.js` makes a field of
    it, if the answer is a number, some numbers or a word: what it has to know goes with it, not to
    be read at a glance. If only code can be the answer, the page says where to run it.
    """

    WORDS = "Put your answer in place of the dots, and run this cell again."
    CODE = (
        "This answer is code: write it in your own copy of the notebook (the arrow above the page)."
    )

    def __init__(self, cases, otherwise: str, tolerance: float):
        self.cases, self.otherwise, self.tolerance = cases, otherwise, tolerance

    def __repr__(self) -> str:
        return self.WORDS

    def data(self) -> dict | None:
        """What a page needs in order to judge; None if the answer is code."""
        kinds = [self._case(wanted, said) for wanted, said in self.cases]
        if kinds[0] is None:
            return None
        return {"cases": [case for case in kinds if case], "otherwise": self.otherwise}

    def _case(self, wanted, said: str) -> dict | None:
        if isinstance(wanted, str):
            return {"word": wanted, "said": said}
        if isinstance(wanted, Between):
            low, high = np.broadcast_arrays(np.atleast_1d(wanted.low), wanted.high)
            return {"low": [*map(float, low)], "high": [*np.minimum(high, 1e300)], "said": said}
        if isinstance(wanted, Callable):
            return None
        wanted = np.atleast_1d(np.asarray(wanted, dtype=float))
        if wanted.ndim > 1 or wanted.size > 6:
            return None
        close = self.tolerance * np.abs(wanted).max()
        return {"low": [*(wanted - close)], "high": [*(wanted + close)], "said": said}

    def _repr_html_(self) -> str:
        told, data = self.CODE, self.data()
        kept = ""
        if data:
            packed = base64.b64encode(json.dumps(data).encode()).decode()
            kept, told = f' data-judge="{packed}"', "The answer is judged here, with a script."
        return (
            f'<div class="exercise-answer"{kept}><span class="lab">{self.WORDS}</span>'
            f'<span class="page" style="display:none">{told}</span></div>'
        )
