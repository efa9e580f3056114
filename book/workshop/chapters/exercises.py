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
        mine = _as_many(mine, np.asarray(self.low))
        return mine is not None and bool(np.all((self.low <= mine) & (mine <= self.high)))


@dataclass(frozen=True)
class MultipleOf:
    """Some numbers, each so many times one of these; not all zero."""

    these: Sequence[float]


class OneOf:
    """Any of these: numbers, words, ranges."""

    def __init__(self, *these):
        self.these = these


def fitting(fits: Callable, values: Sequence[float]) -> OneOf:
    """The ranges of numbers that `fits`, if each holds one of the ascending `values`."""

    def last(inside, outside):
        for _ in range(60):
            middle = (inside + outside) / 2
            inside, outside = (middle, outside) if fits(middle) else (inside, middle)
        return inside

    runs = np.flatnonzero(np.diff([0, *(bool(fits(x)) for x in values), 0])).reshape(-1, 2)
    near = [values[0], *values, values[-1]]  # one place on
    return OneOf(
        *(Between(last(near[i + 1], near[i]), last(near[j], near[j + 1])) for i, j in runs)
    )


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
    right : float, array_like, str, Between, MultipleOf, OneOf or callable
        What it has to be, numbers within a relative `tolerance`, `nan` for any; or tells of an
        answer whether it is right. The page judges all but what only a function can tell.
    told : str
        Follows "Right: ".
    slips : iterable of (like `right`, str)
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


def _as_many(mine, wanted: np.ndarray) -> np.ndarray | None:
    """An answer as numbers in the shape of what is wanted, as [11] for 11; None if it has none."""
    try:
        mine = np.asarray(mine, dtype=float)
    except (TypeError, ValueError):
        return None
    return mine.reshape(wanted.shape) if mine.size == wanted.size else None


def _limits(wanted, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """From where to where each number may lie."""
    wanted = np.asarray(wanted, dtype=float)
    close = np.where(np.isnan(wanted), np.inf, tolerance * np.nanmax(np.abs(wanted)))
    middle = np.nan_to_num(wanted)
    return middle - close, middle + close


def _is(mine, wanted, tolerance: float) -> bool:
    if isinstance(wanted, str):
        return isinstance(mine, str) and mine.strip(" \n\t.").lower() == wanted.lower()
    if isinstance(wanted, OneOf):
        return any(_is(mine, one, tolerance) for one in wanted.these)
    if isinstance(wanted, MultipleOf):
        these = np.asarray(wanted.these, dtype=float)
        mine = _as_many(mine, these)
        if mine is None or not np.isfinite(mine).all():
            return False
        off = mine - these * (these @ mine) / (these @ these)
        return bool(np.any(mine) and np.abs(off).max() <= tolerance * np.abs(mine).max())
    if isinstance(wanted, Callable):
        try:
            return bool(wanted(mine))
        except (TypeError, ValueError, IndexError, KeyError, AttributeError, ArithmeticError):
            return False
    return Between(*_limits(wanted, tolerance))(mine)


class Waiting:
    """What stands below an exercise that nobody has answered.

    With a kernel it says where the answer goes. In the page `_static/answers.js` makes a field of
    it, if the answer is a number, some numbers or a word: what it has to know goes with it, not to
    be read at a glance. If an answer has to be run to be judged, the page says where.
    """

    WORDS = "Put your answer in place of the dots, and run this cell again."
    RUN = (
        "This answer has to be run before it can be judged. Download your own copy of the notebook "
        "(the arrow above the page), and answer there."
    )

    def __init__(self, cases, otherwise: str, tolerance: float):
        self.cases, self.otherwise, self.tolerance = cases, otherwise, tolerance

    def __repr__(self) -> str:
        return self.WORDS

    def data(self) -> dict | None:
        """What a page needs in order to judge; None if only a run can."""
        if not self._kept(self.cases[0][0]):
            return None
        kept = [{**one, "said": said} for wanted, said in self.cases for one in self._kept(wanted)]
        return {"cases": kept, "otherwise": self.otherwise}

    def _kept(self, wanted) -> list[dict]:
        if isinstance(wanted, str):
            return [{"word": wanted}]
        if isinstance(wanted, OneOf):
            return [kept for one in wanted.these for kept in self._kept(one)]
        if isinstance(wanted, MultipleOf):
            return [{"along": [*map(float, wanted.these)], "close": self.tolerance}]
        if isinstance(wanted, Between):
            limits = wanted.low, wanted.high
        elif isinstance(wanted, Callable) or np.ndim(wanted) > 1 or np.size(wanted) > 6:
            return []
        else:
            limits = _limits(wanted, self.tolerance)
        low, high = np.clip(np.broadcast_arrays(*map(np.atleast_1d, limits)), -1e300, 1e300)
        return [{"low": low.tolist(), "high": high.tolist()}]

    def _repr_html_(self) -> str:
        told, data = self.RUN, self.data()
        kept = ""
        if data:
            packed = base64.b64encode(json.dumps(data).encode()).decode()
            kept, told = (
                f' data-judge="{packed}"',
                "Switch on scripts, and this page judges your answer.",
            )
        return (
            f'<div class="exercise-answer"{kept}><span class="lab">{self.WORDS}</span>'
            f'<span class="page" style="display:none">{told}</span></div>'
        )
