"""Figures of networks: their layout, their weights as Hinton diagrams and as filters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from ddlib._check import finite_array, instance, number, one_of, series, shaped, texts
from ddlib.analysis import decompose
from ddlib.figures.style import (
    FAINT,
    INK,
    JOINTS,
    NARROW,
    ROLES,
    TONES,
    Illustration,
    illustrate,
    legend_above,
)
from ddlib.learning import Weights


def network_diagram(weights: Weights) -> Illustration:
    """Figure 3-1: the network's layers and which of them are connected."""
    instance("weights", weights, Weights)
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
        inputs = [
            row(axis, 0, width, 5.2 * j, 5.2 * j + 4.2, TONES[JOINTS[j]]) for j in range(joints)
        ]
        middle = row(axis, 1.25, hidden, 1.2, 6.4, TONES["network"])
        top = [row(axis, 2.5, 1, 8.6 + j, 8.6 + j, TONES[JOINTS[j]])[0] for j in range(outputs)]
        below = [x for places in inputs for x in places]
        for x0 in below:
            for x1 in middle:
                axis.plot([x0, x1], [0, 1.25], color=FAINT, lw=0.35, alpha=0.6, zorder=1)
            for x1 in top:
                look = {"color": TONES["network"], "lw": 0.5, "alpha": 0.55, "zorder": 1}
                axis.plot([x0, x1], [0, 2.5], "--", **look)
        for x0 in middle:
            for x1 in top:
                axis.plot([x0, x1], [1.25, 2.5], color=INK, lw=0.6, alpha=0.7, zorder=1)
        for j in range(joints):
            text = f"{JOINTS[j]}:\n{width} positions"
            axis.text(5.2 * j + 2.1, -0.28, text, ha="center", va="top")
        axis.text(-0.2, 1.25, f"{hidden} hidden\nunits", ha="right", va="center")
        axis.text(9.1, 2.72, "torques: shoulder, elbow", ha="center", va="bottom")
        axis.text(9.75, 1.3, "direct\nweights", ha="left", va="center", color=TONES["network"])
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


def relative_weights(
    weights: Weights, scale: str = "network", to: Weights | None = None
) -> Weights:
    """Weights as parts of the largest, from -1 to 1: what the squares of a Hinton diagram show.

    Parameters
    ----------
    weights : Weights
        One network.
    scale : {"network", "row"}
        What a weight is divided by: the largest weight or bias of the whole network, as in the
        paper; or the largest of its own row, the weights from one joint's window to one unit.
        Biases and weights between hidden and output units make one row then.
    to : Weights, optional
        The network whose largest weights these are; default: `weights`. Larger ones are cut.
    """
    instance("weights", weights, Weights)
    one_of("scale", scale, ("network", "row"))
    to = weights if to is None else to
    for given in (weights, to):
        if given.hidden_bias.ndim != 1:
            raise ValueError("weights must be of one network: pick a member of the ensemble")
        largest = largest_weight(given)
    windows, others = (
        ("hidden_weights", "direct_weights"),
        ("hidden_bias", "output_weights", "output_bias"),
    )
    most = dict.fromkeys((*windows, *others), largest)
    if scale == "row":
        most = {name: np.abs(getattr(to, name)).max(-1, keepdims=True) for name in windows}
        most |= dict.fromkeys(others, max(np.abs(getattr(to, name)).max() for name in others))
    parts = {name: getattr(weights, name) / np.maximum(size, 1e-300) for name, size in most.items()}
    return Weights(**{name: np.clip(part, -1, 1) for name, part in parts.items()})


