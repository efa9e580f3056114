"""Learners in the loop, seed by seed: the study ``learning-in-the-loop``; errors in mm."""

from __future__ import annotations

import numpy as np

from ddlib.dynamics import PUMA_560, count, newton_euler
from ddlib.tables import spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured

PLAIN = "no feedforward"  # the feedback alone, as the study calls it


def part(name: str, setup: str = "joint damping") -> dict:
    """The study's "motion", "family" or "rates" under a reading of the controller."""
    setups = results.read("learning-in-the-loop")["setups"]
    if setup not in setups or name not in setups[setup]:
        raise ValueError(f"name and setup must be of the study, got {name!r}, {setup!r}")
    return setups[setup][name]


def on(
    motion: str, learner: str, setup: str = "joint damping", learning: bool = False
) -> np.ndarray:
    """End-point errors on a motion after practice of another one, one for each seed.

    With `learning` it goes on learning during this one trial.
    """
    errors = part("motion", setup)["tests"][motion]
    if learner not in errors:
        errors = errors["learning" if learning else "frozen"]
    return np.array(errors[learner])


def family(learner: str, when: str, setup: str = "joint damping") -> np.ndarray:
    """End-point errors on the family's test motions, one for each seed."""
    found, trials = part("family", setup), results.read("learning-in-the-loop")["trials"]
    if when in ("at the end", "without the load again"):
        return np.array(found[when][learner])
    return np.array(found["tests"][learner])[trials if when == "with the load" else trials - 1]


def _trials_to_half(errors, start) -> np.ndarray:
    """Trials after which errors, ``(trials, seeds)``, stay at half of a first value or below."""
    above = np.asarray(errors) > 0.5 * np.asarray(start)
    last = np.array([np.flatnonzero(each)[-1] if each.any() else -1 for each in above.T])
    return np.where(last == len(above) - 1, np.inf, last + 1.0)


def halved(learner: str, loaded: bool = False, setup: str = "joint damping") -> Measured:
    """Trials of the family to half the error of the feedback alone, or of the first loaded one."""
    number = results.read("learning-in-the-loop")["trials"]
    found = part("family", setup)
    errors = np.array(found["tests"][learner])
    if loaded:
        errors = np.concatenate([errors[number:], [found["at the end"][learner]]])
        start = errors[0]
    else:
        errors, start = errors[:number], np.array(found["tests"][PLAIN])[0]
    counts = _trials_to_half(errors, start)
    got = np.isfinite(counts).sum()
    text = f"{spread(counts)}, {got} of {counts.size} seeds" if got else "no seed"
    return Measured(float(np.median(counts)), text)


def multiplications(hidden: int = 10, inputs: int = 42, every: int = 5, replay: int = 15) -> dict:
    """Multiplications of the torque, and of each way to learn, in a control period on average.

    Of `hidden` units, two outputs and `inputs` numbers in a window; a learner works `every` so many
    control periods, and may learn `replay` samples again. Sigmoids, divisions and scaling are not
    counted.
    """
    features = hidden + inputs + 1
    torque = hidden * inputs + 2 * (hidden + inputs)
    # delta: o (1 - o) e; through the output weights and h (1 - h); all products times the rate
    back = 2 * 2 + 2 + 2 * hidden + 2 * hidden + hidden
    gradient = back + 2 * (features - 1) + hidden * inputs
    one = torque + gradient
    squares = features**2
    least = (torque - 2 * (hidden + inputs)) + 2 * (features - 1) + 2 * features
    least += 3 * squares + 2 * features
    plain = inputs + 1
    return {
        "torque": float(torque),
        "one pass": one / every,
        "by feedback": gradient / every,
        "replay": (1 + replay) * one / every,
        "last layer": least / every,
        "linear filter": (3 * plain**2 + 6 * plain - 2) / every,
    }


def affordable(learner: str) -> Measured:
    """Multiplications of torque and learning over what 1986 did in a control period."""
    each = multiplications()
    total = each["torque"] + (each[learner] if learner != "torque" else 0.0)
    could = count(newton_euler, PUMA_560, "arm").multiplications * 2.0 / 1.2
    return Measured(total / could, f"{total:,.0f} of {could:,.0f} in 2 ms")
