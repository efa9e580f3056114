"""Curves: quantities over one axis, predictions over measurements, errors by window size.

Of many networks every one is fine and their median bold.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import number, positive, shaped
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)


def curves(
    x,
    panels: Mapping[str, Mapping[str, np.ndarray]],
    x_label: str,
    alt: str,
    *,
    columns: int = 1,
    height: float = 2.1,
    x_log=False,
    y_log=False,
) -> Illustration:
    """Curves over a common axis, one panel below (or beside) the other.

    Parameters
    ----------
    x : array_like, shape (points,)
        The common axis.
    panels : mapping
        ``{y label: {curve name: values (points,)}}``. A value may also be a pair
        ``(x, y)`` with an axis of its own.
    x_label, alt : str
        Label of the x axis; alternative text.
    columns : int
        Panels in one row.
    height : float
        Height of a panel, inches.
    x_log, y_log : bool
        Logarithmic axes.
    """  # fmt: skip
    rows = -(-len(panels) // columns)
    names = [tuple(named) for named in panels.values()]
    above = len(names[0]) > 1 and len(set(names)) == 1  # where no curve can run through it
    look = {name: k for k, name in enumerate(dict.fromkeys(sum(names, ())))}

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
        for axis, (label, named) in zip(axes, panels.items()):
            for name, y in named.items():
                x_k, y_k = y if isinstance(y, tuple) else (x, y)
                k = look[name]  # the same curve looks the same in every panel
                dash = DASHES[k % len(DASHES)]
                axis.plot(x_k, y_k, color=COLOURS[k % len(COLOURS)], ls=dash, label=name)
            axis.set_ylabel(check_label(label))
            if x_log:
                axis.set_xscale("log")
                plain_ticks(axis.xaxis)
            if y_log:
                axis.set_yscale("log")
                plain_ticks(axis.yaxis)
            if len(named) > 1 and not above:
                axis.legend(loc="best", ncols=2 if len(named) > 3 else 1)
        if above:
            legend_above(figure, *axes[0].get_legend_handles_labels())
        for axis in axes[max(len(panels) - columns, 0) : len(panels)]:
            axis.set_xlabel(check_label(x_label))
        for axis in axes[len(panels) :]:
            axis.remove()

    return illustrate(draw, alt, 7.0, height * rows + 0.4)


def overlay(
    t, measured, predicted: Mapping[str, np.ndarray], joint: str = "shoulder"
) -> Illustration:
    """Figure 4-1: measured torque (fine) under the networks' (bold), one panel each.

    Parameters
    ----------
    t : array_like, shape (time,)
        Times, s.
    measured : array_like, shape (time,)
        Measured torque, N m.
    predicted : mapping
        ``{title: torque (time,)}``.
    joint : str
        Name for the axis.
    """

    def draw(figure: Figure):
        axes = figure.subplots(len(predicted), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, torque) in zip(axes, predicted.items()):
            axis.plot(t, torque, color=COLOURS[1], lw=2.6, alpha=0.85, label="network")
            axis.plot(t, measured, color=INK, lw=0.8, label="measured")
            axis.set_title(title)
            axis.set_ylabel("torque, N m")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
        axes[-1].set_xlabel("time, s")

    worst = max(np.sqrt(np.mean((np.asarray(p) - measured) ** 2)) for p in predicted.values())
    alt = (
        f"Measured {joint} torque on the test trajectory with the torque of networks "
        f"({', '.join(predicted)}) laid over it; largest root mean square difference "
        f"{worst:.2f} N m."
    )
    return illustrate(draw, alt, 7.0, 1.7 * len(predicted) + 0.4)


def families(
    panels: Mapping[str, Mapping[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    height: float = 2.3,
    x_log: bool = False,
    y_log: bool = False,
) -> Illustration:
    """Families of curves, one for each way of learning: networks fine, their median bold.

    Parameters
    ----------
    panels : mapping
        ``{panel title: {name: (x, y)}}`` with `x` of shape (points,) and `y` of shape (points,
        networks). A family of the same name looks the same in every panel; an empty title is
        left out.
    labels : tuple of str
        Labels of the x and y axes.
    alt : str
        Alternative text.
    height : float
        Height of a panel, inches.
    x_log, y_log : bool
        Logarithmic axes.

    Raises
    ------
    ValueError
        If there is no panel, or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for named in panels.values():
        for name, (x, y) in named.items():
            x = shaped(f"x of {name!r}", x, "(points,)")
            shaped(f"y of {name!r}", y, f"({len(x)}, networks)")
    look = {n: k for k, n in enumerate(dict.fromkeys(n for p in panels.values() for n in p))}
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for axis, (title, named) in zip(axes, panels.items()):
            for name, (x, y) in named.items():
                k = look[name]
                colour, dash = COLOURS[k % len(COLOURS)], DASHES[k % len(DASHES)]
                axis.plot(x, y, color=colour, lw=0.6, alpha=0.45)
                axis.plot(x, np.median(y, axis=1), color=colour, ls=dash, lw=2.2)
            axis.set_title(title)
            for which, log in (("x", x_log), ("y", y_log)):
                if log:
                    axis.set(**{f"{which}scale": "log"})
                    plain_ticks(getattr(axis, f"{which}axis"))
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(labels[0], fontsize=9.5)
        figure.supylabel(labels[1], fontsize=9.5)
        if len(look) > 1 and max(map(len, panels.values())) > 1:
            handles = [
                Line2D([], [], color=COLOURS[k % len(COLOURS)], ls=DASHES[k % len(DASHES)], lw=2.2)
                for k in look.values()
            ]
            figure.legend(handles, list(look), loc="outside upper left", ncols=4)

    return illustrate(draw, alt, 7.0, height * rows + 0.5)