def hinton_on(
    axis: Axes, weights: Weights, scale: str = "network", ring: tuple[int, int] | None = None
) -> tuple[float, float]:
    """Draw all weights of a network as `hinton` does; width and height, in the axes' own units.

    Parameters
    ----------
    axis : Axes
    weights, scale
        As for `hinton`.
    ring : (int, int), optional
        Unit, outputs counted first, and joint of a row that gets a frame.
    """
    shown = relative_weights(weights, scale)
    hidden, width = len(shown.hidden_bias), shown.width
    columns, unit_width, unit_height = 2, width + 3.0, 7.0
    rows = -(-hidden // columns)

    def blob(column, row, bias, top, window):
        x, y = column * (unit_width + 1.5), -row * (unit_height + 1.0)
        box = Rectangle((x, y), unit_width, -unit_height, facecolor="#8c8c8c", lw=0)
        axis.add_patch(box)
        dots(axis, bias, x + 1.6, y - 1.4, 1, -1, 1)
        dots(axis, top, x + unit_width - 0.5 - np.size(top), y - 1.4, 1, -1, 1)
        dots(axis, window, x + 2.0, y - 4.4, 1, -1.4, 1)

    for k in range(len(shown.output_bias)):
        blob(k, 0, shown.output_bias[k], shown.output_weights[k], shown.direct_weights[k])
    for k in range(hidden):
        blob(k % columns, 1.15 + k // columns, shown.hidden_bias[k],
             shown.output_weights[:, k], shown.hidden_weights[k])  # fmt: skip
    if ring:
        unit, joint = ring
        outputs = len(shown.output_bias)
        column, row = unit % columns, (unit >= outputs) * 0.15 + unit // columns
        corner = column * (unit_width + 1.5) + 1.1, -row * (unit_height + 1.0) - 5.15 - 1.4 * joint
        for edge, wide in (("#000000", 3.2), (ROLES["window"][1], 1.6)):  # seen on grey
            axis.add_patch(Rectangle(corner, width + 0.8, 1.5, fc="none", ec=edge, lw=wide))
    axis.set(xlim=(-0.5, columns * (unit_width + 1.5) - 1.0), aspect="equal")
    axis.set_ylim(-(rows + 1.15) * (unit_height + 1.0) - 0.5, 0.8)
    axis.axis("off")
    return columns * (unit_width + 1.5) - 0.5, (rows + 1.15) * (unit_height + 1.0) + 1.3


def hinton(weights: Weights, scale: str = "network") -> Illustration:
    """Figures 5-1 to 5-3: all weights of one network in the paper's recursive layout.

    Every grey blob is a unit: the outputs on top (shoulder left, elbow right), the hidden
    units below. Inside, the two bottom rows are the weights from the shoulder's and the
    elbow's window, time running to the right. On top: the weights to the two outputs
    (hidden units) or from the hidden units (output units), and the bias at the left.

    Parameters
    ----------
    weights : Weights
        One network.
    scale : {"network", "row"}
        What the largest square stands for: the largest weight of the network, as in the paper,
        or that of each row (`relative_weights`).
    """
    instance("weights", weights, Weights)
    relative_weights(weights, scale)  # before any work
    hidden, width = len(weights.hidden_bias), weights.width
    across, down = hinton_on(Figure().subplots(), weights, scale)

    def draw(figure: Figure):
        hinton_on(figure.subplots(), weights, scale)

    size = f"has magnitude {weights.largest:.1f}"
    alt = (
        f"Hinton diagram of a network with window {width}: two output units on top, {hidden} "
        f"hidden units below; white squares are positive, black negative weights, the largest "
        f"{size if scale == 'network' else 'of each row is of full size'}."
    )
    inches = 7.0 if width > 15 else 5.2
    return illustrate(draw, alt, inches, inches * down / across + 0.2)


def squares(rows, names: Sequence[str], scale=None) -> Illustration:
    """Rows of weights as a Hinton diagram draws them, one above the other, each with its name.

    Parameters
    ----------
    rows : array_like, shape (rows, width) or (rows, 2, width)
        Weights, oldest sample first; with two joints their windows stand side by side.
    names : sequence of str
        What each row is called.
    scale : array_like, optional
        Of the shape of `rows`: the largest weight of each of its rows has a square of full size.
        Default: `rows` themselves. Larger ones are cut.
    """
    rows = finite_array("rows", rows)
    if rows.size == 0 or rows.ndim not in (2, 3) or rows.shape[1:-1] not in ((), (len(JOINTS),)):
        shape = "(rows, width) or (rows, 2, width)"
        raise ValueError(f"rows must have the shape {shape}, got {rows.shape}")
    names = series("names", names, str)
    texts("names", names, len(rows))
    scale = rows if scale is None else shaped("scale", scale, rows.shape)
    blocks = rows[:, None] if rows.ndim == 2 else rows
    parts = blocks / np.maximum(abs(scale).reshape(blocks.shape).max(-1, keepdims=True), 1e-300)
    height, joints, width = parts.shape

    def draw(figure: Figure):
        beside = figure.get_figwidth() > NARROW
        axes = figure.subplots(*((1, joints) if beside else (joints, 1)), squeeze=False).ravel()
        for joint, axis in enumerate(axes):
            corner = (-0.7, -0.7), width + 0.4, height + 0.4
            axis.add_patch(Rectangle(*corner, facecolor="#8c8c8c", lw=0))
            dots(axis, parts[:, joint], 0, 0, 1, 1, 1 / 0.9)
            axis.set(xlim=(-0.7, width - 0.3), ylim=(height - 0.3, -0.7), aspect="equal")
            axis.set_xticks([])
            axis.set_yticks(range(height), [] if joint and beside else names)
            axis.grid(visible=False)
            if joints > 1:
                axis.set_title(f"from the {JOINTS[joint]}'s window")

    def high(inches, blocks):  # of one joint's block of rows, with its title
        return 0.2 + 0.3 * (joints > 1) + inches / blocks / (width + 0.4) * (height + 0.4)

    alt = f"Rows of white and black squares: {', '.join(names)}."
    return illustrate(draw, alt, 7.0, high(5.9, joints), joints * high(2.5, 1))


def decomposed(functions: Mapping[str, np.ndarray] | np.ndarray, step: float) -> Illustration:
    """Figures 5-4 to 5-8: rows of weights as squares, and as curves with their parts.

    Above each panel the row stands as in a Hinton diagram; the thick curve below is the same row,
    and its constant, even and odd part (`ddlib.analysis.decompose`) add up to it.

    Parameters
    ----------
    functions : array_like or mapping
        One weight function ``(width,)``, or several as ``{title: weight function}``.
    step : float
        Sampling period, s.
    """
    if not isinstance(functions, Mapping):
        functions = {"": functions}
    if not functions:
        raise ValueError("functions must hold one weight function or more, got none")
    number("step", step, 0.0, open_low=True)
    for title, f in functions.items():
        finite_array(f"functions[{title!r}]" if title else "functions", f)
    parts = {}
    for title, f in functions.items():
        if np.ndim(f) == 1 and (len(f) < 3 or len(f) % 2 == 0):
            raise ValueError(
                f"functions must have an odd number of weights, 3 or more, got {len(f)}"
            )
        parts[title] = decompose(
            shaped(f"functions[{title!r}]" if title else "functions", f, "(width,)")
        )
    columns = min(len(parts), 3)
    rows = -(-len(parts) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, squeeze=False).ravel()
        beside = columns if figure.get_figwidth() > NARROW else 1
        room = 72 * figure.get_figwidth() / beside - 62  # points, less ticks and label
        for axis, (title, part) in zip(axes, parts.items()):
            _row_and_parts(axis, part, 1e3 * step, room)
            axis.set_title(title)
        legend_above(figure, *axes[0].get_legend_handles_labels())
        for axis in axes[max(0, len(parts) - columns) : len(parts)]:
            axis.set_xlabel("time from the centre, ms")
        for axis in axes[::columns]:
            axis.set_ylabel("weight")
        for axis in axes[len(parts) :]:
            axis.remove()

    energies = "; ".join(
        f"{title}: {_shares_in_words(part)}" if title else _shares_in_words(part)
        for title, part in parts.items()
    )
    alt = f"Weights over the window, as squares and as a curve with its parts. {energies}."
    return illustrate(draw, alt, 7.0, 2.6 if rows == columns == 1 else 0.4 + 2.3 * rows)


def _row_and_parts(axis: Axes, parts, step: float, room: float) -> None:
    """A row's squares in the upper fifth of a panel, `room` points wide, and its curves below."""
    f = parts.sum()
    half = f.size // 2
    x = np.arange(-half, half + 1) * step
    constant = np.broadcast_to(parts.constant, f.shape)
    axis.plot(x, f, color=TONES["network"], lw=2.8, alpha=0.5, label="weights")
    for k, (name, y) in enumerate({"constant": constant, "even": parts.even,
                                   "odd": parts.odd}.items()):  # fmt: skip
        look = {"color": TONES[name], "ls": ("-.", "-", "--")[k], "lw": 1.5}
        axis.plot(x, y, label=name, **look)
    low, high = axis.get_ylim()
    ticks = MaxNLocator(5).tick_values(low, high)
    axis.set_yticks([tick for tick in ticks if low <= tick <= high])
    axis.set_ylim(low, low + (high - low) / 0.8)
    left, right = x[0] - 1.8 * step, x[-1] + 1.8 * step  # grey beyond the squares at the ends
    axis.set_xlim(left, right)
    across = axis.get_xaxis_transform()  # x in ms, y in parts of the panel's height
    axis.add_patch(Rectangle((left, 0.84), right - left, 0.16,
                             transform=across, facecolor="#8c8c8c", lw=0, zorder=3))  # fmt: skip
    side = min(0.95 * room / (f.size + 2.6), 17.0)  # points
    area = side**2 * np.abs(f) / (np.abs(f).max() or 1.0)
    colours = np.where(f > 0, "#ffffff", "#000000")
    look = {"marker": "s", "transform": across, "lw": 0, "zorder": 4}
    axis.scatter(x, np.full(f.size, 0.92), area, colours, **look)


def _shares_in_words(parts) -> str:
    """The parts of a weight function in words, by their shares of its energy."""
    constant = np.broadcast_to(parts.constant, parts.even.shape)
    curves = {"constant": constant, "even": parts.even, "odd": parts.odd}
    energy = {name: float((y**2).sum()) for name, y in curves.items()}
    whole = sum(energy.values()) or 1.0
    return ", ".join(f"{name} {100 * e / whole:.0f} %" for name, e in energy.items())
