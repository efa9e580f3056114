"""Errors of rivals against what they cost: a panel for each family, the paper's network in all."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import number, positive
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)

MARKERS = "os^Dv"
WIDTH = 6.4
"""Of the figure, inches: narrower than most, so that labels stay legible on a phone."""


def costs(
    panels: Mapping[str, Mapping[str, tuple]],
    reference: tuple[str, tuple],
    floor: float,
    labels: tuple[str, str],
    alt: str,
) -> Illustration:
    """Errors over a cost, both logarithmic: a panel for each family, one rival in all of them.

    Parameters
    ----------
    panels : mapping
        ``{family: {rival: (cost, training, test)}}``: cost of shape (sizes,), errors of shape
        (sizes, days). Bold lines with markers are medians of the test errors, bars reach from
        the least to the largest; dashed lines are medians of the training errors.
    reference : tuple
        Name and curve of the rival that every panel shows, in the page's ink.
    floor : float
        Error that is noise alone: a dotted line.
    labels : tuple of str
        Of the cost and of the error.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no panel, or values are not positive or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one family or more, got none")
    number("floor", floor, 0.0, open_low=True)
    for named in (dict([reference]), *panels.values()):
        for name, (cost, *errors) in named.items():
            sizes = len(positive(f"cost of {name!r}", cost, "(sizes,)"))
            for values in errors:
                positive(f"errors of {name!r}", values, f"({sizes}, days)")
    rows = -(-len(panels) // 2)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False).ravel()
        for axis, (family, named) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            axis.set_title(family)
            axis.axhline(floor, color=FAINT, ls=":", lw=1.2)
            axis.axhline(1.0, color=FAINT, lw=0.8)
            _curve(axis, reference[1], INK, "", 1.0)
            ends = []
            for k, (name, curve) in enumerate(named.items()):
                colour = COLOURS[k % len(COLOURS)]
                _curve(axis, curve, colour, MARKERS[k % len(MARKERS)], 1.8)
                ends.append((curve[0][-1], np.median(curve[2][-1]), name, colour))
            _label(axis, ends)
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(check_label(labels[0]), fontsize=9.5)
        figure.supylabel(check_label(labels[1]), fontsize=9.5)
        looks = {
            "test": {"color": FAINT, "lw": 1.8, "marker": "o", "ms": 4},
            "training": {"color": FAINT, "lw": 1.0, "ls": "--"},
            reference[0]: {"color": INK, "lw": 1.0},
            "noise": {"color": FAINT, "ls": ":", "lw": 1.2},
        }
        legend_above(figure, [Line2D([], [], **look) for look in looks.values()], list(looks))

    return illustrate(draw, alt, WIDTH, 2.1 * rows + 0.6)


def _curve(axis, curve, colour, marker, width) -> None:
    cost, training, test = map(np.asarray, curve)
    order = np.argsort(cost)
    cost, training, test = cost[order], training[order], test[order]
    axis.plot(cost, np.median(training, 1), color=colour, ls="--", lw=0.6 * width)
    axis.plot(cost, np.median(test, 1), color=colour, lw=width, marker=marker, ms=4)
    axis.vlines(cost, test.min(1), test.max(1), color=colour, lw=0.8 * width, alpha=0.5)


def _label(axis, ends, gap: float = 0.17) -> None:
    """Names at the ends of the curves, pushed apart along the logarithm of the error."""
    places = []
    for x, y, name, colour in sorted(ends, key=lambda end: end[1]):
        low = np.log10(y) if not places else max(np.log10(y), places[-1] + gap)
        places.append(low)
        axis.annotate(
            name, (x, y), xytext=(x, 10**low), textcoords="data", color=colour, fontsize=8,
            va="center", ha="right" if axis.get_xlim()[1] < 30 * x else "left",
        )  # fmt: skip
