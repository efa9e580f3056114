"""Section 7.1: four findings on closed loops under other conditions, from ``loop-conditions``."""

from __future__ import annotations

import numpy as np

from ddlib.setups import JOINT_DAMPING
from ddlib.tables import significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median


def kept(*path: str):
    """A part of the result, by its names.

    Parameters
    ----------
    *path : str
        Like "hands", after the part of the study and the set-up.
    """
    found = results.read("loop-conditions")
    for name in path:
        found = found[name]
    return found


def _over(one, other, unit: str = "mm") -> Measured:
    """Median of one group over that of another, each drawn by itself where it has members."""
    one, other = (np.array(x, float) for x in (one, other))
    told = f"{spread(one)} {unit} against {spread(other)}"
    if other.size < 2:
        below = float(other[0])
        return judged(lambda drawn: median(drawn) / below, one, text=told)
    return judged(lambda a, b: median(a) / median(b), one, other, text=told)


def copied(seconds: float, setup: str = JOINT_DAMPING.name) -> Measured:
    """Exact equations, given a smoothed copy of the paper's plan, over networks of window 21.

    Parameters
    ----------
    seconds : float
        Length of the smoothing.
    setup : str
    """
    rows = kept("copies", setup)
    return _over(rows[f"{seconds:g}"], rows["network"])


def stopped(
    model: str = "chosen", against: str = "none", motion: str = "circles",
    setup: str = JOINT_DAMPING.name,
) -> Measured:  # fmt: skip
    """The hand's error with a model as feedforward over that with another.

    Parameters
    ----------
    model, against : str
        "chosen" (steps of training chosen on pick-and-place), "60", "twenty circles",
        "identified" or "none".
    motion : {"circles", "pick and place"}
    setup : str
    """
    rows = kept("stopped", setup, "hands", motion)
    return _over(rows[model], rows[against])


def four_joints(line: str) -> Measured:
    """Error of networks of four joints on test motions, RMSS over all joints.

    Parameters
    ----------
    line : str
        "300 of twenty", "750 of twenty", "as it is" or "chosen" (both five motions).
    """
    found = np.array(kept("windows", line))
    return judged(median, found, text=spread(found))


def practised(
    learner: str, motion: str, practice: str = "in step", setup: str = JOINT_DAMPING.name
) -> Measured:
    """Error on a motion after practising one, frozen, over that of the feedback alone.

    Parameters
    ----------
    learner, motion : str
        As the study names them.
    practice : {"in step", "out of step", "two harmonics"}
    setup : str
    """
    rows = kept("practised", setup, practice, motion)
    one, other = (np.array(rows[name]) for name in (learner, "none"))
    told = f"{spread(one)} mm against {spread(other)}"
    return judged(median, one / other, text=lambda value: f"{significant(value, 2)}: {told}")
