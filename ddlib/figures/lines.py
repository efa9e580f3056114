"""Curves: quantities over one axis, predictions over measurements, errors by window size.

Of many networks every one is fine and their median bold.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from ddlib._check import flag, integer, mapping, number, shaped, text, texts
from ddlib.figures.style import (
    INK,
    TONES,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    looks,
    plain_ticks,
)


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

    Their names say how they are drawn (`looks`): call a curve *elbow*, *network* or *reference*,
    and it has the colour that this has in all figures.

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
    if x is not None:
        shaped("x", x, "(points,)")
    mapping("panels", panels)
    for named in panels.values():
        mapping("panels", named)
    text("x_label", x_label)
    integer("columns", columns, 1, 12)
    _check_look(alt, height, x_log, y_log)
    rows = -(-len(panels) // columns)
    names = [tuple(named) for named in panels.values()]
    above = len(names[0]) > 1 and len(set(names)) == 1  # where no curve can run through it
    look = looks(sum(names, ()))  # the same curve looks the same in every panel

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, squeeze=False).ravel()
        for axis, (label, named) in zip(axes, panels.items()):
            for name, y in named.items():
                x_k, y_k = y if isinstance(y, tuple) else (x, y)
                axis.plot(x_k, y_k, label=name, **look[name].line)
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


def families(
    panels: Mapping[str, Mapping[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    height: float = 2.3,
    x_log: bool = False,
    y_log: bool = False,
) -> Illustration:
    """Families of curves, one for each way of learning: networks fine, their median bold.

    Parameters
    ----------
    panels : mapping
        ``{panel title: {name: (x, y)}}`` with `x` of shape (points,) and `y` of shape (points,
        networks). A family of the same name looks the same in every panel; an empty title is
        left out.
    labels : tuple of str
        Labels of the x and y axes.
    alt : str
        Alternative text.
    height : float
        Height of a panel, inches.
    x_log, y_log : bool
        Logarithmic axes.

    Raises
    ------
    ValueError
        If there is no panel, or shapes do not fit.
    """
    mapping("panels", panels)
    for named in panels.values():
        mapping("panels", named)
    texts("labels", labels, 2)
    _check_look(alt, height, x_log, y_log)
    for named in panels.values():
        for name, (x, y) in named.items():
            x = shaped(f"x of {name!r}", x, "(points,)")
            shaped(f"y of {name!r}", y, f"({len(x)}, networks)")
    look = looks(name for named in panels.values() for name in named)
    columns = min(2, len(panels))
    rows = -(-len(panels) // columns)

    def draw(figure: Figure):
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        for axis, (title, named) in zip(axes, panels.items()):
            for name, (x, y) in named.items():
                line = look[name].line
                axis.plot(x, y, color=line["color"], lw=0.6, alpha=0.45)
                axis.plot(x, np.median(y, axis=1), lw=2.2, **line)
            axis.set_title(title)
            for which, log in (("x", x_log), ("y", y_log)):
                if log:
                    axis.set(**{f"{which}scale": "log"})
                    plain_ticks(getattr(axis, f"{which}axis"))
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(labels[0])
        figure.supylabel(labels[1])
        if len(look) > 1 and max(map(len, panels.values())) > 1:
            handles = [Line2D([], [], lw=2.2, **each.line) for each in look.values()]
            figure.legend(handles, list(look), loc="outside upper left", ncols=4)

    return illustrate(draw, alt, 7.0, height * rows + 0.5)


def _check_look(alt, height, x_log=False, y_log=False) -> None:
    """Refuse what cannot be a text, a height in inches, or whether an axis is logarithmic."""
    text("alt", alt)
    number("height", height, 0.0, 50.0, open_low=True)
    flag("x_log", x_log)
    flag("y_log", y_log)


def dots_in_one(axis: Axes, places: np.ndarray, **look) -> None:
    """Dots ``(n, 2)`` as one path, as thousands of markers would be as many elements of the page.

    They are strokes of no length with round ends: their size is ``lw``, in points.
    """
    path = Path(np.repeat(places, 2, axis=0), [Path.MOVETO, Path.LINETO] * len(places))
    path.should_simplify = False
    axis.add_patch(PathPatch(path, fill=False, capstyle="round", **look))


def clouds(
    panels: Mapping[str, tuple], labels: tuple[str, str], alt: str, *, slope: float | None = None
) -> Illustration:
    """Two quantities as dots, a panel for each case, side by side on common axes.

    Parameters
    ----------
    panels : mapping
        ``{panel title: (x, y)}``, each of shape (points,).
    labels : tuple of str
        Labels of the x and y axes, each a quantity with its unit.
    alt : str
        Alternative text.
    slope : float, optional
        Of a dashed line through zero, below the dots' whole range: what is wanted of them.

    Raises
    ------
    ValueError
        If there is no panel, or shapes do not fit.
    """
    mapping("panels", panels)
    texts("labels", labels, 2)
    text("alt", alt)
    if slope is not None:
        number("slope", slope)
    for name, (x, y) in panels.items():
        shaped(f"y of {name!r}", y, f"({len(shaped(f'x of {name!r}', x, '(points,)'))},)")
    across = np.concatenate([x for x, _ in panels.values()])
    ends = np.array([across.min(), across.max()])

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, pair) in zip(axes, panels.items()):
            dots_in_one(axis, np.stack(pair, -1), color=TONES["shoulder"], lw=2.0)
            if slope is not None:
                axis.plot(ends, slope * ends, "--", color=TONES["wanted"], lw=1.5)
            axis.autoscale_view()
            axis.set(title=title, xlabel=check_label(labels[0]))
        axes[0].set_ylabel(check_label(labels[1]))

    return illustrate(draw, alt, 7.0, 2.1)


def by_case(
    x, cases: Mapping[str, np.ndarray], x_label: str, y_label: str, alt: str, height: float = 1.3
) -> Illustration:
    """One quantity in several cases: a panel each, titled by the case, one below the other.

    All have one scale.

    Parameters
    ----------
    x : array_like, shape (points,)
        The common axis.
    cases : mapping
        ``{case: values (points,)}``.
    x_label, y_label, alt : str
        Labels of the axes, each a quantity with its unit; alternative text.
    height : float
        Height of a panel, inches.

    Raises
    ------
    ValueError
        If a label names no quantity, or there is no case.
    """
    shaped("x", x, "(points,)")
    mapping("cases", cases)
    text("x_label", x_label)
    text("y_label", y_label)
    _check_look(alt, height)

    def draw(figure: Figure):
        axes = figure.subplots(len(cases), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (case, values) in zip(axes, cases.items()):
            axis.plot(x, values, color=INK)
            axis.set(title=case, ylabel=check_label(y_label))
        axes[-1].set_xlabel(check_label(x_label))

    return illustrate(draw, alt, 7.0, height * len(cases) + 0.4)
