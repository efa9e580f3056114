"""What a class answered before a course and after it: `make gains FOLDER=returned`.

The folder has the files that students saved on the page *Twelve questions*, in any folders below.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

import numpy as np
from lessons import questions

ROOT = Path(__file__).parents[2]
ASKED = questions(ROOT, "book/before-and-after")
RIGHT = {
    f"quiz-{one['key']}": answer["letter"]
    for one in ASKED
    for answer in one["answers"]
    if answer.get("right")
}
TIMES = ("before", "after")


def answered(folder: Path) -> dict[str, dict[str, list[bool]]]:
    """By student and time, which questions were answered right; of two files the later one counts.

    Raises
    ------
    ValueError
        If a file has answers to other questions, or no student both times.
    """
    found: dict[str, dict[str, list[bool]]] = {}
    rows = []
    for path in sorted(folder.rglob("*.csv")):
        with path.open(encoding="utf-8-sig", newline="") as file:
            own = list(csv.DictReader(file))
        if not own or {row.get("key") for row in own} != {*RIGHT}:
            raise ValueError(f"{path} must have the twelve questions of this book, as it is now")
        rows += own
    for row in sorted(rows, key=lambda row: row["ended"]):
        of = found.setdefault(row["student"], {}).setdefault(row["time"], [False] * len(RIGHT))
        of[[*RIGHT].index(row["key"])] = row["answer"] == RIGHT[row["key"]]
    if not any(len(own) == 2 for own in found.values()):
        raise ValueError(f"{folder} must have a student who answered both times")
    return found


def gain(right: np.ndarray) -> float:
    """Of what was wrong before, the share that is right after; axes: student, time, question."""
    before, after = right.mean((0, 2))
    return (after - before) / (1 - before)


def told(found: dict[str, dict[str, list[bool]]]) -> str:
    """A line a question, and the gain with what other students of the kind would change."""
    both = [[own[time] for time in TIMES] for own in found.values() if len(own) == 2]
    right, count = np.array(both), len(both)
    lines = [
        f"{k:2}  {before:4.0%} {after:4.0%}  {one['again']}"
        for k, (one, before, after) in enumerate(zip(ASKED, *right.mean(0)), 1)
    ]
    draws = np.random.default_rng(0).integers(count, size=(2000, count))
    low, high = np.quantile([gain(right[draw]) for draw in draws], (0.025, 0.975))
    lines += [f"{count} of {len(found)} students answered both times."]
    lines += [
        f"Normalised gain {gain(right):.2f}; with other such students {low:.2f} to {high:.2f}."
    ]
    return "\n".join(["    before after, right", *lines])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    try:
        print(told(answered(parser.parse_args().folder)))
    except (ValueError, OSError) as error:
        sys.exit(f"==> {error}")
