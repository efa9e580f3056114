"""Figures that are maps: an error over a plane, Table 4-1 under set-ups, rows of intervals."""

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
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    illustrate,
    legend_above,
    plain_ticks,
)

SIGNS = ("o", "s", "^", "v", "P", "X")
"""Shapes of points that go with the colours."""

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
            axis.plot(*np.transpose(training), "o", color="white", mec=INK, ms=7, label="training",
                      clip_on=False, zorder=3)  # fmt: skip
        if test is not None:
            axis.plot(*np.transpose(test), "D", color=COLOURS[1], mec="white", ms=8, label="test",
                      clip_on=False, zorder=3)  # fmt: skip
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


def rmss_by_window(
    table: Mapping[str, Mapping[str, Mapping[int, np.ndarray]]], printed: Mapping
) -> Illustration:
    """Table 4-1 as a picture: every network's error under each set-up, and the printed values.

    Parameters
    ----------
    table : mapping
        ``{set-up: {column: {window: errors (members,)}}}``, errors above 0.
    printed : mapping
        ``{column: {window: value}}``.

    Raises
    ------
    ValueError
        If an error is not above 0.
    """
    for name, columns in table.items():
        for cells in columns.values():
            for values in cells.values():
                if not (finite_array(name, values) > 0).all():
                    raise ValueError(f"errors of {name!r} must be above 0, got {min(values)}")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(printed), sharey=True, squeeze=False)[0]
        shift = 0.8 / len(table)
        for axis, (column, marks) in zip(axes, printed.items()):
            for k, (name, columns) in enumerate(table.items()):
                for place, values in enumerate(columns[column].values()):
                    middle = place + (k - (len(table) - 1) / 2) * shift
                    across = middle + np.linspace(-0.35, 0.35, len(values)) * shift
                    axis.plot(across, np.sort(values), SIGNS[k], color=COLOURS[k], ms=3.2,
                              alpha=0.75, mew=0, label=name)  # fmt: skip
                    axis.plot(middle + np.array([-0.42, 0.42]) * shift, [np.median(values)] * 2,
                              color=INK, lw=2)  # fmt: skip
            for place, value in enumerate(marks.values()):
                axis.plot([place - 0.46, place + 0.46], [value] * 2, color=COLOURS[3], lw=1.8,
                          ls="--", label="printed")  # fmt: skip
            axis.set_xticks(range(len(marks)), [str(w) for w in marks])
            axis.set(xlabel="window, samples", title=column, yscale="log")
            axis.grid(False, axis="x")
            plain_ticks(axis.yaxis)
        axes[0].set_ylabel("RMSS")
        handles, names = axes[0].get_legend_handles_labels()
        first = dict(zip(names, handles))
        legend_above(figure, list(first.values()), list(first))

    alt = "RMSS of every network by window; medians as bars, printed values as dashed lines. "
    for name, columns in table.items():
        for column, cells in columns.items():
            medians = ", ".join(f"{w}: {np.median(v):.3f}" for w, v in cells.items())
            alt += f"{name}, median {column} error {medians}. "
    return illustrate(draw, alt.strip(), 7.0, 3.7)


def intervals(
    panels: Mapping[str, Mapping[str, Mapping[str, tuple]]],
    x_label: str,
    alt: str,
    *,
    log: bool = False,
    band: tuple[float, float] | None = None,
    marks: Mapping[str, Mapping[str, float]] | None = None,
    ends: Mapping[str, tuple[str, str]] | None = None,
) -> Illustration:
    """Panels of rows, each with a point and an interval for every series.

    Parameters
    ----------
    panels : mapping
        ``{title: {series: {row: (low, middle, high)}}}``.
    x_label, alt : str
        Label of the x axes; alternative text.
    log : bool
        Logarithmic x axes.
    band : pair of float, optional
        A range of x to shade.
    marks : mapping, optional
        ``{title: {row: x}}``: places marked with a diamond.
    ends : mapping, optional
        ``{row: (left, right)}``: what stands at both ends of a row, x being -1 to 1 there.

    Raises
    ------
    ValueError
        If an interval is not in order.
    """
    rows = list(dict.fromkeys(r for series in panels.values() for s in series.values() for r in s))
    for series in panels.values():
        for points in series.values():
            for row, point in points.items():
                low, middle, high = finite_array(row, point)
                if not low <= middle <= high:
                    raise ValueError(f"interval of {row!r} must be in order, got {tuple(point)}")

    def draw(figure: Figure):
        together = ends is None
        axes = figure.subplots(1, len(panels), sharex=together, sharey=together, squeeze=False)[0]
        for axis, (title, series) in zip(axes, panels.items()):
            own = rows if ends is None else list(next(iter(series.values())))
            if band is not None:
                axis.axvspan(*band, color=FAINT, alpha=0.2, lw=0)
            for k, (name, points) in enumerate(series.items()):
                offset = (k - (len(series) - 1) / 2) * 0.6 / len(series)
                for row, (low, middle, high) in points.items():
                    y = own.index(row) + offset
                    axis.plot([low, high], [y, y], color=COLOURS[k], lw=1.6)
                    axis.plot([middle], [y], SIGNS[k], color=COLOURS[k], ms=5, label=name)
            for row, x in (marks or {}).get(title, {}).items():
                axis.plot([x], [own.index(row)], "D", mfc="none", mec=COLOURS[3], ms=7, mew=1.5,
                          clip_on=False)  # fmt: skip
            axis.set_yticks(range(len(own)), own)
            axis.set_ylim(len(own) - 0.5, -0.5)
            axis.set(xlabel=x_label, title=title, xscale="log" if log else "linear")
            axis.grid(False, axis="y")
            if log:
                plain_ticks(axis.xaxis)
            if ends is not None:
                axis.set_xlim(-1, 1)
                axis.set_xticks([-1, 0, 1], [])
                for row, (left, right) in ends.items():
                    if row in own:
                        y = own.index(row) + 0.42
                        axis.text(-1, y, left, fontsize=7, ha="left", va="center")
                        axis.text(1, y, right, fontsize=7, ha="right", va="center")
        named = {}
        for axis in axes:
            named |= dict(zip(*reversed(axis.get_legend_handles_labels())))
        if len(named) > 1:
            legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 1.1 + 0.33 * len(rows))
