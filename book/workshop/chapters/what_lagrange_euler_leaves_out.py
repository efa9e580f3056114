"""Figures of the chapter *What Lagrange-Euler leaves out*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from ddlib._check import finite_array
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    JOINTS,
    NARROW,
    Illustration,
    illustrate,
)
from ddlib.tables import significant


def side_by_side(
    panels: Mapping[tuple[str, str], Mapping[str, tuple]],
    alt: str,
    height: float = 2.5,
    *,
    log: bool = False,
) -> Illustration:
    """Panels in one row, each with axes of its own."""
    shown = [name for panel in panels.values() if len(panel) > 1 for name in panel]
    look = {name: k for k, name in enumerate(dict.fromkeys(shown))}

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharex=log, sharey=log)[0]
        for axis, ((x_label, y_label), curves) in zip(axes, panels.items()):
            for name, (x, y) in curves.items():
                k = look.get(name, 0)
                style = dict(color=COLOURS[k % len(COLOURS)], ls=DASHES[k % len(DASHES)])
                axis.plot(x, y, label=name, **style)
            axis.set(xlabel=x_label, ylabel=y_label)
            if log:
                axis.set(xscale="log", yscale="log")
                axis.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
                for side in (axis.xaxis, axis.yaxis):
                    side.set_major_formatter("{x:g}")
                    side.set_minor_formatter(NullFormatter())
            else:
                axis.xaxis.set_major_locator(MaxNLocator(5))
            if len(curves) > 1:
                axis.legend(loc="best")

    return illustrate(draw, alt, 7.0, height)


def ranking(sizes: Mapping[str, np.ndarray]) -> Illustration:
    """Torques as bars on a logarithmic axis, largest first, one bar for each joint."""
    for name, size in sizes.items():
        if (finite_array(f"sizes[{name!r}]", size, 2) <= 0).any():
            raise ValueError(f"sizes must be positive, got {size} for {name!r}")
    order = sorted(sizes, key=lambda name: sizes[name][0], reverse=True)
    values = np.array([sizes[name] for name in order])
    places = np.arange(len(order))

    def draw(figure: Figure):
        axis = figure.subplots()
        slim = figure.get_figwidth() <= NARROW  # names above their bars, not beside them
        height = (0.56 if slim else 0.8) / 2
        low = 10.0 ** np.floor(np.log10(values.min()))
        for j, joint in enumerate(JOINTS):
            rows = places + (j - 0.5) * height
            look = dict(color=COLOURS[j], alpha=0.85, hatch="" if j == 0 else "///", lw=0)
            bars = axis.barh(rows, values[:, j] - low, height * 0.88, left=low, label=joint, **look)
            words = [significant(value, 2) for value in values[:, j]]
            axis.bar_label(bars, words, padding=3, fontsize=7.5, color=INK)
        axis.set_yticks(places, [""] * len(order) if slim else order)
        axis.set(xscale="log", xlim=(low, values.max() * 2.5), xlabel="torque, N m (RMS)")
        axis.set_ylim(len(order) - 0.4, -0.8 if slim else -0.6)
        for place, name in zip(places, order if slim else ()):
            axis.text(low * 1.03, place - 0.32, name, fontsize=8.5, color=INK, va="bottom")
        axis.grid(axis="y", visible=False)
        axis.tick_params(axis="y", length=0)
        axis.axhline(0.35 if slim else 0.5, color=FAINT, lw=0.8)
        axis.legend(loc="lower right")

    listed = "; ".join(
        f"{name} {' and '.join(significant(v, 2) for v in row)}" for name, row in zip(order, values)
    )
    alt = f"Bars of torque in N m for shoulder and elbow, largest first: {listed}."
    size = 7.0, 0.36 * len(order) + 0.9
    return illustrate(draw, alt, *size, narrow_height=0.46 * len(order) + 0.9)
