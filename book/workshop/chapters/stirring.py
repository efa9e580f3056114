"""*Stirring*: figures of states, errors traded and paths; the study's errors, day by day."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.figures import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    check_label,
    dots_in_one,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.setups import JOINT_DAMPING, Setup
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, pick_and_place
from workshop.beyond.studies.loop.run_time_parts import exact
from workshop.report import results
from workshop.report.evidence.verdicts import Measured

_MARKERS = "os^Dv"
_PLANES = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s²"}


def traded(
    points: dict[str, tuple], nothing: tuple[float, float], labels: tuple[str, str], alt: str
) -> Illustration:
    """Errors on one family against errors on another, both logarithmic: a dot for each network.

    `nothing` are both errors without any of them: two lines, beyond which they do harm.
    """

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log")
        axis.axvline(nothing[0], color=FAINT, ls="--", lw=1)
        axis.axhline(nothing[1], color=FAINT, ls="--", lw=1)
        for k, (name, pair) in enumerate(points.items()):
            look = {"color": COLOURS[k % len(COLOURS)], "ls": "", "ms": 6, "mew": 0, "alpha": 0.85}
            axis.plot(*pair, _MARKERS[k % len(_MARKERS)], label=name, **look)
        axis.set(xlabel=check_label(labels[0]), ylabel=check_label(labels[1]))
        low = min(np.min(pair) for pair in points.values()) / 1.3
        high = max(max(np.max(p) for p in points.values()), *nothing) * 1.4
        axis.set(xlim=(low, high), ylim=(low, high), aspect="equal")
        axis.text(nothing[0] * 1.05, low * 1.1, "none", color=FAINT, fontsize=8)
        axis.text(low * 1.05, nothing[1] * 1.05, "none", color=FAINT, fontsize=8)
        plain_ticks(axis.xaxis)
        plain_ticks(axis.yaxis)
        legend_above(figure, *axis.get_legend_handles_labels())

    return illustrate(draw, alt, 5.2, 5.2)


def paths(wanted, panels: dict[str, np.ndarray], factor: float, alt: str) -> Illustration:
    """Paths of the hand ``(time, 2)``, errors exaggerated, each over the path that was wanted."""
    rows = -(-len(panels) // 3)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 3, sharex=True, sharey=True, squeeze=False)
        for axis, (title, path) in zip(axes.ravel(), panels.items()):
            path = wanted + factor * (path - wanted)
            axis.plot(*wanted.T, color=INK, lw=0.9, label="wanted")
            axis.plot(*path.T, color=COLOURS[1], lw=1.8, label=f"error × {factor:g}")
            axis.plot(*path[0], "o", color=COLOURS[1], ms=4)
            axis.set_title(title)
            axis.set_aspect("equal")
        for axis in axes.ravel()[len(panels) :]:
            axis.remove()
        figure.supxlabel("x, m")
        figure.supylabel("y, m")
        legend_above(figure, *axes[0, 0].get_legend_handles_labels())

    return illustrate(draw, alt, 6.6, 1.7 * rows + 0.7)


def two_families(states: dict[str, np.ndarray], alt: str) -> Illustration:
    """States ``(n, 6)`` of families of motions, shoulder against elbow."""

    def draw(figure: Figure):
        axes = figure.subplots(1, 3)
        for k, (axis, (title, unit)) in enumerate(zip(axes, _PLANES.items())):
            for x, colour in zip(states.values(), COLOURS):
                dots_in_one(axis, x[:, [k, k + 3]], ec=colour, lw=1.8, alpha=0.8)
            axis.autoscale_view()
            axis.set(title=title, xlabel=f"shoulder, {unit}", ylabel=f"elbow, {unit}")
        look = {"marker": "o", "ls": "", "ms": 4.8, "mew": 0}
        handles = [Line2D([], [], color=c, label=name, **look) for name, c in zip(states, COLOURS)]
        figure.legend(handles=handles, loc="outside upper left", ncols=3)

    return illustrate(draw, alt, 7.0, 2.9)


def error(
    rival: str, learnt: str, asked: str, setup: str = JOINT_DAMPING.name, width: int = 21
) -> np.ndarray:
    """RMS torque errors of both joints together on a test, N m, one for each day."""
    found = _row(setup)
    rows = found["errors"][rival] if width == 21 else found["wider"][str(width)]
    return np.sqrt((np.array(rows[learnt][asked])[:, 1:] ** 2).mean(-1))


def needed(setup: Setup, q, qd, qdd) -> np.ndarray:
    """Torque of the arm's equations with its friction, N m."""
    return exact(setup)(q, qd, qdd)


def _row(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found with one of its set-ups."""
    return results.read("stirring")["setups"][setup]


def hand(name: str, motion: str = "circles", setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """The hand's RMS error with a feedforward: median over a family, one for each day, mm."""
    return np.median(_row(setup)["hands"][name][motion], axis=1)


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
