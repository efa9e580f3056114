"""Figures of Part IV that several chapters draw: maps of errors over the square of extents.

Extents are how far each joint moves in a pick-and-place motion; the square has all pairs of them.
"""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from ddlib._check import positive, shaped
from ddlib.figures import COLOUR_MAP, COLOURS, Illustration, illustrate, plain_ticks


def maps(
    edge,  # values along both axes of the square
    errors: dict[str, np.ndarray],  # of each map, by its title, shape (places, places)
    labels: tuple[str, str, str],  # of the axis to the right, the axis upwards, and the colours
    alt: str,
    *,
    mark=None,  # a point (right, up) of the square, marked in every map
) -> Illustration:
    """The same square once for each title, in logarithmic colours that all maps share.

    The first axis of `errors` goes right, the second up; errors are above 0.
    """
    edge = shaped("edge", edge, "(places,)")
    if not errors:
        raise ValueError("errors must hold a panel or more, got none")
    for title, values in errors.items():
        positive(f"errors of {title!r}", values, (edge.size,) * 2)
    rows = -(-len(errors) // 2)  # of two maps, rounded up

    def draw(figure: Figure):
        axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
        all_errors = np.concatenate([np.ravel(values) for values in errors.values()])
        norm = LogNorm(all_errors.min(), all_errors.max())
        for axis, (title, values) in zip(axes.ravel(), errors.items()):
            mesh = axis.pcolormesh(edge, edge, np.transpose(values), norm=norm, cmap=COLOUR_MAP,
                                   shading="nearest", linewidth=0.2, edgecolor="face")  # fmt: skip
            if mark is not None:
                axis.plot(*mark, "D", color=COLOURS[0], mec="white", ms=7)
            axis.set_title(title)
            axis.set_aspect("equal")
            axis.grid(False)
        for axis in axes[-1]:
            axis.set_xlabel(labels[0])
        for axis in axes[:, 0]:
            axis.set_ylabel(labels[1])
        for axis in axes.ravel()[len(errors) :]:  # the place that an odd number leaves
            axis.remove()
        colour_bar = figure.colorbar(mesh, ax=figure.axes, label=labels[2])
        plain_ticks(colour_bar.ax.yaxis)
        colour_bar.ax.yaxis.set_minor_locator(NullLocator())
        colour_bar.outline.set_visible(False)

    return illustrate(draw, alt, 6.6, 2.7 * rows + 0.4)
