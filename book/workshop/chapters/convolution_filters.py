"""Figures of the chapter *Convolution filters*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import finite_array, number, shaped
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)


def clusters(
    panels: Mapping[str, tuple[Mapping[str, np.ndarray], float]], unit: str, alt: str
) -> Illustration:
    """A quantity of many networks in several groups, beside the value that it should have."""
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for groups, wanted in panels.values():
        number("wanted", wanted)
        for name, values in groups.items():
            shaped(f"values of {name!r}", values, "(networks,)")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False)[0]
        for axis, (title, (groups, wanted)) in zip(axes, panels.items()):
            axis.axhline(wanted, color=INK, ls="--", lw=1.0)
            for k, values in enumerate(map(np.asarray, groups.values())):
                colour = COLOURS[k % len(COLOURS)]
                x = k + np.linspace(-0.25, 0.25, len(values))
                axis.plot(x, values, "os^Dv"[k % 5], color=colour, ms=3.5, mew=0, alpha=0.7)
                middle = np.median(values)
                axis.plot([k - 0.36, k + 0.36], [middle, middle], color=colour, lw=2.2)
            axis.set_xticks(range(len(groups)), [name.replace(", ", "\n") for name in groups])
            axis.tick_params("x", labelsize=7.5)
            axis.grid(visible=False, axis="x")
            axis.set(title=title, xlim=(-0.6, len(groups) - 0.4))
            axis.set_ylim(min(0.0, axis.get_ylim()[0]), None)
        axes[0].set_ylabel(unit)

    return illustrate(draw, alt, 7.0, 2.9)


def against_nulls(
    panels: Mapping[str, Mapping[str, Mapping[str, np.ndarray]]], label: str, alt: str
) -> Illustration:
    """Shares of filters under the real torques, as bars, and under nulls, a dot for each draw."""
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for groups in panels.values():
        for name, sets in groups.items():
            for values in sets.values():
                shape = finite_array(f"values of {name!r}", values).shape
                if len(shape) != 1:
                    raise ValueError(f"values of {name!r} must have shape (draws,), got {shape}")
    classes = list(next(iter(panels.values())))
    rows = -(-len(panels) // 3)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 3, squeeze=False, sharey=True)
        for axis, (title, groups) in zip(axes.ravel(), panels.items()):
            for row, sets in enumerate(groups.values()):
                (real, values), *nulls = sets.items()
                axis.barh(row, np.mean(values), 0.86, color=FAINT, alpha=0.35, label=real, lw=0)
                axis.plot([np.mean(values)] * 2, [row - 0.43, row + 0.43], color=INK, lw=2.0)
                for k, (name, draws) in enumerate(nulls):
                    height = row + (k - (len(nulls) - 1) / 2) * 0.26
                    _dots(axis, draws, height, k, name)
            axis.set(title=title, xlim=(-0.03, 1.03), ylim=(len(groups) - 0.5, -0.5))
            axis.grid(visible=False, axis="y")
        for axis in axes[:, 0]:
            axis.set_yticks(range(len(classes)), classes)
        for axis in axes[-1]:
            axis.set_xlabel(check_label(label))
        handles, names = axes[0, 0].get_legend_handles_labels()
        first = {name: handle for handle, name in zip(handles[::-1], names[::-1])}
        order = list(next(iter(next(iter(panels.values())).values())))
        for k, name in enumerate(order[1:]):
            first[name] = Line2D([], [], ls="", marker="os|"[k % 3], ms=4, color=COLOURS[k])
        legend_above(figure, [first[name] for name in order], order)

    return illustrate(draw, alt, 7.0, 0.6 + rows * (0.5 + 0.36 * len(classes)))


def _dots(axis: Axes, values, height: float, k: int, name: str):
    """One mark for each value, all in one path, since hundreds of markers are heavy."""
    at = np.unique(np.asarray(values, dtype=float))
    long = 0.09 if k % 3 == 2 else 1e-3  # discs, squares and strokes
    x, y = np.repeat(at, 3), np.tile([height - long, height + long, np.nan], at.size)
    cap = ("round", "projecting", "butt")[k % 3]
    axis.plot(x, y, color=COLOURS[k % len(COLOURS)], lw=1.5 if k % 3 == 2 else 3.4, alpha=0.7,
              solid_capstyle=cap, label=name)  # fmt: skip


def by_explained(
    rows: Mapping[str, Mapping[str, np.ndarray]],
    courses: Mapping[str, Mapping[str, np.ndarray]],
    labels: tuple[str, str],
    alt: str,
) -> Illustration:
    """Shares of filters by target, and in mixtures by how much of them the windows explain.

    `rows` has for each target, the topmost first, sets of one value a network: of the first set all
    values and their mean are shown, of the others the means. Of each mixture in `courses` means,
    and the range of nine tenths of the networks, are shown at equal steps.
    """
    for name, sets in [*rows.items(), *courses.items()]:
        for what, values in sets.items():
            shaped(f"{what!r} of {name!r}", values, "(networks,)")

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2)
        for height, sets in enumerate(rows.values()):
            (first, values), *others = sets.items()
            mean = np.mean(values)
            _dots(left, values, height, 0, f"{first}, each network")
            ends = [height - 0.38, height + 0.38]
            left.plot([mean] * 2, ends, color=INK, lw=2.0, label=f"{first}, mean")
            for k, (name, other) in enumerate(others, 1):
                look = {"color": COLOURS[k], "mfc": "none", "ms": 4.5, "ls": ""}
                left.plot([np.mean(other)], [height], "sD^"[k % 3], label=f"{name}, mean", **look)
        left.set_yticks(range(len(rows)), list(rows))
        left.grid(visible=False, axis="y")
        left.set(title="By target", xlabel=check_label(labels[0]), ylim=(len(rows) - 0.4, -0.6))
        for k, (name, sets) in enumerate(courses.items(), 2):
            at = np.arange(len(sets)) + 0.1 * (k - 2)
            look = {"color": COLOURS[k], "marker": "os"[k % 2], "ls": DASHES[k - 2]}
            right.plot(at, [np.mean(x) for x in sets.values()], ms=4, label=name, **look)
            ends = np.transpose([np.quantile(x, (0.05, 0.95)) for x in sets.values()])
            right.vlines(at, *ends, color=COLOURS[k], lw=1.0)
            right.set_xticks(range(len(sets)), list(sets))
        right.set(title="Mixtures", xlabel=check_label(labels[1]), ylabel=labels[0])
        named = {}
        for axis in (left, right):
            handles, names = axis.get_legend_handles_labels()
            named |= dict(zip(names, handles))
        named[next(iter(named))] = Line2D([], [], ls="", marker="o", ms=4, color=COLOURS[0])
        legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 3.6, 4.8)
