"""Figures of the chapter *Window networks*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import NullLocator
from scipy.spatial import ConvexHull

from ddlib._check import finite_array
from ddlib.figures.maps import COLOUR_MAP, SIGNS
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    illustrate,
    legend_above,
    plain_ticks,
)


def overlay(t, measured, predicted: Mapping[str, np.ndarray]) -> Illustration:
    """Figure 4-1: measured torque (fine) under the networks' (bold), one panel each."""

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
        f"Measured shoulder torque on the test trajectory with the torque of networks "
        f"({', '.join(predicted)}) laid over it; largest root mean square difference "
        f"{worst:.2f} N m."
    )
    return illustrate(draw, alt, 7.0, 1.7 * len(predicted) + 0.4)


def plane(
    x,
    y,
    values,
    labels: tuple[str, str, str],
    alt: str,
    *,
    levels,
    training,
    test,
) -> Illustration:
    """A positive quantity over a plane, as colours on a logarithmic scale, with contour lines."""
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
        lines = axis.contour(x, y, values, levels=sorted(levels), colors="white", linewidths=1.0)
        axis.clabel(lines, fmt="%g", fontsize=8)
        axis.add_patch(Polygon(_hull(training), fill=False, ec="white", ls="--", lw=1.2))
        look = {"ls": "", "clip_on": False, "zorder": 3}
        axis.plot(*np.transpose(training), marker="o", color="white", mec=INK, ms=7, **look)
        axis.plot(*np.transpose(test), marker="D", color=COLOURS[1], mec="white", ms=8, **look)
        axis.set(xlabel=labels[0], ylabel=labels[1])
        axis.grid(False)
        _finish(figure.colorbar(mesh, ax=axis, label=labels[2]))

    return illustrate(draw, alt, 5.6, 3.6)


def _finish(bar: Colorbar):
    plain_ticks(bar.ax.yaxis)
    bar.ax.yaxis.set_minor_locator(NullLocator())
    bar.outline.set_visible(False)


def _hull(points):
    points = np.asarray(points, dtype=float)
    return points[ConvexHull(points).vertices]


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
    """Panels of rows, each with a point and an interval for every series."""
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
