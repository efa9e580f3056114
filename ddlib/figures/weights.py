"""Figures of networks: their layout, their weights as Hinton diagrams and as filters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ddlib.analysis import decompose
from ddlib.figures.style import (
    COLOURS,
    FAINT,
    INK,
    JOINTS,
    Illustration,
    illustrate,
)
from ddlib.learning import Weights


def network_diagram(weights: Weights) -> Illustration:
    """Figure 3-1: the network's layers and which of them are connected."""
    hidden = weights.hidden_weights.shape[-3]
    joints, width, outputs = 2, weights.width, weights.output_bias.shape[-1]

    def row(axis, y, n, x0, x1, colour):
        """Draw `n` units (at most nine, dots between) and return their places."""
        size = min(11.0, 1.7 * axis.figure.get_figwidth())  # points; they never touch
        shown = min(n, 9)
        places = np.linspace(x0, x1, shown)
        middle = {shown // 2} if n > shown else set()
        for k, x in enumerate(places):
            if k in middle:
                axis.text(x, y, "…", ha="center", va="center", fontsize=14)
            else:
                axis.plot(x, y, "o", ms=size, mfc=colour, mec=INK, mew=0.8, zorder=3)
        return [x for k, x in enumerate(places) if k not in middle]

    def draw(figure: Figure):
        axis = figure.subplots()
        inputs = [row(axis, 0, width, 5.2 * j, 5.2 * j + 4.2, COLOURS[j]) for j in range(joints)]
        middle = row(axis, 1.25, hidden, 1.2, 6.4, FAINT)
        top = row(axis, 2.5, outputs, 8.6, 9.6, COLOURS[2])
        below = [x for places in inputs for x in places]
        for x0 in below:
            for x1 in middle:
                axis.plot([x0, x1], [0, 1.25], color=FAINT, lw=0.35, alpha=0.6, zorder=1)
            for x1 in top:
                axis.plot([x0, x1], [0, 2.5], color=COLOURS[3], lw=0.5, alpha=0.55, zorder=1)
        for x0 in middle:
            for x1 in top:
                axis.plot([x0, x1], [1.25, 2.5], color=INK, lw=0.6, alpha=0.7, zorder=1)
        for j in range(joints):
            text = f"{JOINTS[j]}:\n{width} positions"
            axis.text(5.2 * j + 2.1, -0.28, text, ha="center", va="top")
        axis.text(-0.2, 1.25, f"{hidden} hidden\nunits", ha="right", va="center")
        axis.text(9.1, 2.72, "torques: shoulder, elbow", ha="center", va="bottom")
        axis.text(9.75, 1.3, "direct\nweights", ha="left", va="center", color=COLOURS[3])
        axis.set(xlim=(-1.4, 10.8), ylim=(-0.9, 3.0))
        axis.axis("off")

    alt = (
        f"Network with {joints} times {width} inputs, {hidden} hidden units and {outputs} outputs: "
        "inputs are connected to hidden units and directly to the outputs, hidden units to outputs."
    )
    return illustrate(draw, alt, 7.0, 3.4)


def dots(axis: Axes, values, x0, y0, dx, dy, largest):
    """Rows of squares, white for positive and black for negative, area proportional to size.

    Parameters
    ----------
    axis : Axes
    values : array_like, shape (columns,) or (rows, columns)
    x0, y0, dx, dy : float
        Centre of the first square, steps to the next column and row.
    largest : float
        Magnitude whose square is as wide as the smaller step.
    """
    values = np.atleast_2d(values)
    for row, column in np.argwhere(values):
        value = values[row, column]
        side = np.sqrt(min(abs(value) / largest, 1.0)) * min(abs(dx), abs(dy))
        x, y = x0 + column * dx, y0 + row * dy
        colour = "#ffffff" if value > 0 else "#000000"
        square = Rectangle((x - side / 2, y - side / 2), side, side, facecolor=colour, lw=0)
        axis.add_patch(square)


def largest_weight(weights: Weights) -> float:
    """Largest magnitude; a ValueError if not all weights are finite, or all are zero."""
    largest = float(weights.largest)
    if not 0 < largest < np.inf:
        raise ValueError(f"weights must be finite and not all zero, got {largest:g} as largest")
    return largest


def hinton(weights: Weights) -> Illustration:
    """Figures 5-1 to 5-3: all weights of one network in the paper's recursive layout.

    Every grey blob is a unit: the outputs on top (shoulder left, elbow right), the hidden
    units below. Inside, the two bottom rows are the weights from the shoulder's and the
    elbow's window, time running to the right. On top: the weights to the two outputs
    (hidden units) or from the hidden units (output units), and the bias at the left.

    Parameters
    ----------
    weights : Weights
        One network.
    """
    if weights.hidden_bias.ndim != 1:
        raise ValueError("weights must be of one network: pick a member of the ensemble")
    largest = largest_weight(weights)
    hidden, width = len(weights.hidden_bias), weights.width
    columns, unit_width, unit_height = 2, width + 3.0, 7.0
    rows = -(-hidden // columns)

    def blob(axis, column, row, bias, top, window):
        x, y = column * (unit_width + 1.5), -row * (unit_height + 1.0)
        box = Rectangle((x, y), unit_width, -unit_height, facecolor="#8c8c8c", lw=0)
        axis.add_patch(box)
        dots(axis, bias, x + 1.6, y - 1.4, 1, -1, largest)
        dots(axis, top, x + unit_width - 0.5 - np.size(top), y - 1.4, 1, -1, largest)
        dots(axis, window, x + 2.0, y - 4.4, 1, -1.4, largest)

    def draw(figure: Figure):
        axis = figure.subplots()
        for k in range(len(weights.output_bias)):
            blob(axis, k, 0, weights.output_bias[k], weights.output_weights[k],
                 weights.direct_weights[k])  # fmt: skip
        for k in range(hidden):
            blob(axis, k % columns, 1.15 + k // columns, weights.hidden_bias[k],
                 weights.output_weights[:, k], weights.hidden_weights[k])  # fmt: skip
        axis.set(xlim=(-0.5, columns * (unit_width + 1.5) - 1.0), aspect="equal")
        axis.set_ylim(-(rows + 1.15) * (unit_height + 1.0) - 0.5, 0.8)
        axis.axis("off")

    alt = (
        f"Hinton diagram of a network with window {width}: two output units on top, {hidden} "
        f"hidden units below; white squares are positive, black negative weights, the largest "
        f"has magnitude {largest:.1f}."
    )
    total_width = columns * (unit_width + 1.5) - 0.5
    total_height = (rows + 1.15) * (unit_height + 1.0) + 1.3
    inches = 7.0 if width > 15 else 5.2
    return illustrate(draw, alt, inches, inches * total_height / total_width + 0.2)


def decomposition(functions: Mapping[str, np.ndarray], step: float) -> Illustration:
    """Figures 5-4 to 5-8: weight functions with their constant, even and odd parts.

    Parameters
    ----------
    functions : mapping
        ``{title: weight function (width,)}``.
    step : float
        Sampling period, s.
    """
    columns = min(len(functions), 2)
    rows = -(-len(functions) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        for axis, (title, f) in zip(axes, functions.items()):
            parts = decompose(f)
            half = len(f) // 2
            x = np.arange(-half, half + 1) * step * 1e3
            axis.plot(x, f, color=INK, lw=2.6, alpha=0.55, label="weights")
            axis.plot(x, parts.even, color=COLOURS[0], ls="-", lw=1.3, label="even")
            axis.plot(x, parts.odd, color=COLOURS[1], ls="--", lw=1.3, label="odd")
            axis.axhline(float(parts.constant[0]), color=COLOURS[2], ls=":", lw=1.3,
                         label="constant")  # fmt: skip
            axis.set_title(title)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=4)
        for axis in axes[len(functions) - columns : len(functions)]:
            axis.set_xlabel("time from the window's centre, ms")
        for axis in axes[::columns]:
            axis.set_ylabel("weight")
        for axis in axes[len(functions) :]:
            axis.remove()

    alt = "Weight functions over the window with their constant, even and odd parts: " + "; ".join(
        functions
    )
    return illustrate(draw, alt, 7.0, 2.3 * rows + 0.3)
