"""Arms of more joints: errors over motions, what is needed by joints, couplings beside inertia."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import number, positive, shaped
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)

MARKERS = "os^Dv*"


def ladders(
    panels: Mapping[str, Mapping[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    level: float | None = None,
    height: float = 2.7,
) -> Illustration:
    """Errors over the size of a training set, both logarithmic: a line for each arm.

    Parameters
    ----------
    panels : mapping
        ``{title: {arm: (size, errors)}}``, of shapes (sizes,) and (sizes, seeds). Bold lines are
        medians, bars reach from the least to the largest error. An arm looks the same in all.
    labels : tuple of str
        Of the size and of the error.
    alt : str
        Alternative text.
    level : float, optional
        Error to be reached: a dotted line.
    height : float
        Of the figure, inches.

    Raises
    ------
    ValueError
        If there is no panel, or values are not positive or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for named in panels.values():
        for name, (size, errors) in named.items():
            sizes = len(positive(f"size of {name!r}", size, "(sizes,)"))
            positive(f"errors of {name!r}", errors, f"({sizes}, seeds)")
    arms = list(dict.fromkeys(name for named in panels.values() for name in named))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, named) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            axis.set_title(title)
            if level is not None:
                axis.axhline(level, color=FAINT, ls=":", lw=1.4)
            for name, (size, errors) in named.items():
                look, errors = _look(arms.index(name)), np.asarray(errors)
                axis.plot(size, np.median(errors, 1), **look)
                ends = errors.min(1), errors.max(1)
                axis.vlines(size, *ends, color=look["color"], lw=1.0, alpha=0.5)
        plain_ticks(axes[0].xaxis)
        plain_ticks(axes[0].yaxis)
        figure.supxlabel(check_label(labels[0]), fontsize=9.5)
        figure.supylabel(check_label(labels[1]), fontsize=9.5)
        legend_above(figure, [Line2D([], [], **_look(k)) for k in range(len(arms))], arms)

    return illustrate(draw, alt, 6.4, height)


def _look(k: int) -> dict:
    place = k % len(COLOURS)
    return {
        "color": COLOURS[place], "ls": DASHES[place], "marker": MARKERS[place], "ms": 4, "lw": 1.8
    }  # fmt: skip


def growth(
    joints, middle, ends, line, labels: tuple[str, str], names: tuple[str, str], alt: str
) -> Illustration:
    """What is needed by number of joints, with intervals, and a law through it.

    Parameters
    ----------
    joints : array_like, shape (arms,)
    middle : array_like, shape (arms,)
    ends : array_like, shape (2, arms)
        Of the intervals.
    line : array_like, shape (arms,)
        The law at the same numbers of joints.
    labels : tuple of str
        Of the axes.
    names : tuple of str
        Of the dots and of the line.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If values are not positive or shapes do not fit.
    """
    arms = len(positive("joints", joints, "(arms,)"))
    middle, line = (positive(n, x, f"({arms},)") for n, x in (("middle", middle), ("line", line)))
    low, high = positive("ends", ends, f"(2, {arms})")

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log")
        axis.plot(joints, line, color=FAINT, ls="--", lw=1.4, label=names[1])
        axis.vlines(joints, low, high, color=COLOURS[0], lw=2.2, alpha=0.6)
        axis.plot(joints, middle, "o", color=COLOURS[0], ms=6, label=names[0])
        axis.set_xticks(joints, [f"{n:g}" for n in joints])
        axis.minorticks_off()
        plain_ticks(axis.yaxis)
        axis.set_xlabel(check_label(labels[0]))
        axis.set_ylabel(check_label(labels[1]))
        axis.legend(loc="upper left")

    return illustrate(draw, alt, 4.6, 2.9)


def couplings(inertia, real, unrelated, label: str, alt: str) -> Illustration:
    """Gains of networks on accelerations by pair of joints, beside the arm's inertia.

    Parameters
    ----------
    inertia : array_like, shape (torque, joint)
        The arm's.
    real, unrelated : array_like, shape (networks, torque, joint)
        Gains of networks, and of those trained on unrelated torques: a bar holds the middle nine
        tenths.
    label : str
        Of the vertical axes: all values have one unit.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If values are not finite or shapes do not fit.
    """
    inertia = shaped("inertia", inertia, "(torque, joint)")
    sizes = f"(networks, {inertia.shape[0]}, {inertia.shape[1]})"
    real, unrelated = shaped("real", real, sizes), shaped("unrelated", unrelated, sizes)
    number("joints", inertia.shape[0], 1)

    def draw(figure: Figure):
        axes = figure.subplots(1, len(inertia), sharey=True, squeeze=False)[0]
        place = np.arange(1, inertia.shape[1] + 1)
        for j, axis in enumerate(axes):
            low, high = np.percentile(unrelated[:, j], (5, 95), axis=0)
            axis.bar(
                place, high - low, 0.6, low, color=FAINT, alpha=0.35, label="unrelated torques"
            )
            axis.hlines(inertia[j], place - 0.36, place + 0.36, color=INK, lw=1.8, label="the arm")
            for k, gains in enumerate(real[:, j]):
                x = place + 0.4 * (k / max(len(real) - 1, 1) - 0.5)
                name = "networks" if k == 0 else None
                axis.plot(x, gains, "o", color=COLOURS[0], ms=3, mew=0, alpha=0.8, label=name)
            axis.set(title=f"torque {j + 1}", xticks=place)
            axis.grid(visible=False, axis="x")
        axes[0].set_ylabel(check_label(label))
        figure.supxlabel("acceleration of joint", fontsize=9.5)
        legend_above(figure, *axes[0].get_legend_handles_labels())

    return illustrate(draw, alt, 6.4, 2.7)
