"""Settings of assignments that differ, in `book/variants.yml`: found, kept, verified.

    python book/_ext/variants.py                  verifies what is kept, every lesson whole
    python book/_ext/variants.py feedback         verifies one lesson
    python book/_ext/variants.py --find feedback  draws its variants anew

A variant is kept if the book's solutions are right with its settings, all open cells run, and its
answer to some exercise is right in no other variant and not in the book, where a solution stands.
`differ` counts for each exercise the answers that are neither the book's nor each other's.
"""

from __future__ import annotations

import argparse
import itertools
import random
import sys

import yaml
from lessons import entries, lessons
from solved import FILE, ROOT, Solved, apart, differ, solve, variants

MANY = 10
HEAD = """\
# Variants of assignments: settings for the cell *Change this* (or for a cell with a question), by
# lesson, found and verified by book/_ext/variants.py. Variant 7 is the seventh. A lesson without
# variants says why. `differ` has for each exercise how many different answers the variants have.

"""


def _link(mass: float, length: float, com: float, inertia: float) -> str:
    return f"Link(mass={mass:.1f}, length={length:.2f}, com={com:.2f}, inertia={inertia:.2f})"


ODD = [str(w) for w in range(11, 42, 2)]
UPPER = [
    _link(m, n, 0.22, i) for m in (10, 12, 16, 18) for n in (0.4, 0.45, 0.55) for i in (0.3, 0.5)
]
FOREARM = [
    _link(m, 0.4, c, i) for m in (8, 10, 12, 16) for c in (0.07, 0.11, 0.14) for i in (0.4, 0.8)
]
FRICTION = [f"({s:.1f}, {e:.1f})" for s in (4.0, 4.6, 6.0, 6.8, 7.5) for e in (0.8, 1.4)]
ARM = 'Arm.from_links("mine", Link(14.0, 0.5, 0.22, 0.4), Link({}, 0.4, {}, {}))'
ARMS = [
    ARM.format(m, c, i) for m in (6.0, 10.0, 14.0) for c in (0.06, 0.1, 0.15) for i in (0.2, 0.5)
]


def _extents(seed: int) -> str:
    draw = random.Random(seed)
    return str([[draw.randint(0, 45), draw.randint(0, 45)] for _ in range(6)])


CHOICES = {
    "dynamics": {"upper_arm": UPPER, "forearm": FOREARM},
    "feedback": {"viscous": FRICTION, "period": ["0.0005", "0.001", "0.00125", "0.002"]},
    "feedforward": {"viscous": FRICTION, "seconds": ["2.5", "3.0", "3.5"], "forearm": FOREARM},
    "trajectories-and-recording": {"extents": [_extents(seed) for seed in range(40)]},
    "backpropagation": {"seed": [str(n) for n in range(1, 40)]},
    "window-networks": {"window": ODD, "hidden": [str(n) for n in range(5, 15)]},
    "hinton-diagrams": {"window": ODD, "hidden_units": [str(n) for n in range(5, 17)]},
    "convolution-filters": {"window": ODD},
    "whose-filters": {"window": ODD},
    "inertia-in-the-weights": {"window": ODD},
    "whole-state-space": {"import": ["from ddlib.dynamics import Arm, Link"], "arm": ARMS},
    "adaptive-control": {
        "gain": [f"({s:.1f}, {e:.1f})" for s in (25, 30, 40, 45, 50) for e in (8, 12, 14)],
    },
    "learning-in-the-loop": {
        "M": ["3.2", "3.8", "4.6", "5.2"],
        "F": ["4.1", "4.7", "6.1", "6.9"],
        "k": ["200.0", "250.0", "350.0", "400.0"],
        "gamma": ["0.15", "0.2", "0.25", "0.3"],
    },
}  # fmt: skip


def path(lesson: str):
    return ROOT / "book" / f"{lesson}.ipynb"


def told(solved: list[Solved]) -> list[str]:
    """What the judge says to reference solutions that are not right."""
    return [
        f"{k}: {one.said}" for k, one in enumerate(solved, 1) if not one.said.startswith("Right")
    ]


def failure(lesson: str, settings: dict[str, str]) -> str:
    """What goes wrong when a whole lesson is run with settings; nothing, as a rule."""
    try:
        return next(iter(told(solve(path(lesson), settings, whole=True))), "")
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def found(lesson: str, only: int, most: int = MANY) -> list[dict[str, str]]:
    """Variants of a lesson, from random draws of its choices, by one exercise or all."""
    names, values = zip(*CHOICES[lesson].items())
    drawn = [dict(zip(names, choice)) for choice in itertools.product(*values)]
    random.Random(lesson).shuffle(drawn)
    kept, solutions = [], [solve(path(lesson), only=only)]
    for settings in drawn:
        solved = solve(path(lesson), settings, only=only)
        said = next(iter(told(solved)), "")
        if not said and all(apart(solved, other) for other in solutions):
            said = failure(lesson, settings)
            if not said:
                kept.append(settings)
                solutions.append(solved)
        print(f"    {settings}: {'kept' if settings in kept else said or 'alike'}", flush=True)
        if len(kept) == most:
            return kept
    raise ValueError(f"{lesson}: only {len(kept)} variants differ")


def mistakes(lesson: str, whole: bool = True) -> list[str]:
    """What is wrong with the kept variants of a lesson, each run whole or as far as needed."""
    kept = variants(lesson)
    if isinstance(kept, str):
        return []
    solutions, wrong = [solve(path(lesson))], []
    for number, settings in enumerate(kept, 1):
        solutions.append(solve(path(lesson), settings))
        said = told(solutions[-1]) or ([failure(lesson, settings)] if whole else [])
        wrong += [f"{lesson}, variant {number}: {mistake}" for mistake in said if mistake]
    if (now := differ(solutions)) != (said := entries(ROOT, "variants")["differ"].get(lesson)):
        wrong.append(f"{lesson}: {now} answers differ, not {said}")
    for first, second in itertools.combinations(range(len(solutions)), 2):
        if not apart(solutions[first], solutions[second]):
            wrong.append(f"{lesson}: variants {first} and {second} have the same answers")
    return wrong


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--find", action="store_true")
    parser.add_argument("--only", type=int, default=0, help="an exercise, to find by it alone")
    parser.add_argument("lessons", nargs="*")
    asked = parser.parse_args()
    kept = yaml.safe_load(FILE.read_text("utf-8")) if FILE.exists() else {}
    wrong = []
    for lesson in asked.lessons or [*CHOICES]:
        print(f"==> {lesson}", flush=True)
        if asked.find:
            own = found(lesson, asked.only)
            kept["differ"][lesson] = differ([solve(path(lesson), s) for s in ({}, *own)])
            kept[lesson] = own
            ordered = [each.name for each in lessons(ROOT)]
            counts = {name: kept["differ"][name] for name in ordered if name in kept["differ"]}
            kept = {"differ": counts} | {name: kept[name] for name in ordered if name in kept}
            text = yaml.safe_dump(kept, sort_keys=False, width=200, allow_unicode=True)
            FILE.write_text(HEAD + text, encoding="utf-8")
        else:
            wrong += (now := mistakes(lesson))
            print(*now or ["right, and apart"], sep="\n", flush=True)
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
