"""Figures of the chapter *Why the filters are smooth*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import positive, shaped
from ddlib.figures.style import (
    COLOURS,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)


def predicted_curves(
    x,
    curves: Mapping[str, tuple],
    clouds: Mapping[str, tuple],
    labels: tuple[str, str, str, str],
    alt: str,
) -> Illustration:
    """Courses as predicted (dashed) and measured (solid), and all their ends side by side."""
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
