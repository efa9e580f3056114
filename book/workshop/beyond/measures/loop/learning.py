"""Learners in the loop, seed by seed: the study ``learning-in-the-loop``; errors in mm."""

from __future__ import annotations

from ddlib.dynamics import PUMA_560, count, newton_euler
from workshop.report.evidence.verdicts import Measured


def multiplications(hidden: int = 10, inputs: int = 42, every: int = 5, replay: int = 15) -> dict:
    """Multiplications of the torque and of each way to learn, in a control period on average."""
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
