"""Judges answers to exercises: right, or wrong and why, without the solution.

A lesson's module has a function that gives an `Exercise` for each number, and `check =
judging(that)`. An answer that is a number, some numbers or a word can be judged in the page as
well, where nothing runs: see `Waiting`.
"""

from __future__ import annotations

import base64
import json
import math
import re
import reprlib
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from IPython.display import display


@dataclass(frozen=True)
class Between:
    """A number from `low` to `high`, both included; or some numbers, each in its own range."""

    low: float | Sequence[float]
    high: float | Sequence[float] = math.inf

    def __call__(self, mine) -> bool:
        """Whether an answer lies there."""
        mine = np.reshape(mine, np.shape(self.low))
        return bool(np.all((self.low <= mine) & (mine <= self.high)))


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


@dataclass(frozen=True)
class Exercise:
    """What is asked, what is right, and what is said to which answer.

    Attributes
    ----------
    kind : str
        "number", "word", "numbers" (a fixed few, handed on as a tuple), "array" or "function".
    right : float, array_like, str, Between, MultipleOf, OneOf or callable
        What the answer has to be, `nan` for any number; or tells of an answer whether it is right.
        The page judges all but what only a function can tell.
    reason : str
        Follows "Right: ", one sentence that teaches.
    slips : iterable of (like `right`, str)
        Answers that come from a known slip, and what follows "Wrong: " to each.
    otherwise : str
        Follows "Wrong: " to all other answers.
    tolerance : float
        Relative to the size of what is right. A near miss is told from a gross error.
    count : int
        Of numbers, if what is right does not show it.
    unit : str
        Follows the answer where it is repeated.
    options : sequence of str
        All words that may be answered.
    unless : iterable of (callable, str)
        Answers that cannot be judged, and why.
    whole : bool
        Whether numbers have to be whole; then they are handed on as integers.
    infinite : bool
        Whether infinity is an answer.
    """

    kind: str
    right: object
    reason: str
    slips: Iterable[tuple] = ()
    otherwise: str = "Read the question again."
    tolerance: float = 0.02
    count: int = 0
    unit: str = ""
    options: Sequence[str] = ()
    unless: Iterable[tuple] = ()
    whole: bool = False
    infinite: bool = False

    def cases(self) -> list[tuple]:
        """What is compared, how closely, and what is said if it fits; the first that fits counts.

        Slips that are one answer come before a near miss, and a near miss before wide slips.
        """
        slips = [(slip, self.tolerance, f"Wrong: {why}") for slip, why in self.slips]
        wide = [isinstance(slip, (Between, Callable)) for slip, *_ in slips]
        return [
            (self.right, self.tolerance, f"Right: {self.reason}"),
            *(case for case, late in zip(slips, wide) if not late),
            *_near(self.right, self.tolerance),
            *(case for case, late in zip(slips, wide) if late),
        ]

    def size(self) -> int:
        """How many numbers are asked."""
        if self.kind == "number":
            return 1
        right = self.right.these if isinstance(self.right, MultipleOf) else self.right
        right = right.low if isinstance(right, Between) else right
        return self.count or np.size(right)


class NotJudged(Exception):
    """An answer that is none, and why."""


def judging(exercise: Callable) -> Callable:
    """The `check(number, mine, *given)` of a lesson, from what gives each `Exercise`.

    It sets `mine` back to dots where it was called, so that no answer is judged twice: not if the
    cell with the next answer raises, either.
    """

    def check(number: int, mine, *given) -> None:
        """Judge an answer to an exercise, with what the lesson's cells give."""
        caller = sys._getframe(1).f_globals
        if caller.get("mine", ...) is mine:
            caller["mine"] = ...
        judge(mine, exercise(number, *given))

    return check


verdict = SimpleNamespace(right=False)
"""Of the last answer."""


def judge(mine, exercise: Exercise) -> None:
    """Say what is to be said to an answer, `...` as long as there is none; keep `verdict`."""
    verdict.right = _judged(mine, exercise)


def _judged(mine, exercise: Exercise) -> bool:
    if mine is ...:
        display(Waiting(exercise))
        return False
    try:
        answer = _taken(mine, exercise)
        with np.errstate(all="ignore"):
            told = _verdict(answer, exercise)
    except NotJudged as reason:
        print(reason)
    except Exception as error:  # whatever an answer raises where it is used
        print(f"Not judged: with your answer the check raised {_named(error)}")
    else:
        print(told + _echo(answer, exercise))
        return told.startswith("Right")
    return False


