"""Section 7.1: circles and via points, from the study ``stirring``; replicates draw days."""

from __future__ import annotations

import numpy as np

from ddlib.setups import JOINT_DAMPING
from ddlib.tables import significant, spread
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, pick_and_place
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, mean, median

OTHER = {"pick and place": "circles", "circles": "pick and place"}
"""The other one of the two families."""


def row(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found with one of its set-ups.

    Parameters
    ----------
    setup : str
        Its name.
    """
    return results.read("stirring")["setups"][setup]


def error(
    rival: str, learnt: str, asked: str, setup: str = JOINT_DAMPING.name, width: int = 21
) -> np.ndarray:
    """RMS torque errors of both joints together, N m, one for each day.

    Parameters
    ----------
    rival : str
        "network", "two units", "linear filter" or "identified".
    learnt, asked : str
        Family that it learnt, and the test.
    setup : str
    width : int
        Samples of the window; other windows than 21 for the network alone.
    """
    found = row(setup)
    rows = found["errors"][rival] if width == 21 else found["wider"][str(width)]
    return np.sqrt((np.array(rows[learnt][asked])[:, 1:] ** 2).mean(-1))


def pooled_rmss(rival: str, learnt: str, asked: str, setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """RMSS by the test's own deviation, one for each day.

    Parameters
    ----------
    rival, learnt, asked, setup
        As in `error`.
    """
    return np.array(row(setup)["errors"][rival][learnt][asked])[:, 0]


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


def shared(part: str = "all", family: str = "circles", setup: str = JOINT_DAMPING.name) -> Measured:
    """Share of the cells a family reaches that the other one reaches, over a second draw's share.

    Parameters
    ----------
    part : str
        Of the states: "positions", "velocities", "accelerations", "all", ...
    family : str
        Whose cells are counted.
    setup : str
    """
    found = row(setup)["coverage"][part][family]
    other, same = (found[kind]["shared"] for kind in ("other family", "same family"))
    text = f"{100 * other:.1f} %; another draw of {family}: {100 * same:.0f} %"
    return Measured(other / same, text)


def transfer(
    rival: str = "network",
    learnt: str = "pick and place",
    asked: str = "circles",
    against: str = "",
    setup: str = JOINT_DAMPING.name,
    width: int = 21,
) -> Measured:
    """Torque error of a rival on a test over that of one that learnt something else.

    Parameters
    ----------
    rival, learnt, asked, setup, width
        As in `error`.
    against : str
        What the other one learnt; default: the other family.
    """
    which = against or OTHER[learnt]
    one, other = (error(rival, family, asked, setup, width) for family in (learnt, which))
    count = min(len(one), len(other))
    text = f"{spread(one)} N m; learnt from {which}: {spread(other)} N m"
    return judged(
        lambda cells: median(cells[0]) / median(cells[1]),
        (one[:count], other[:count]),
        text=lambda value: f"{significant(value, 2)}: {text}",
    )


def instead(
    rival: str,
    against: str = "network",
    learnt: str = "pick and place",
    asked: str = "circles",
    setup: str = JOINT_DAMPING.name,
) -> Measured:
    """Torque error of a rival over that of another one that learnt and is asked the same.

    Parameters
    ----------
    rival, against : str
        As `rival` of `error`.
    learnt, asked, setup
        As in `error`.
    """
    one, other = (error(who, learnt, asked, setup) for who in (rival, against))
    return judged(
        lambda cells: median(cells[0]) / median(cells[1]),
        (one, other),
        text=f"{spread(one)} N m; {against}: {spread(other)} N m",
    )


def asked_over(
    rival: str, learnt: str, asked: str, easier: str, setup: str = JOINT_DAMPING.name
) -> Measured:
    """Torque error of a rival on one test over that on another one.

    Parameters
    ----------
    rival, learnt, asked, setup
        As in `error`.
    easier : str
        The test below the line.
    """
    one, other = (error(rival, learnt, which, setup) for which in (asked, easier))
    return judged(
        lambda cells: median(cells[0]) / median(cells[1]),
        (one, other),
        text=f"{spread(one)} N m; {easier}: {spread(other)} N m",
    )


def hand(name: str, motion: str = "circles", setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """The hand's RMS error with a feedforward: median over a family, one for each day, mm.

    Parameters
    ----------
    name : str
        As the study calls it: "none", "network, circles", ...
    motion : str
        Family that is driven.
    setup : str
    """
    return np.median(row(setup)["hands"][name][motion], axis=1)


def hand_over(
    name: str, against: str = "none", motion: str = "circles", setup: str = JOINT_DAMPING.name
) -> Measured:
    """Error of the hand with one feedforward over that with another one.

    Parameters
    ----------
    name, against, motion, setup
        As in `hand`; there is one value for what did not learn.
    """
    one, other = (hand(which, motion, setup) for which in (name, against))
    below = float(np.median(other))
    text = f"{spread(one)} mm; {against}: {significant(below, 2)} mm"
    if len(one) < 2:
        return Measured(float(one[0]) / below, text)
    return judged(lambda drawn: median(drawn) / below, one, text=text)


def velocity_share(over: str = "phases", family: str = "circles") -> Measured:
    """Share of hidden filters that are velocity filters, less that of other networks.

    Parameters
    ----------
    over : str
        "phases": networks of the same windows and torques with random phases; or the family
        that the other networks learnt.
    family : str
        What the networks learnt.
    """
    found = row()["filters"]
    k = found["classes"].index("velocity")
    other = found[over]["real"] if over in OTHER else found[family][over]
    one, two = (np.array(x["classes"])[:, k] for x in (found[family]["real"], other))
    return judged(
        lambda cells: mean(cells[0]) - mean(cells[1]),
        (one, two),
        text=f"{100 * one.mean():.0f} %; {over}: {100 * two.mean():.0f} %",
    )


def follows(quantity: int = 1, over: str = "phases", family: str = "circles") -> Measured:
    """What hidden units follow and nothing else tells (semi-partial R²), less other networks'.

    Parameters
    ----------
    quantity : int
        0: position, 1: velocity, 2: acceleration.
    over, family
        As in `velocity_share`.
    """
    found = row()["filters"]
    other = found[over]["real"] if over in OTHER else found[family][over]
    one, two = (np.array(x["unique"])[:, quantity] for x in (found[family]["real"], other))
    return judged(
        lambda cells: median(cells[0]) - median(cells[1]),
        (one, two),
        text=f"{spread(one)}; {over}: {spread(two)}",
    )