def clusters(
    panels: Mapping[str, tuple[Mapping[str, np.ndarray], float]], unit: str, alt: str
) -> Illustration:
    """A quantity of many networks in several groups, beside the value that it should have.

    Parameters
    ----------
    panels : mapping
        ``{panel title: ({group: values (networks,)}, wanted)}``. Every network is a dot; a bar
        marks the median of its group, a dashed line the value wanted.
    unit : str
        Label of the vertical axes.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no panel, or values are not finite or not of shape (networks,).
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for groups, wanted in panels.values():
        number("wanted", wanted)
        for name, values in groups.items():
            shaped(f"values of {name!r}", values, "(networks,)")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for axis, (title, (groups, wanted)) in zip(axes, panels.items()):
            axis.axhline(wanted, color=INK, ls="--", lw=1.0)
            for k, values in enumerate(map(np.asarray, groups.values())):
                colour = COLOURS[k % len(COLOURS)]
                x = k + np.linspace(-0.25, 0.25, len(values))
                axis.plot(x, values, "os^Dv"[k % 5], color=colour, ms=3.5, mew=0, alpha=0.7)
                middle = np.median(values)
                axis.plot([k - 0.36, k + 0.36], [middle, middle], color=colour, lw=2.2)
            axis.set_xticks(range(len(groups)), [name.replace(", ", "\n") for name in groups])
            axis.tick_params("x", labelsize=7.5)
            axis.grid(visible=False, axis="x")
            axis.set(title=title, xlim=(-0.6, len(groups) - 0.4))
            axis.set_ylim(min(0.0, axis.get_ylim()[0]), None)
        axes[0].set_ylabel(unit)

    return illustrate(draw, alt, 7.0, 2.9)


def predicted_curves(
    x,
    curves: Mapping[str, tuple],
    clouds: Mapping[str, tuple],
    labels: tuple[str, str, str, str],
    alt: str,
) -> Illustration:
    """Courses as predicted (dashed) and measured (solid), and all their ends side by side.

    Parameters
    ----------
    x : array_like, shape (points,)
        The axis of the courses, logarithmic like all others.
    curves : mapping
        ``{name: (measured, predicted)}``, both of shape (points,), positive.
    clouds : mapping
        ``{name: (predicted, measured)}``, both of shape (ends,), positive.
    labels : tuple of str
        Of the axes: x and y of the courses, then x and y of the ends.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If values are not positive and finite, or shapes do not fit.
    """
    points = len(shaped("x", x, "(points,)"))
    for length, named in ((points, curves), ("ends", clouds)):
        for name, pair in named.items():
            first, second = (positive(f"values of {name!r}", v, f"({length},)") for v in pair)
            shaped(f"values of {name!r}", second, first.shape)

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2, width_ratios=(1.35, 1.0))
        for k, (name, (measured, predicted)) in enumerate(curves.items()):
            colour = COLOURS[k % len(COLOURS)]
            left.plot(x, predicted, color=colour, ls="--", lw=1.2)
            left.plot(x, measured, color=colour, lw=1.9, marker="os^Dv*"[k % 6], ms=3.5, label=name)
        handles, names = left.get_legend_handles_labels()
        handles.append(Line2D([], [], color=INK, ls="--", lw=1.2))
        for k, (name, (foreseen, found)) in enumerate(clouds.items()):
            style = {"ls": "", "marker": "os^Dv*"[k % 6], "mfc": "none", "ms": 4}
            right.plot(foreseen, found, color=COLOURS[k % len(COLOURS)], label=name, **style)
        ends = np.concatenate([np.concatenate(pair) for pair in clouds.values()])
        ends = ends.min(), ends.max()
        right.plot(ends, ends, color=INK, lw=0.8)
        right.legend(loc="upper left", handletextpad=0.1)
        for axis, pair in ((left, labels[:2]), (right, labels[2:])):
            axis.set(xscale="log", yscale="log")
            axis.set_xlabel(check_label(pair[0]))
            axis.set_ylabel(check_label(pair[1]))
        legend_above(figure, handles, [*names, "predicted"])

    return illustrate(draw, alt, 7.0, 3.5)
