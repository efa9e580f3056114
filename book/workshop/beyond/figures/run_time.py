"""Figures of the chapter on torques at run time: what predicts the end-point error."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ddlib._check import positive
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)

MARKERS = "osD^v"


def against(
    panels: Mapping[str, Mapping[str, tuple]],
    label: str,
    alt: str,
    *,
    equal: tuple[str, ...] = (),
    height: float = 2.9,
) -> Illustration:
    """A quantity over its predictors, a panel for each, both axes logarithmic.

    Parameters
    ----------
    panels : mapping
        ``{x label: {group: (x, y)}}``, both of shape (members,), above 0: a dot for each member.
        A group of the same name looks the same in every panel.
    label : str
        Of the vertical axis.
    alt : str
        Alternative text.
    equal : tuple of str
        Panels whose predictor has the unit of the quantity: they get a line of equal values.
    height : float
        Of the figure, inches.

    Raises
    ------
    ValueError
        If there is no panel, a value is not above 0, or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for title, groups in panels.items():
        for name, (x, y) in groups.items():
            first = positive(f"x of {name!r} in {title!r}", x, "(members,)")
            positive(f"y of {name!r} in {title!r}", y, first.shape)
    names = list(dict.fromkeys(name for groups in panels.values() for name in groups))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        handles = {}
        for axis, (title, groups) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            for name, (x, y) in groups.items():
                k = names.index(name)
                (handles[name],) = axis.plot(
                    x, y, MARKERS[k % len(MARKERS)], color=COLOURS[k % len(COLOURS)], ms=4, mew=0,
                    alpha=0.8,
                )  # fmt: skip
            if title in equal:
                both = np.concatenate([np.ravel(values) for values in groups.values()])
                ends = [both.min(), both.max()]
                axis.plot(ends, ends, color=FAINT, ls="--", lw=1)
            axis.set_xlabel(check_label(title))
            for each in (axis.xaxis, axis.yaxis):
                plain_ticks(each)
        axes[0].set_ylabel(check_label(label))
        legend_above(figure, [handles[name] for name in names], names)

    return illustrate(draw, alt, 7.0, height)
