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
LOWEST, HIGHEST = 0.009, 20.0
"""Ends of the axis of errors: room for noise below, for the legends above."""

WIDTH = 5.2
"""Of the figure, inches: narrower than most, so that labels stay legible on a phone."""


def costs(
    panels: Mapping[str, Mapping[str, tuple]],
    reference: tuple[str, tuple],
    floor: float,
    labels: tuple[str, str],
    alt: str,
) -> Illustration:
    """Errors over a cost, both logarithmic: a panel for each family, one rival in all of them.

    Errors beyond `LOWEST` and `HIGHEST` are not in the picture.

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
            for k, (name, curve) in enumerate(named.items()):
                _curve(axis, curve, COLOURS[k % len(COLOURS)], MARKERS[k % len(MARKERS)], 1.8, name)
            axis.legend(
                loc="upper left", labelcolor="linecolor", fontsize=8, borderpad=0.1,
                labelspacing=0.2, handlelength=1.4, handletextpad=0.4, borderaxespad=0.1,
            )  # fmt: skip
            axis.set_ylim(LOWEST, HIGHEST)
            axis.set_yticks((0.01, 0.1, 1.0), ("0.01", "0.1", "1"))
            axis.minorticks_off()
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

    return illustrate(draw, alt, WIDTH, 2.9 * rows + 0.6)


def _curve(axis, curve, colour, marker, width, name="") -> None:
    cost, training, test = map(np.asarray, curve)
    order = np.argsort(cost)
    cost, training, test = cost[order], training[order], test[order]
    axis.plot(cost, np.median(training, 1), color=colour, ls="--", lw=0.6 * width)
    look = {"color": colour, "lw": width, "marker": marker, "ms": 4}
    axis.plot(cost, np.median(test, 1), **look, label=name or None)
    axis.vlines(cost, test.min(1), test.max(1), color=colour, lw=0.8 * width, alpha=0.5)