def _verdict(answer, exercise: Exercise) -> str:
    """The verdict on an answer of the right kind."""
    for unfit, why in exercise.unless:
        if unfit(answer):
            raise NotJudged(f"Not judged: {why}{_echo(answer, exercise)}")
    for wanted, close, verdict in exercise.cases():
        if _is(answer, wanted, close):
            return verdict
    return f"Wrong: {exercise.otherwise}"


def _named(error: Exception) -> str:
    return f"{type(error).__name__}: {error}".rstrip(": .") + "."


def _taken(mine, exercise: Exercise):
    """An answer as what is asked: a float, a tuple of them, an array, a word, a function."""
    if exercise.kind == "word":
        return _word(mine, exercise.options)
    if exercise.kind == "function":
        return _function(mine)
    size, given = exercise.size(), reprlib.repr(mine)
    asked = "one number is asked" if size == 1 else f"{size} numbers are asked"
    if mine is None:
        raise NotJudged(f"Not judged: {asked}, and your answer is None. Was something returned?")
    if isinstance(mine, Callable):
        raise NotJudged(f"Not judged: {asked}, and your answer is a function.")
    try:
        raw = np.asarray(mine)
        if raw.dtype == bool:
            raise NotJudged(f"Not judged: {asked}, and your answer is {given}.")
        if np.iscomplexobj(raw) or any(isinstance(x, complex) for x in raw.flat):
            raise NotJudged(f"Not judged: your answer is complex, {given}. Is a root negative?")
        numbers = raw.astype(float).ravel()
    except (TypeError, ValueError):
        raise NotJudged(f"Not judged: {asked}, and your answer is {given}.") from None
    if numbers.size != size:
        raise NotJudged(f"Not judged: {asked}, and you gave {numbers.size}.")
    if np.isnan(numbers).any():
        raise NotJudged("Not judged: NaN is no number. What was divided by zero, or never set?")
    if np.isinf(numbers).any() and not exercise.infinite:
        raise NotJudged("Not judged: infinity is no answer here. What was divided by zero?")
    if exercise.whole:
        if (numbers % 1).any():
            raise NotJudged(f"Not judged: whole numbers are asked, and your answer is {given}.")
        numbers = numbers.astype(int)
    if exercise.kind == "array":
        return numbers
    return numbers[0].item() if exercise.kind == "number" else tuple(numbers.tolist())


def _word(mine, options: Sequence[str]) -> str:
    if not isinstance(mine, str) and np.size(mine) == 1:
        mine = np.asarray(mine).flat[0]
    word = mine.strip(" \n\t.\"'").lower() if isinstance(mine, str) else ""
    if not word or (options and word not in map(str.lower, options)):
        raise NotJudged(f"Not judged: write {_either(options)}.")
    return word


def _either(options: Sequence[str]) -> str:
    *first, last = [f'"{option}"' for option in options] or ["a word"]
    return f"{', '.join(first)} or {last}" if first else last


def _function(mine) -> Callable:
    """A function that says of itself if it raises, or gives something else than numbers."""
    if not isinstance(mine, Callable):
        raise NotJudged(
            f"Not judged: a function is asked, and your answer is {reprlib.repr(mine)}."
        )

    def called(*inputs, **named):
        try:
            value = mine(*inputs, **named)
        except Exception as error:
            raise NotJudged(f"Your function raised {_named(error)[:-1]}; not judged.") from None
        try:
            fine = np.isfinite(np.asarray(value, dtype=float)).all()
        except (TypeError, ValueError):
            fine = False
        if not fine:
            raise NotJudged(f"Your function returned {reprlib.repr(value)}; not judged.")
        return value

    return called


def _echo(answer, exercise: Exercise) -> str:
    """The answer that was judged, in words."""
    if exercise.kind in ("word", "function"):
        return f' You gave "{answer}".' if exercise.kind == "word" else ""
    many = np.atleast_1d(answer)
    if many.size > 6:
        return f" You gave {many.size} numbers from {_shown(many.min())} to {_shown(many.max())}."
    return f" You gave {', '.join(map(_shown, many))} {exercise.unit}".rstrip() + "."


def _shown(x: float) -> str:
    """A number as the page writes it, too: whole, or with six digits."""
    x = float(x)
    if x.is_integer() and abs(x) < 1e15:
        return f"{x:.0f}".replace("-0", "0") if x == 0 else f"{x:.0f}"
    if not 1e-6 <= abs(x) < 1e21:
        return re.sub(r"e([+-])0", r"e\1", f"{x:.6g}")
    return np.format_float_positional(x, 6, fractional=False, trim="-")


