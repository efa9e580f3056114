"""Figures of the chapter on stirring: two families' states, errors traded, paths of the hand."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from ddlib._check import number, positive, shaped
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)

MARKERS = "os^Dv"

PLANES = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s²"}
"""What of a state is drawn, shoulder against elbow."""


def traded(
    points: Mapping[str, tuple], nothing: tuple[float, float], labels: tuple[str, str], alt: str
) -> Illustration:
    """Errors on one family against errors on another, both logarithmic: a dot for each network.

    Parameters
    ----------
    points : mapping
        ``{name: (errors on the first, errors on the second)}``, shape (networks,) each.
    nothing : tuple of float
        Both errors without any of them: two lines, beyond which they do harm.
    labels : tuple of str
        Of the horizontal and the vertical axis.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is nothing to draw, or an error is not above 0.
    """
    if not points:
        raise ValueError("points must hold one name or more, got none")
    for name, (first, second) in points.items():
        first = positive(f"points of {name!r}", first, "(networks,)")
        positive(f"points of {name!r}", second, first.shape)
    for value in nothing:
        number("nothing", value, 0.0, open_low=True)

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.set(xscale="log", yscale="log")
        axis.axvline(nothing[0], color=FAINT, ls="--", lw=1)
        axis.axhline(nothing[1], color=FAINT, ls="--", lw=1)
        for k, (name, pair) in enumerate(points.items()):
            look = {"color": COLOURS[k % len(COLOURS)], "ls": "", "ms": 6, "mew": 0, "alpha": 0.85}
            axis.plot(*pair, MARKERS[k % len(MARKERS)], label=name, **look)
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


def paths(
    wanted, panels: Mapping[str, np.ndarray], factor: float, alt: str, columns: int = 3
) -> Illustration:
    """Paths of the hand with exaggerated errors, each over the path that was wanted.

    Parameters
    ----------
    wanted : array_like, shape (time, 2)
        Where the hand should be, m.
    panels : mapping
        ``{title: where it is (time, 2)}``, m.
    factor : float
        By how much errors are exaggerated.
    alt : str
        Alternative text.
    columns : int
        Panels in a row.
    """
    wanted = shaped("wanted", wanted, "(time, 2)")
    number("factor", factor, 1.0)
    drawn = {
        title: wanted + factor * (shaped(f"path of {title!r}", path, wanted.shape) - wanted)
        for title, path in panels.items()
    }
    if not drawn:
        raise ValueError("panels must hold one path or more, got none")
    rows = -(-len(drawn) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axis, (title, path) in zip(axes.ravel(), drawn.items()):
            axis.plot(*wanted.T, color=INK, lw=0.9, label="wanted")
            axis.plot(*path.T, color=COLOURS[1], lw=1.8, label=f"error × {factor:g}")
            axis.plot(*path[0], "o", color=COLOURS[1], ms=4)
            axis.set_title(title)
            axis.set_aspect("equal")
        for axis in axes.ravel()[len(drawn) :]:
            axis.remove()
        figure.supxlabel("x, m", fontsize=9.5)
        figure.supylabel("y, m", fontsize=9.5)
        legend_above(figure, *axes[0, 0].get_legend_handles_labels())

    return illustrate(draw, alt, 6.6, 1.7 * rows + 0.7)


def _dots(places: np.ndarray, colour: str) -> PathPatch:
    """Small dots as one shape: lines of no length with round ends.

    Thousands of markers would be as many elements of the page.
    """
    path = Path(np.repeat(places, 2, axis=0), [Path.MOVETO, Path.LINETO] * len(places))
    path.should_simplify = False
    look = {"facecolor": "none", "edgecolor": colour, "lw": 1.8, "alpha": 0.8}
    return PathPatch(path, capstyle="round", **look)


def two_families(states: Mapping[str, np.ndarray], alt: str) -> Illustration:
    """States of families of motions, shoulder against elbow: positions, velocities, accelerations.

    Parameters
    ----------
    states : mapping
        ``{name: states (n, 6)}``: position, velocity, acceleration of the shoulder, then of the
        elbow.
    alt : str
        Alternative text.
    """
    drawn = {n: shaped(f"states of {n!r}", x, "(states, 6)") for n, x in states.items()}
    if not drawn:
        raise ValueError("states must hold one family or more, got none")

    def draw(figure: Figure):
        axes = figure.subplots(1, 3)
        for k, (axis, (title, unit)) in enumerate(zip(axes, PLANES.items())):
            for j, (name, x) in enumerate(drawn.items()):
                dots = _dots(x[:, [k, k + 3]], COLOURS[j % len(COLOURS)])
                axis.add_patch(dots)
                dots.set_label(name)
            axis.autoscale_view()
            axis.set(title=title, xlabel=f"shoulder, {unit}", ylabel=f"elbow, {unit}")
        look = {"marker": "o", "ls": "", "ms": 4.8, "mew": 0}
        handles = [
            Line2D([], [], color=COLOURS[j % len(COLOURS)], label=name, **look)
            for j, name in enumerate(drawn)
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=3)

    return illustrate(draw, alt, 7.0, 2.9)
