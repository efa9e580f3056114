"""The book's figures: data in, `Illustration` out. No plot detail lives in a chapter."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle

from ddlib._check import finite_array
from ddlib.analysis import decompose
from ddlib.dynamics import Arm
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.learning import Weights

JOINTS = ("shoulder", "elbow")
"""Names of joint 0 and joint 1."""


def curves(
    x,
    panels: Mapping[str, Mapping[str, np.ndarray]],
    x_label: str,
    alt: str,
    *,
    columns: int = 1,
    height: float = 2.1,
    x_log=False,
    y_log=False,
) -> Illustration:
    """Curves over a common axis, one panel below (or beside) the other.

    Parameters
    ----------
    x : array_like, shape (points,)
        The common axis.
    panels : mapping
        ``{y label: {curve name: values (points,)}}``. A value may also be a pair
        ``(x, y)`` with an axis of its own.
    x_label, alt : str
        Label of the x axis; alternative text.
    columns : int
        Panels in one row.
    height : float
        Height of a panel, inches.
    x_log, y_log : bool
        Logarithmic axes.
    """  # fmt: skip
    rows = -(-len(panels) // columns)
    names = [tuple(named) for named in panels.values()]
    above = len(names[0]) > 1 and len(set(names)) == 1  # where no curve can run through it
    look = {name: k for k, name in enumerate(dict.fromkeys(sum(names, ())))}

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
        for axis, (label, named) in zip(axes, panels.items()):
            for name, y in named.items():
                x_k, y_k = y if isinstance(y, tuple) else (x, y)
                k = look[name]  # the same curve looks the same in every panel
                dash = DASHES[k % len(DASHES)]
                axis.plot(x_k, y_k, color=COLOURS[k % len(COLOURS)], ls=dash, label=name)
            axis.set_ylabel(check_label(label))
            if x_log:
                axis.set_xscale("log")
                plain_ticks(axis.xaxis)
            if y_log:
                axis.set_yscale("log")
                plain_ticks(axis.yaxis)
            if len(named) > 1 and not above:
                axis.legend(loc="best", ncols=2 if len(named) > 3 else 1)
        if above:
            legend_above(figure, *axes[0].get_legend_handles_labels())
        for axis in axes[max(len(panels) - columns, 0) : len(panels)]:
            axis.set_xlabel(check_label(x_label))
        for axis in axes[len(panels) :]:
            axis.remove()

    return illustrate(draw, alt, 7.0, height * rows + 0.4)


def arm_sketch(arm: Arm, q) -> Illustration:
    """The arm seen from above at joint angles `q` (rad, shape (2,)), with its angles named."""
    q = finite_array("q", q, 2)
    (ex, ey), (hx, hy) = arm.forward_kinematics(q)

    def draw(figure: Figure):
        axis = figure.subplots()
        l1 = arm.lengths[0]
        axis.plot([0, 1.25 * l1], [0, 0], color=FAINT, ls=":")
        reach = 1.55
        axis.plot([ex, ex * reach], [ey, ey * reach], color=FAINT, ls=":")
        axis.plot([0, ex], [0, ey], color=COLOURS[0], lw=9, solid_capstyle="round", alpha=0.85)
        axis.plot([ex, hx], [ey, hy], color=COLOURS[1], lw=7, solid_capstyle="round", alpha=0.85)
        for x, y in ((0, 0), (ex, ey)):
            axis.add_patch(Circle((x, y), 0.022, facecolor="white", edgecolor=INK, zorder=3))
        for centre, start, angle, radius, name in (
            ((0, 0), 0.0, q[0], 0.20, "$q_1$"),
            ((ex, ey), q[0], q[1], 0.15, "$q_2$"),
        ):
            arc = np.linspace(start, start + angle, 40)
            x, y = centre[0] + radius * np.cos(arc), centre[1] + radius * np.sin(arc)
            axis.plot(x, y, color=INK, lw=1)
            middle = start + angle / 2
            axis.text(
                centre[0] + 1.3 * radius * np.cos(middle),
                centre[1] + 1.3 * radius * np.sin(middle),
                name, ha="center", va="center", fontsize=12,
            )  # fmt: skip
        axis.text(ex * 0.62 - 0.04, ey * 0.62 + 0.05, "link 1", ha="right")
        axis.text((ex + hx) / 2 - 0.05, (ey + hy) / 2 + 0.03, "link 2", ha="right")
        axis.text(0.02, -0.07, "shoulder", ha="left")
        axis.text(ex - 0.05, ey + 0.03, "elbow", ha="right")
        axis.text(hx + 0.03, hy + 0.02, "hand", ha="left")
        axis.set_aspect("equal")
        axis.margins(0.1)
        axis.axis("off")

    alt = (
        f"The arm from above: link 1 turned by q1 = {np.rad2deg(q[0]):.0f} degrees from the "
        f"x axis, link 2 by q2 = {np.rad2deg(q[1]):.0f} degrees from link 1's direction."
    )
    return illustrate(draw, alt, 4.6, 3.0)


def extents_square(training, test, extra=None) -> Illustration:
    """The square of extents with the training and test trajectories and their hull.

    Parameters
    ----------
    training, test : array_like, shapes (runs, 2) and (2,)
        Extents of shoulder and elbow, degrees.
    extra : array_like, shape (n, 2), optional
        Further members of the family.
    """
    from scipy.spatial import ConvexHull

    training, test = finite_array("training", training, 2), finite_array("test", test, 2)
    hull = training[ConvexHull(training).vertices]

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.add_patch(Rectangle((0, 0), 45, 45, fill=False, edgecolor=INK, lw=0.8))
        shade = Polygon(hull, facecolor=COLOURS[0], alpha=0.18, edgecolor="none")
        axis.add_patch(shade)
        if extra is not None:
            axis.plot(*np.asarray(extra).T, ".", color=FAINT, ms=4, label="random members")
        axis.plot(*training.T, "o", color=COLOURS[0], ms=8, label="training", clip_on=False)
        axis.plot(*test, "D", color=COLOURS[1], ms=8, label="test", clip_on=False)
        for number, (x, y) in enumerate([*training, test], 1):
            axis.annotate(str(number), (x, y), (7, 5), textcoords="offset points")
        axis.set(xlabel="shoulder extent, degrees", ylabel="elbow extent, degrees")
        axis.set(xlim=(-2, 50), ylim=(-2, 50), aspect="equal", xticks=range(0, 46, 15))
        axis.set_yticks(range(0, 46, 15))
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    alt = (
        "Square of extents from 0 to 45 degrees for shoulder and elbow with five training "
        f"trajectories and test trajectory 6 at {test[0]:g} and {test[1]:g} degrees; the convex "
        "hull of the training trajectories is shaded."
    )
    return illustrate(draw, alt, 5.4, 3.6)


def network_diagram(weights: Weights) -> Illustration:
    """Figure 3-1: the network's layers and which of them are connected."""
    hidden = weights.hidden_weights.shape[-3]
    joints, width, outputs = 2, weights.width, weights.output_bias.shape[-1]

    def row(axis, y, n, x0, x1, colour):
        """Draw `n` units (at most nine, dots between) and return their places."""
        shown = min(n, 9)
        places = np.linspace(x0, x1, shown)
        middle = {shown // 2} if n > shown else set()
        for k, x in enumerate(places):
            if k in middle:
                axis.text(x, y, "…", ha="center", va="center", fontsize=14)
            else:
                axis.plot(x, y, "o", ms=11, mfc=colour, mec=INK, mew=0.8, zorder=3)
        return [x for k, x in enumerate(places) if k not in middle]

    def draw(figure: Figure):
        axis = figure.subplots()
        inputs = [row(axis, 0, width, 5.2 * j, 5.2 * j + 4.2, COLOURS[j]) for j in range(joints)]
        middle = row(axis, 1.25, hidden, 1.2, 6.4, "#bbbbbb")
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
            text = f"{JOINTS[j]} positions\n{width} samples"
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


def rmss_by_window(table: Mapping[str, Mapping[int, np.ndarray]], printed: Mapping) -> Illustration:
    """Table 4-1 as a picture: every network's error, the medians and the printed values.

    Parameters
    ----------
    table : mapping
        ``{"training" or "test": {window: errors (members,)}}``.
    printed : mapping
        ``{"training" or "test": {window: value}}``.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(table), sharey=True, squeeze=False)[0]
        for k, (axis, (name, columns)) in enumerate(zip(axes, table.items())):
            for place, values in enumerate(columns.values()):
                spread = np.linspace(-0.16, 0.16, len(values))
                axis.plot(place + spread, np.sort(values), ".", color=COLOURS[k], ms=4, alpha=0.7)
                axis.plot([place - 0.25, place + 0.25], [np.median(values)] * 2, color=INK, lw=2)
            marks = [printed[name][w] for w in columns]
            axis.plot(range(len(columns)), marks, "D", mfc="none", mec=COLOURS[3], ms=9, mew=1.8)
            axis.set_xticks(range(len(columns)), [str(w) for w in columns])
            axis.set(xlabel="window, samples", title=name, yscale="log")
        axes[0].set_ylabel("RMSS")

    alt = "RMSS of every network by window size; medians as bars, printed values as diamonds. "
    for name, columns in table.items():
        medians = ", ".join(f"{w}: {np.median(v):.3f}" for w, v in columns.items())
        alt += f"Median {name} error {medians}. "
    return illustrate(draw, alt.strip(), 7.0, 3.1)


def overlay(
    t, measured, predicted: Mapping[str, np.ndarray], joint: str = "shoulder"
) -> Illustration:
    """Figure 4-1: measured torque (fine) under the networks' (bold), one panel each.

    Parameters
    ----------
    t : array_like, shape (time,)
        Times, s.
    measured : array_like, shape (time,)
        Measured torque, N m.
    predicted : mapping
        ``{title: torque (time,)}``.
    joint : str
        Name for the axis.
    """

    def draw(figure: Figure):
        axes = figure.subplots(len(predicted), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, torque) in zip(axes, predicted.items()):
            axis.plot(t, torque, color=COLOURS[1], lw=2.6, alpha=0.85, label="network")
            axis.plot(t, measured, color=INK, lw=0.8, label="measured")
            axis.set_title(title)
            axis.set_ylabel("torque, N m")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
        axes[-1].set_xlabel("time, s")

    worst = max(np.sqrt(np.mean((np.asarray(p) - measured) ** 2)) for p in predicted.values())
    alt = (
        f"Measured {joint} torque on the test trajectory with the torque of networks "
        f"({', '.join(predicted)}) laid over it; largest root mean square difference "
        f"{worst:.2f} N m."
    )
    return illustrate(draw, alt, 7.0, 1.7 * len(predicted) + 0.4)


def _dots(axis: Axes, values, x0, y0, dx, dy, largest):
    """Rows of squares, white for positive and black for negative, area proportional to size."""
    values = np.atleast_2d(values)
    for (row, column), value in np.ndenumerate(values):
        side = np.sqrt(min(abs(value) / largest, 1.0)) * min(abs(dx), abs(dy))
        x, y = x0 + column * dx, y0 + row * dy
        colour = "#ffffff" if value > 0 else "#000000"
        square = Rectangle((x - side / 2, y - side / 2), side, side, facecolor=colour, lw=0)
        axis.add_patch(square)


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
    largest = float(weights.largest)
    if not 0 < largest < np.inf:
        raise ValueError(f"weights must be finite and not all zero, got {largest:g} as largest")
    hidden, width = len(weights.hidden_bias), weights.width
    columns, unit_width, unit_height = 2, width + 3.0, 7.0
    rows = -(-hidden // columns)

    def blob(axis, column, row, bias, top, window):
        x, y = column * (unit_width + 1.5), -row * (unit_height + 1.0)
        box = Rectangle((x, y), unit_width, -unit_height, facecolor="#8c8c8c", lw=0)
        axis.add_patch(box)
        _dots(axis, bias, x + 1.6, y - 1.4, 1, -1, largest)
        _dots(axis, top, x + unit_width - 0.5 - np.size(top), y - 1.4, 1, -1, largest)
        _dots(axis, window, x + 2.0, y - 4.4, 1, -1.4, largest)

    def draw(figure: Figure):
        axis = figure.subplots()
        for k in range(len(weights.output_bias)):
            blob(axis, k, 0, weights.output_bias[k], weights.output_weights[k],
                 weights.skip_weights[k])  # fmt: skip
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


def share_map(shares, names, classes) -> Illustration:
    """Every filter as a point: share of velocity against share of acceleration.

    Parameters
    ----------
    shares : array_like, shape (filters, 5)
        From `ddlib.analysis.filters.shares`.
    names : array_like of str, shape (filters,)
        Class of each filter.
    classes : sequence of str
        Classes in the order of the legend.
    """
    shares, names = finite_array("shares", shares, 5), np.asarray(names)
    markers = "os^DvPx"

    def draw(figure: Figure):
        axis = figure.subplots()
        for k, name in enumerate(classes):
            points = shares[names == name]
            if len(points):
                label = f"{name} ({len(points)})"
                axis.plot(points[:, 1], points[:, 2], markers[k], ms=4.5, mew=1, ls="none",
                          color=(*COLOURS, FAINT)[k], alpha=0.8, label=label)  # fmt: skip
        axis.set(xlabel="share of velocity", ylabel="share of acceleration")
        axis.set(xlim=(-0.03, 1.03), ylim=(-0.03, 1.03), aspect="equal")
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))

    counts = ", ".join(
        f"{np.sum(names == name)} {name}" for name in classes if (names == name).any()
    )
    return illustrate(
        draw, f"Filters by their share of velocity and acceleration: {counts}.", 6.4, 3.6
    )
