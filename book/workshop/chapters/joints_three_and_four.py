"""*Three and four joints*: errors by what was tried; figures of errors, needs and couplings."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.figures import (
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
from workshop.beyond.measures.loop.joints import DAMPED, row

FED = "windows, state feedback"  # as `DAMPED`, under the other reading of the controller

_MARKERS = "os^Dv*"


def ladders(
    panels: dict[str, dict[str, tuple]], labels: tuple[str, str], alt: str, level: float
) -> Illustration:
    """Errors over the size of a training set, both logarithmic: a line for each arm.

    Of ``{title: {arm: (sizes, errors)}}``, errors of shape (sizes, seeds), lines are medians, bars
    reach from the least to the largest. The error to be reached is dotted.
    """
    arms = list(dict.fromkeys(name for each in panels.values() for name in each))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, each) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            axis.set_title(title)
            axis.axhline(level, color=FAINT, ls=":", lw=1.4)
            for name, (size, errors) in each.items():
                look = _look(arms.index(name))
                axis.plot(size, np.median(errors, 1), **look)
                ends = np.min(errors, 1), np.max(errors, 1)
                axis.vlines(size, *ends, color=look["color"], lw=1.0, alpha=0.5)
        plain_ticks(axes[0].xaxis)
        plain_ticks(axes[0].yaxis)
        figure.supxlabel(check_label(labels[0]))
        figure.supylabel(check_label(labels[1]))
        legend_above(figure, [Line2D([], [], **_look(k)) for k in range(len(arms))], arms)

    return illustrate(draw, alt, 6.4, 2.7)


def _look(k: int) -> dict:
    place = k % len(COLOURS)
    return {
        "color": COLOURS[place], "ls": DASHES[place], "marker": _MARKERS[place], "ms": 4, "lw": 1.8
    }  # fmt: skip


def growth(
    joints, middle, ends, line, labels: tuple[str, str], names: tuple[str, str], alt: str
) -> Illustration:
    """What is needed by number of joints, with the ends of intervals, and a law through it."""

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log")
        axis.plot(joints, line, color=FAINT, ls="--", lw=1.4, label=names[1])
        axis.vlines(joints, *ends, color=COLOURS[0], lw=2.2, alpha=0.6)
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

    Gains are of shape (networks, torque, joint); a bar holds the middle nine tenths of those that
    were trained on unrelated torques.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(inertia), sharey=True, squeeze=False)[0]
        place = np.arange(1, len(inertia) + 1)
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
        figure.supxlabel("acceleration of joint")
        legend_above(figure, *axes[0].get_legend_handles_labels())

    return illustrate(draw, alt, 6.4, 2.7)


def cell(joints: int, motions: int, reading: str = DAMPED) -> dict:
    """Errors of window networks for a number of joints and of training motions."""
    return row(reading, joints=joints, motions=motions)


def states(joints: int, samples: int, units: int = 10) -> np.ndarray:
    """Test errors on random states, one for each seed."""
    return np.array(row("random states", joints=joints, units=units, samples=samples)["test"])


def two_joints(reading: str, motions: int, kind: str = "closed loop", taps: int = 5) -> np.ndarray:
    """Test errors on two joints, one for each seed, by how motions are followed."""
    how = {"reading": reading, "motions": motions, "kind": kind, "taps": taps}
    return np.array(row("closed loops", **how)["test"])
