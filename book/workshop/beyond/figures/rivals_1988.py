"""What learnt one trajectory: its error all over the square of extents, a map for each rival."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from ddlib._check import shaped
from ddlib.figures.maps import COLOUR_MAP
from ddlib.figures.style import COLOURS, Illustration, illustrate, plain_ticks


def maps(
    edge,
    errors: Mapping[str, np.ndarray],
    labels: tuple[str, str, str],
    alt: str,
    *,
    mark=None,
    columns: int = 2,
) -> Illustration:
    """The same square once for each rival, with one scale of colours.

    Parameters
    ----------
    edge : array_like, shape (n,)
        Places along both axes, equally spaced.
    errors : mapping
        ``{title: values (n, n)}``, all above 0; the first axis goes to the right.
    labels : tuple of str
        Of the x axes, the y axes and the colours.
    alt : str
        Alternative text.
    mark : pair of float, optional
        A place to mark.
    columns : int
        Panels in a row.

    Raises
    ------
    ValueError
        If there is no panel, shapes do not fit or a value is not above 0.
    """
    edge = shaped("edge", edge, "(places,)")
    if not errors:
        raise ValueError("errors must hold a panel or more, got none")
    for title, values in errors.items():
        if not (shaped(f"errors of {title!r}", values, (edge.size,) * 2) > 0).all():
            raise ValueError(f"errors of {title!r} must be above 0, got {np.min(values):g}")
    rows = -(-len(errors) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
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
        for axis in axes.ravel()[len(errors) :]:
            axis.remove()
        for axis in axes[-1]:
            axis.set_xlabel(labels[0])
        for axis in axes[:, 0]:
            axis.set_ylabel(labels[1])
        bar = figure.colorbar(mesh, ax=axes, label=labels[2])
        plain_ticks(bar.ax.yaxis)
        bar.ax.yaxis.set_minor_locator(NullLocator())
        bar.outline.set_visible(False)

    return illustrate(draw, alt, 6.6, 2.7 * rows + 0.4)
