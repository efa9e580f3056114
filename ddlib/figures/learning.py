"""Figures of learning: curves of many networks at once, every one fine and their median bold."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import finite_array, integer, number
from ddlib.figures.style import COLOURS, DASHES, INK, Illustration, illustrate


def families(
    panels: Mapping[str, Mapping[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    columns: int = 2,
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
    columns : int
        Panels in one row.
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
    integer("columns", columns, 1)
    number("height", height, 0.0, open_low=True)
    for named in panels.values():
        for name, (x, y) in named.items():
            x, y = finite_array(f"x of {name!r}", x), finite_array(f"y of {name!r}", y)
            if x.ndim != 1 or y.ndim != 2 or len(x) != len(y):
                raise ValueError(
                    f"x and y of {name!r} must have shapes (points,) and (points, networks), "
                    f"got {x.shape} and {y.shape}"
                )
    look = {n: k for k, n in enumerate(dict.fromkeys(n for p in panels.values() for n in p))}
    columns = min(columns, len(panels))
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
            axis.set_xscale("log" if x_log else "linear")
            axis.set_yscale("log" if y_log else "linear")
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
            shape = finite_array(f"values of {name!r}", values).shape
            if len(shape) != 1:
                raise ValueError(f"values of {name!r} must have shape (networks,), got {shape}")

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
