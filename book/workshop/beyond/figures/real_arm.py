"""Figures of the chapter on a real arm: friction joint by joint, gains beside their nulls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from ddlib._check import shaped
from ddlib.figures.style import COLOURS, FAINT, INK, Illustration, check_label, illustrate

JOINTS = 6
"""Number of joints."""


def friction_by_joint(
    panels: Mapping[str, tuple], labels: tuple[str, str], alt: str
) -> Illustration:
    """Current that friction takes over the speed, one panel a joint: as found and as identified.

    Parameters
    ----------
    panels : mapping
        ``{title: (speed, current, middle, median, line)}``: a cloud of cases, shape (cases,), the
        medians of groups of them, shape (groups,), and the slope and the jump at rest of the
        identified friction.
    labels : tuple of str
        Of the horizontal and the vertical axis.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no panel, or shapes do not fit.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for title, (speed, current, middle, median, _) in panels.items():
        for first, second, length in ((speed, current, "cases"), (middle, median, "groups")):
            first = shaped(f"speed of {title!r}", first, f"({length},)")
            shaped(f"current of {title!r}", second, first.shape)
    columns = min(2, len(panels))

    def draw(figure: Figure):
        axes = figure.subplots(-(-len(panels) // columns), columns, squeeze=False).ravel()
        for axis, (title, (speed, current, middle, median, line)) in zip(axes, panels.items()):
            _dots(axis, speed, current, 42, ec=FAINT, lw=1.6, alpha=0.5)
            for side in (-1, 1):
                end = side * np.abs(speed).max()
                far = line[0] * end + side * line[1]
                axis.plot([0, end], [side * line[1], far], color=COLOURS[1], ls="--", lw=1.8)
            _dots(axis, middle, median, 1000, ec=COLOURS[0], lw=3.6, zorder=3)
            axis.set_title(title)
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(check_label(labels[0]), fontsize=9.5)
        figure.supylabel(check_label(labels[1]), fontsize=9.5)

    return illustrate(draw, alt, 5.4, 1.75 * -(-len(panels) // columns) + 0.3)


def _dots(axis: Axes, x, y, cells: int, **look) -> None:
    """Points as one path, which weighs little; of several in a cell of the plane, one."""
    place = np.column_stack([x, y])
    step = np.ptp(place, axis=0) / cells
    _, first = np.unique(np.round(place / np.where(step > 0, step, 1)), axis=0, return_index=True)
    ends = np.repeat(place[first], 2, axis=0)  # strokes of no length, with round ends
    path = Path(ends, np.tile([Path.MOVETO, Path.LINETO], len(first)))
    path.should_simplify = False
    axis.add_patch(PathPatch(path, fill=False, capstyle="round", **look))
    axis.update_datalim(place)
    axis.autoscale_view()


def gains_by_joint(panels: Mapping[str, tuple], label: str, alt: str) -> Illustration:
    """Gains of networks over the arm's, joint by joint, beside those on unrelated currents.

    Parameters
    ----------
    panels : mapping
        ``{title: (real, null)}``, both of shape (networks, 6), as multiples of the identified
        value: 1 is right. Every network on the real currents is a dot; a bar holds the middle
        nine tenths of the others.
    label : str
        Of the vertical axes.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no panel, or values are not finite or of another shape.
    """
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for title, pair in panels.items():
        for values in pair:
            shaped(f"gains of {title!r}", values, f"(networks, {JOINTS})")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        place = np.arange(1, JOINTS + 1)
        for axis, (title, (real, null)) in zip(axes, panels.items()):
            low, high = np.percentile(null, (5, 95), axis=0)
            axis.bar(
                place, high - low, 0.55, low, color=FAINT, alpha=0.4, label="unrelated currents"
            )
            axis.axhline(1, color=INK, ls="--", lw=1, label="as identified")
            for k, gains in enumerate(np.asarray(real)):
                x = place + 0.3 * (k / max(len(real) - 1, 1) - 0.5)
                name = "real currents" if k == 0 else None
                axis.plot(x, gains, "o", color=COLOURS[0], ms=3.5, mew=0, alpha=0.8, label=name)
            axis.set(title=title, xticks=place)
            axis.grid(visible=False, axis="x")
        axes[0].set_ylabel(check_label(label))
        figure.supxlabel("joint", fontsize=9.5)
        handles = axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper left", ncols=3)

    return illustrate(draw, alt, 5.4, 3.0)