def _near(right, tolerance: float) -> list[tuple]:
    """What is close to what is right, if that is numbers or ranges."""
    wide = max(2 * tolerance, min(10 * tolerance, 0.2), 0.02)
    if isinstance(right, OneOf):
        if all(isinstance(this, Between) for this in right.these):
            return [near for this in right.these for near in _near(this, tolerance)]
        return []
    if isinstance(right, Between):
        low, high = (np.asarray(limit, dtype=float) for limit in (right.low, right.high))
        low, high = low - 0.1 * np.abs(low), high + 0.1 * np.abs(high)
        return [(Between(low, high), tolerance, "Wrong: close, but not close enough.")]
    if isinstance(right, (str, Callable)) or not np.isfinite(_numbers(right)).all():
        return []
    closer = f"not within {100 * tolerance:.3g} %" if tolerance > 1e-3 else "here it must be exact"
    said = f"Wrong: close, but {closer}: did you round, or leave something out?"
    return [(right, wide, said)]


def _numbers(wanted) -> np.ndarray:
    these = wanted.these if isinstance(wanted, MultipleOf) else wanted
    return np.asarray(these, dtype=float)


def _limits(wanted, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """From where to where each number may lie."""
    wanted = np.asarray(wanted, dtype=float)
    if np.isinf(wanted).any():
        return wanted, wanted
    close = np.where(np.isnan(wanted), np.inf, tolerance * np.nanmax(np.abs(wanted)))
    middle = np.nan_to_num(wanted)
    return middle - close, middle + close


def _is(mine, wanted, tolerance: float) -> bool:
    if isinstance(wanted, str):
        return mine == wanted.lower()
    if isinstance(wanted, OneOf):
        return any(_is(mine, this, tolerance) for this in wanted.these)
    if isinstance(wanted, MultipleOf):
        these, mine = _numbers(wanted), np.asarray(mine)
        off = mine - these * (these @ mine) / (these @ these)
        return bool(np.any(mine) and np.abs(off).max() <= tolerance * np.abs(mine).max())
    if isinstance(wanted, Callable):
        return bool(wanted(mine))
    return Between(*_limits(wanted, tolerance))(mine)


class Waiting:
    """What stands below an exercise that nobody has answered.

    With a kernel it says where the answer goes. In the page `_static/answers.js` makes a field of
    it, if the answer is a number, some numbers or a word: what it has to know goes with it, not to
    be read at a glance. If an answer has to be run to be judged, the page says where.
    """

    WORDS = "Put your answer in place of the dots, run that cell, and then this one."
    RUN = (
        "This answer has to be run before it can be judged. Download your own copy of the notebook "
        "(the arrow above the page), and answer there."
    )

    def __init__(self, exercise: Exercise):
        self.exercise = exercise

    def __repr__(self) -> str:
        return self.WORDS

    def data(self) -> dict | None:
        """What a page needs in order to judge; None if only a run can."""
        right, close, _ = (cases := self.exercise.cases())[0]
        if not self._comparisons(right, close):
            return None
        judged = [
            {**comparison, "said": verdict}
            for *wanted, verdict in cases
            for comparison in self._comparisons(*wanted)
        ]
        words = {"unit": self.exercise.unit, "options": [*map(str.lower, self.exercise.options)]}
        words["unfit"] = f"Not judged: write {_either(self.exercise.options)}."
        return {"cases": judged, "otherwise": f"Wrong: {self.exercise.otherwise}", **words}

    def _comparisons(self, wanted, close: float) -> list[dict]:
        if isinstance(wanted, str):
            return [{"word": wanted}]
        if isinstance(wanted, OneOf):
            return [c for this in wanted.these for c in self._comparisons(this, close)]
        if isinstance(wanted, MultipleOf):
            return [{"along": [*map(float, wanted.these)], "close": close}]
        if isinstance(wanted, Between):
            limits = wanted.low, wanted.high
        elif isinstance(wanted, Callable) or np.ndim(wanted) > 1 or np.size(wanted) > 6:
            return []
        else:
            limits = _limits(wanted, close)
        low, high = np.clip(np.broadcast_arrays(*map(np.atleast_1d, limits)), -1e300, 1e300)
        return [{"low": low.tolist(), "high": high.tolist()}]

    def _repr_html_(self) -> str:
        words, data = self.RUN, self.data()
        attribute = ""
        if data:
            packed = base64.b64encode(json.dumps(data).encode()).decode()
            attribute = f' data-judge="{packed}"'
            words = "Switch on scripts, and this page judges your answer."
        return (
            f'<div class="exercise-answer"{attribute}><span class="lab">{self.WORDS}</span>'
            f'<span class="page" style="display:none">{words}</span></div>'
        )
