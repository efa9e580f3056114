"""Nine kinds of answer to an exercise, and what a judge must not say to them."""

from __future__ import annotations

import io
from contextlib import redirect_stdout, suppress
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from open_cells import execute

from workshop.chapters import exercises as engine

KINDS = (
    "int", "float", "list", "array", "other case", "near miss", "gross error", "NaN", "raising",
)  # fmt: skip
UNUSED = "-"  # where a kind of answer is none


@dataclass
class Nine:
    """An exercise's judge, asked as a reader asks it."""

    space: dict  # of the lesson's cells
    starter: str
    check: str
    solution: str
    seen: list = field(default_factory=list)  # the exercise, each time it was judged

    def judge(self, mine, exercise, real=engine.judge) -> None:
        """Stands for the engine's, and keeps what is asked."""
        self.seen.append(exercise)
        real(mine, exercise)

    def told(self, answer) -> str:
        """What is said to an answer, without making the exercise anew."""
        with redirect_stdout(io.StringIO()) as printed:
            self.judge(answer, self.seen[-1])
        return printed.getvalue().strip()

    def table(self) -> dict[str, str]:
        """What is said to each kind of answer; first and last by the lesson's own cells."""
        execute(self.starter, self.space, "starter")
        execute(self.solution, self.space, "solution")
        right = self.space["mine"]
        said = {"as solved": execute(self.check, self.space, "check").strip()}
        asked = self.seen[-1]
        answers = self._answers(right, asked)
        said |= {k: UNUSED if v is UNUSED else self.told(v) for k, v in answers.items()}
        if asked.kind != "function":  # the cell with the answer raises
            with suppress(ZeroDivisionError):
                execute(self.starter.replace("= ...", "= 1 / 0"), self.space, "starter")
            said["raising"] = execute(self.check, self.space, "check").strip()
        return said

    def _answers(self, right, asked) -> dict:
        if asked.kind == "word":
            other = next(word for word in asked.options if word.lower() != str(right).lower())
            alike = {"list": [right], "array": np.array(right), "other case": f" {right.upper()} "}
            unfit = {"near miss": other, "gross error": "banana", "NaN": float("nan")}
            return {"int": UNUSED, "float": UNUSED, **alike, **unfit}
        if asked.kind == "function":

            def scaled(factor):
                return lambda *x: factor * np.asarray(right(*x))

            def raising(*x):
                return 1 / 0

            return {
                "int": 3, "float": 0.5, "list": [right], "array": scaled(1), "other case": UNUSED,
                "near miss": scaled(1.05), "gross error": scaled(0), "NaN": scaled(np.nan),
                "raising": raising,
            }  # fmt: skip
        flat = np.asarray(right, dtype=float).ravel()
        near = np.asarray(_near(asked, flat))
        whole = not (flat % 1).any()
        one = asked.kind == "number"
        return {
            "int": (int(flat[0]) if one else [*map(int, flat)]) if whole else UNUSED,
            "float": float(flat[0]) if one else tuple(map(float, flat)),
            "list": flat.tolist(),
            "array": np.array(right) if one else flat[:, None],
            "other case": Fraction(float(flat[0])) if one else [[Fraction(x) for x in flat]],
            "near miss": near.item() if one else near.tolist(),
            "gross error": -1e9 if one else (-1e9 * (1 + np.arange(flat.size))).tolist(),
            "NaN": np.nan if one else [np.nan, *flat[1:]],
        }


def _near(asked, flat: np.ndarray) -> np.ndarray:
    """An answer just beyond what is right, as far as numbers show where that ends."""
    right = asked.right
    if isinstance(right, engine.Between) and np.isfinite(right.high).all():
        return np.atleast_1d(np.asarray(right.high) * 1.05)
    if isinstance(right, engine.OneOf) or callable(right):
        return flat * 1.05 if not asked.whole else flat + np.eye(flat.size, dtype=int)[0]
    along = isinstance(right, engine.MultipleOf)  # the answer is compared with the nearest one
    step = max((4 if along else 1.5) * asked.tolerance, 0.01) * np.abs(flat).max()
    return flat + step * np.eye(flat.size)[0]


def plain(right) -> bool:
    """Whether what is right is numbers or one range, so that a near miss can be seen."""
    words = isinstance(right, (str, engine.OneOf)) or (
        callable(right) and not isinstance(right, engine.Between)
    )
    return not words


def wrong(nine: Nine) -> dict[str, str]:
    """What a judge says that it must not, by the kind of answer."""
    said = nine.table()
    asked = nine.seen[0]
    unfit = "Not judged", "Your function"
    starts = dict.fromkeys(("as solved", "int", "float", "list", "array", "other case"), ("Right",))
    starts |= {"near miss": ("Wrong",), "gross error": ("Wrong", *unfit), "NaN": unfit}
    starts["raising"] = ("Put your answer in place of the dots",)
    if asked.kind == "function":
        starts |= dict.fromkeys(("int", "float", "list"), ("Not judged: a function is asked",))
        starts["raising"] = ("Your function raised ZeroDivisionError: division by zero; not jud",)
    if not plain(asked.right):
        starts["near miss"] = ("Right", "Wrong", "Not judged")  # only the criterion knows
    found = {k: v for k, v in said.items() if v != UNUSED and not v.startswith(starts[k])}
    exact = [s for s, _ in asked.slips if not callable(s)]
    if plain(asked.right) and "close" not in said["near miss"] and not exact:
        found["near miss"] = said["near miss"]
    if "close, but" in said["gross error"]:
        found["gross error"] = said["gross error"]
    return found
