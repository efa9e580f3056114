"""Figures that are maps: an error over a plane, Table 4-1 under set-ups, rows of intervals."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from ddlib._check import finite_array, mapping
from ddlib.figures.style import (
    COLOURS,
    INK,
    TONES,
    Illustration,
    illustrate,
    legend_above,
    plain_ticks,
)

SIGNS = ("o", "s", "^", "v", "P", "X")
"""Shapes of points that go with the colours."""

COLOUR_MAP = matplotlib.colormaps["viridis"].resampled(32)
"""Few enough steps that its bar is drawn and not an embedded picture, which pages forbid."""


def rmss_by_window(
    table: Mapping[str, Mapping[str, Mapping[int, np.ndarray]]], printed: Mapping
) -> Illustration:
    """Table 4-1 as a picture: every network's error under each set-up, and the printed values.

    Parameters
    ----------
    table : mapping
        ``{set-up: {column: {window: errors (members,)}}}``, errors above 0.
    printed : mapping
        ``{column: {window: value}}``.

    Raises
    ------
    ValueError
        If an error is not above 0.
    """
    mapping("table", table)
    mapping("printed", printed)
    for name, columns in table.items():
        mapping("table", columns)
        for cells in columns.values():
            for values in cells.values():
                if not (finite_array(name, values) > 0).all():
                    raise ValueError(f"errors of {name!r} must be above 0, got {min(values)}")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(printed), sharey=True, squeeze=False)[0]
        shift = 0.8 / len(table)
        for axis, (column, marks) in zip(axes, printed.items()):
            for k, (name, columns) in enumerate(table.items()):
                for place, values in enumerate(columns[column].values()):
                    middle = place + (k - (len(table) - 1) / 2) * shift
                    across = middle + np.linspace(-0.35, 0.35, len(values)) * shift
                    axis.plot(across, np.sort(values), SIGNS[k], color=COLOURS[k], ms=3.2,
                              alpha=0.75, mew=0, label=name)  # fmt: skip
                    axis.plot(middle + np.array([-0.42, 0.42]) * shift, [np.median(values)] * 2,
                              color=INK, lw=2)  # fmt: skip
            for place, value in enumerate(marks.values()):
                axis.plot([place - 0.46, place + 0.46], [value] * 2, color=TONES["wanted"], lw=1.8,
                          ls="--", label="printed")  # fmt: skip
            axis.set_xticks(range(len(marks)), [str(w) for w in marks])
            axis.set(xlabel="window, samples", title=column, yscale="log")
            axis.grid(False, axis="x")
            plain_ticks(axis.yaxis)
        axes[0].set_ylabel("RMSS")
        handles, names = axes[0].get_legend_handles_labels()
        first = dict(zip(names, handles))
        legend_above(figure, list(first.values()), list(first))

    alt = "RMSS of every network by window; medians as bars, printed values as dashed lines. "
    for name, columns in table.items():
        for column, cells in columns.items():
            medians = ", ".join(f"{w}: {np.median(v):.3f}" for w, v in cells.items())
            alt += f"{name}, median {column} error {medians}. "
    return illustrate(draw, alt.strip(), 7.0, 3.7)
