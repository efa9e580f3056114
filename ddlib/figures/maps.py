"""Figures that are maps: an error over a plane, and arms drawn at random."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import NullLocator
from scipy.spatial import ConvexHull

from ddlib._check import finite_array
from ddlib.figures.style import COLOURS, INK, Illustration, illustrate, plain_ticks

COLOUR_MAP = matplotlib.colormaps["viridis"].resampled(32)
"""Few enough steps that its bar is drawn and not an embedded picture, which pages forbid."""


def plane(
    x,
    y,
    values,
    labels: tuple[str, str, str],
    alt: str,
    *,
    levels=(),
    training=None,
    test=None,
    height: float = 3.6,
) -> Illustration:
    """A positive quantity over a plane, as colours on a logarithmic scale, with contour lines.

    Parameters
    ----------
    x, y : array_like, shape (n,) and (m,)
        Equally spaced places of the columns and rows.
    values : array_like, shape (m, n)
        Above 0.
    labels : tuple of str
        Of the x axis, the y axis and the colours.
    alt : str
        Alternative text.
    levels : sequence of float
        Contour lines, with their values written beside them.
    training, test : array_like, shape (points, 2), optional
        Places to mark; the hull of the first is outlined.
    height : float
        Inches.

    Raises
    ------
    ValueError
        If shapes do not fit or a value is not above 0.
    """
    x, y, values = (finite_array(n, v) for n, v in (("x", x), ("y", y), ("values", values)))
    if x.ndim != 1 or y.ndim != 1 or values.shape != (y.size, x.size):
        raise ValueError(
            f"values must have shape (len(y), len(x)) = ({y.size}, {x.size}), got {values.shape}"
        )
    if not (values > 0).all():
        raise ValueError(f"values must be above 0, got {values.min():g}")

    def draw(figure: Figure):
        axis = figure.subplots()
        norm = LogNorm(values.min(), values.max())
        mesh = axis.pcolormesh(x, y, values, norm=norm, cmap=COLOUR_MAP, shading="nearest",
                               linewidth=0.2, edgecolor="face")  # fmt: skip
        if len(levels):
            lines = axis.contour(x, y, values, levels=sorted(levels), colors="white",
                                 linewidths=1.0)  # fmt: skip
            axis.clabel(lines, fmt="%g", fontsize=8)
        if training is not None:
            axis.add_patch(Polygon(_hull(training), fill=False, ec="white", ls="--", lw=1.2))
            axis.plot(*np.transpose(training), "o", color="white", mec=INK, ms=7, label="training")
        if test is not None:
            axis.plot(*np.transpose(test), "D", color=COLOURS[1], mec="white", ms=8, label="test")
        axis.set(xlabel=labels[0], ylabel=labels[1])
        axis.grid(False)
        _finish(figure.colorbar(mesh, ax=axis, label=labels[2]))

    return illustrate(draw, alt, 5.6, height)


def _finish(bar: Colorbar):
    plain_ticks(bar.ax.yaxis)
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.outline.set_visible(False)


def _hull(points):
    points = np.asarray(points, dtype=float)
    return points[ConvexHull(points).vertices]


def scatter(
    points: Mapping[str, tuple],
    values,
    y_label: str,
    value_label: str,
    alt: str,
    chosen: int | None = None,
) -> Illustration:
    """One panel for each quantity: a result against it, a second one as colour.

    Parameters
    ----------
    points : mapping
        ``{x label: (x, y)}``; both ``(points,)`` and above 0, on logarithmic axes.
    values : array_like, shape (points,)
        What the colours show; above 0.
    y_label, value_label, alt : str
        Labels of the y axes and of the colours; alternative text.
    chosen : int, optional
        Index of a point to ring.

    Raises
    ------
    ValueError
        If a value is not above 0, or shapes differ.
    """
    values = finite_array("values", values)
    for name, pair in points.items():
        for part in pair:
            part = finite_array(name, part)
            if part.shape != values.shape or not (part > 0).all():
                raise ValueError(
                    f"points of {name!r} must be {values.size} numbers above 0, got {part}"
                )
    if not (values > 0).all():
        raise ValueError(f"values must be above 0, got {values.min():g}")
    columns = 3
    rows = -(-len(points) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
        norm = LogNorm(values.min(), values.max())
        for axis, (name, (x, y)) in zip(axes, points.items()):
            shown = axis.scatter(x, y, c=values, norm=norm, cmap=COLOUR_MAP, s=26, lw=0.6, ec=INK)
            if chosen is not None:
                axis.plot(x[chosen], y[chosen], "o", mfc="none", mec=COLOURS[1], ms=11, mew=2)
            axis.set(xscale="log", yscale="log", xlabel=name)
            plain_ticks(axis.xaxis)
            plain_ticks(axis.yaxis)
        for axis in axes[: len(points) : columns]:
            axis.set_ylabel(y_label)
        for axis in axes[len(points) :]:
            axis.remove()
        _finish(figure.colorbar(shown, ax=list(axes[: len(points)]), label=value_label))

    return illustrate(draw, alt, 7.0, 2.1 * rows + 0.3)
