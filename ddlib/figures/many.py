"""What many networks hold: their rows of weights side by side, and numbers read from each."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from ddlib._check import filled, mapping, number, shaped, text, told
from ddlib.figures.style import FAINT, INK, JOINTS, TONES, Illustration, check_label, illustrate


def gallery(groups: Mapping[str, np.ndarray], alt: str) -> Illustration:
    """Rows of weights as small curves, each as high as its own largest weight.

    Parameters
    ----------
    groups : mapping
        Title of a line of the picture -> rows, shape (rows, 2, width). The shoulder's weights are
        solid, the elbow's dashed. Rows are counted from 1; a title may be empty.
    alt : str
        Alternative text.

    Raises
    ------
    ValueError
        If there is no group, or shapes do not fit.
    """
    mapping("groups", groups)
    text("alt", alt)
    every = {title: shaped(f"groups[{title!r}]", x, "(rows, 2, width)")
             for title, x in groups.items()}  # fmt: skip
    for title, rows in every.items():
        filled(f"groups[{title!r}]", rows)

    def draw(figure: Figure):
        axes = figure.subplots(len(every), 1, squeeze=False)[:, 0]
        for axis, (title, rows) in zip(axes, every.items()):
            across = np.linspace(0.1, 0.9, rows.shape[-1])
            most = np.maximum(np.abs(rows).max((1, 2), keepdims=True), 1e-300)
            for joint, dash in zip((0, 1), ("-", "--")):
                for place, row in enumerate((rows / most)[:, joint]):
                    look = {"color": TONES[JOINTS[joint]], "lw": 1.4}
                    axis.plot(place + across, row, dash, **look)
            count = len(rows)
            axis.set_xticks(np.arange(count) + 0.5, range(1, count + 1), size=8.0)
            axis.tick_params(length=0)
            axis.grid(visible=False)
            axis.spines[["left", "bottom"]].set_visible(False)
            axis.set(title=title, yticks=[], xlim=(0, count), ylim=(-1.1, 1.1))

    return illustrate(draw, alt, 7.0, 1.05 * len(every) + 0.1)


def readings(
    panels: Mapping[str, Mapping[str, np.ndarray]],
    alt: str,
    truth: Mapping[str, Mapping[str, float]] | None = None,
) -> Illustration:
    """Numbers read from models, a dot each, beside the number that they should have.

    Parameters
    ----------
    panels : mapping
        ``{quantity with its unit: {name of the models: values (models,)}}``; panels stand side by
        side and have the same names.
    alt : str
        Alternative text.
    truth : mapping, optional
        ``{quantity: {name: value}}``: an upright stroke; a name may be missing.

    Raises
    ------
    ValueError
        If there is no panel, or a label names no quantity.
    """
    mapping("panels", panels)
    text("alt", alt)
    true_of = {} if truth is None else truth
    if truth is not None:
        mapping("truth", truth)
        for label, strokes in truth.items():
            mapping(f"truth[{label!r}]", strokes)
            for name, value in strokes.items():
                number(f"truth[{label!r}][{name!r}]", value)
    for label, shown in panels.items():
        mapping(f"panels[{label!r}]", shown)
        check_label(label)
        for name, values in shown.items():
            shaped(f"panels[{label!r}][{name!r}]", values, "(models,)")
    names = list(next(iter(panels.values())))
    if any(list(shown) != names for shown in panels.values()):
        raise ValueError(f"panels must all have the names {told(names)}")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        for axis, (label, shown) in zip(axes, panels.items()):
            for name, values in shown.items():
                row = names.index(name)
                look = {"color": TONES["network"], "ms": 6}
                axis.plot(values, np.full(len(values), row), "o", **look)
                if name in true_of.get(label, {}):
                    true = {"color": INK, "ms": 18, "mew": 2.2}
                    axis.plot(true_of[label][name], row, "|", **true)
            axis.axvline(0, color=FAINT, lw=0.8)
            axis.set(xlabel=label, ylim=(len(names) - 0.4, -0.6), xmargin=0.15)
            axis.grid(visible=False, axis="y")
        axes[0].set_yticks(range(len(names)), names)

    return illustrate(draw, alt, 7.0, 0.36 * len(names) + 0.7)
