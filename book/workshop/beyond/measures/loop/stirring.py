"""Section 7.1: circles and via points, from the study ``stirring``."""

from __future__ import annotations

import numpy as np

from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, pick_and_place
from workshop.report import results
from workshop.report.evidence.verdicts import Measured


def row(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found with one of its set-ups."""
    return results.read("stirring")["setups"][setup]


def hand(name: str, motion: str = "circles", setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """The hand's RMS error with a feedforward: median over a family, one for each day, mm."""
    return np.median(row(setup)["hands"][name][motion], axis=1)


def turns() -> Measured:
    """Whether each joint that moves turns back once, in the middle, in each of Appendix I."""
    t = np.linspace(0.0, MOTION_SECONDS, 3002)[1:-1]  # no sample lies on the middle
    qd = pick_and_place(APPENDIX_I, t).qd
    moving = np.abs(qd).max(1) > 0
    back = np.diff(np.sign(qd), axis=1) != 0
    count = back.sum(1)[moving]
    where = t[back.argmax(1)[moving]]
    once = bool((count == 1).all() and np.abs(where - MOTION_SECONDS / 2).max() < 0.002)
    return Measured(once, f"{count.max()} turn a joint, after {where.mean():.2f} s")
