"""Figures of the chapter on learning in the loop: errors trial by trial, and motion by motion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from ddlib._check import positive
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)

MARKERS = "os^DvPX"

PLAIN = FuncFormatter(lambda value, place: f"{value:g}")


def by_trial(
    panels: Mapping[str, Mapping[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    change: tuple[float, str] | None = None,
    x_log: bool = False,
) -> Illustration:
    """Errors of learners over trials, or over a rate: medians, and the middle half of the seeds.

    Parameters
    ----------
    panels : mapping
        ``{title: {learner: (x, errors)}}`` with errors of shape (points, seeds), above 0. The
        first learner of each panel is in the page's ink: what the others are compared with. A
        learner of the same name looks the same in every panel.
    labels : tuple of str
        Of the horizontal and the vertical axis; the latter is logarithmic.
    alt : str
        Alternative text.
    change : tuple, optional
        Where a dashed line stands, and what is said beside it.
    x_log : bool
        Whether the horizontal axis is logarithmic, too.

    Raises
    ------
    ValueError
        If there is no panel, or values are not positive or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for named in panels.values():
        for name, (x, errors) in named.items():
            positive(f"errors of {name!r}", errors, f"({len(x)}, seeds)")

    first = {next(iter(named)) for named in panels.values()}
    names = dict.fromkeys(n for named in panels.values() for n in named if n not in first)
    looks = dict(zip(names, zip(COLOURS, MARKERS)))

    def draw(figure: Figure):
        axes = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, named) in zip(axes, panels.items()):
            axis.set(yscale="log", xscale="log" if x_log else "linear")
            axis.set_title(title, loc="left")
            for name, (x, errors) in named.items():
                colour, marker = looks.get(name, (INK, None))
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                axis.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
                look = {"marker": marker, "ms": 4} if marker else {"ls": "--"}
                axis.plot(x, middle, color=colour, lw=1.6, label=name, **look)
            if change:
                axis.axvline(change[0], color=FAINT, ls=":", lw=1.2)
                axis.annotate(
                    change[1], (change[0], 0.97), xycoords=("data", "axes fraction"), fontsize=8,
                    xytext=(3, 0), textcoords="offset points", va="top", color=FAINT,
                )  # fmt: skip
            axis.legend(
                loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, labelcolor="linecolor"
            )
            axis.set_ylabel(check_label(labels[1]))
            axis.yaxis.set_major_formatter(PLAIN)
        axes[-1].xaxis.set_major_formatter(PLAIN)
        if not x_log:
            axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
        axes[-1].set_xlabel(check_label(labels[0]))

    return illustrate(draw, alt, 6.4, 2.5 * len(panels) + 0.4)


def by_motion(
    motions: Mapping[str, Mapping[str, np.ndarray]], label: str, alt: str
) -> Illustration:
    """Errors of learners on several motions, over that of the feedback alone, a row each.

    Parameters
    ----------
    motions : mapping
        ``{motion: {learner: ratios (seeds,)}}``, above 0; the same learners for each motion. A
        mark is the median, a bar reaches from the least to the largest.
    label : str
        Of the horizontal, logarithmic axis.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no motion, or values are not positive.
    """
    if not motions:
        raise ValueError("motions must hold one motion or more, got none")
    for motion, named in motions.items():
        for name, values in named.items():
            positive(f"ratios of {name!r} on {motion!r}", values, "(seeds,)")

    def draw(figure: Figure):
        axis = figure.subplots()
        learners = list(next(iter(motions.values())))
        for row, named in enumerate(motions.values()):
            for k, name in enumerate(learners):
                colour, place = (
                    COLOURS[k % len(COLOURS)],
                    row + 0.13 * (k - len(learners) / 2 + 0.5),
                )
                values = np.asarray(named[name])
                axis.plot(
                    [values.min(), values.max()], [place] * 2, color=colour, lw=1.2, alpha=0.6
                )
                axis.plot(
                    np.median(values), place, MARKERS[k % len(MARKERS)], color=colour, ms=4.5,
                    label=None if row else name,
                )  # fmt: skip
        axis.axvline(1.0, color=INK, ls="--", lw=1.0)
        axis.set(xscale="log", xlabel=check_label(label))
        axis.xaxis.set_major_formatter(PLAIN)
        axis.set_yticks(range(len(motions)), motions)
        axis.set_ylim(len(motions) - 0.5, -0.5)
        axis.grid(visible=False, axis="y")
        legend_above(figure, *axis.get_legend_handles_labels())

    return illustrate(draw, alt, 6.0, 0.75 * len(motions) + 1.1)
