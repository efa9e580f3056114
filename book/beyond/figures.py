"""What learnt one trajectory: its error all over the square of extents, a map for each rival."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from ddlib._check import positive, shaped
from ddlib.figures import COLOUR_MAP, COLOURS, Illustration, illustrate, plain_ticks


def maps(
    edge,
    errors: dict[str, np.ndarray],
    labels: tuple[str, str, str],
    alt: str,
    *,
    mark=None,  # a place to mark
) -> Illustration:
    """The same square once for each rival; the errors' first axis, all above 0, goes right."""
    edge = shaped("edge", edge, "(places,)")
    if not errors:
        raise ValueError("errors must hold a panel or more, got none")
    for title, values in errors.items():
        positive(f"errors of {title!r}", values, (edge.size,) * 2)
    rows = -(-len(errors) // 2)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
        together = np.concatenate([np.ravel(v) for v in errors.values()])
        norm = LogNorm(together.min(), together.max())
        for axis, (title, values) in zip(axes.ravel(), errors.items()):
            mesh = axis.pcolormesh(edge, edge, np.transpose(values), norm=norm, cmap=COLOUR_MAP,
                                   shading="nearest", linewidth=0.2, edgecolor="face")  # fmt: skip
            if mark is not None:
                axis.plot(*mark, "D", color=COLOURS[1], mec="white", ms=7)
            axis.set_title(title)
            axis.set_aspect("equal")
            axis.grid(False)
        for axis in axes[-1]:
            axis.set_xlabel(labels[0])
        for axis in axes[:, 0]:
            axis.set_ylabel(labels[1])
        for axis in axes.ravel()[len(errors) :]:
            axis.remove()
        bar = figure.colorbar(mesh, ax=figure.axes, label=labels[2])
        plain_ticks(bar.ax.yaxis)
        bar.ax.yaxis.set_minor_locator(NullLocator())
        bar.outline.set_visible(False)

    return illustrate(draw, alt, 6.6, 2.7 * rows + 0.4)
