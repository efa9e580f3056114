"""A widget's starting state as a picture, for pages without script and for print."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Mapping, Sequence

import numpy as np
import traitlets

from ddlib.figures import FAINT, INK, TONES, illustrate
from ddlib.figures.style import fixed
from ddlib.widgets.parts.panels import Pad, Panel
from ddlib.widgets.parts.parameters import Parameter

_COLUMNS = 3  # most charts side by side
START = "data:image/svg+xml;base64,"  # of a still's address: it holds the picture, leads nowhere


class Still(traitlets.Unicode):
    """The trait of a still: empty, or the ``data:`` address of an SVG; nothing to be fetched."""

    def validate(self, obj, value):
        """`value`, or a TraitError if it is another address."""
        value = super().validate(obj, value)
        if value:
            try:
                if not value.startswith(START):
                    raise ValueError("no such start")
                base64.b64decode(value[len(START) :], validate=True)
            except (ValueError, binascii.Error):
                raise traitlets.TraitError(
                    f"{self.name} must be an address that begins with {START!r} and goes on in "
                    f"base64, got {value[:60]!r}"
                ) from None
        return value


def still_picture(
    curves: Mapping[str, np.ndarray],
    panels: Sequence[Panel],
    parameters: Mapping[str, Parameter],
    pad: Pad | None,
    alt: str,
) -> str:
    """The starting state as the address of an SVG with fixed, light colours; `alt` describes it."""
    count = len(panels) + bool(pad)
    rows = -(-count // _COLUMNS)
    columns = -(-count // rows)

    def draw(figure):
        axes = list(np.ravel(figure.subplots(rows, columns)))
        for ax in axes[count:]:
            ax.set_axis_off()
        if pad:
            _draw_pad(axes.pop(0), pad, parameters)
        for ax, panel in zip(axes, panels):
            _draw_panel(ax, panel, curves)

    return START + encoded(illustrate(draw, alt, width=2.9 * columns, height=2.6 * rows).svg)


def encoded(svg: str) -> str:
    """A figure's SVG with fixed, light colours, in base64: what follows `START`."""
    return base64.b64encode(fixed(svg).encode()).decode()


def _draw_panel(ax, panel: Panel, curves):
    lines = [(label, curves[name]) for name, label in panel.curves.items()]
    moving = len(lines)
    lines += panel.fixed.items()
    gap = np.diff(panel.x).min()
    for k, (label, y) in enumerate(lines):
        look = panel.looks[label]
        colour = look.colour
        if panel.kind == "bars":
            width = 0.8 * gap / len(lines)
            places = panel.x + (k - (len(lines) - 1) / 2) * width
            ax.bar(places, y, width, color=colour, label=label)
        elif panel.kind == "stems" and k < moving:
            ax.vlines(panel.x, 0, y, color=colour)
            ax.plot(panel.x, y, "os^D"[k % 4], ms=4, color=colour, label=label)
        else:
            ax.plot(panel.x, y, label=label, **look.line)
    places = [curves[name].item() for name in panel.cursor]
    if len(places) == 1:
        ax.axvline(*places, color=FAINT, linewidth=1)
    elif places:
        ax.axvspan(*sorted(places), color=TONES["window"], alpha=0.2, linewidth=0)
    ax.set(title=panel.y_label, xlabel=panel.x_label, xscale=panel.x_scale, yscale=panel.y_scale)
    if panel.ticks:
        ax.set_xticks(*zip(*panel.ticks))
    if panel.y_range:
        ax.set_ylim([curves[x].item() if isinstance(x, str) else x for x in panel.y_range])
    if len(lines) > 1:
        ax.legend()


def _draw_pad(ax, pad: Pad, parameters):
    x, y = parameters[pad.x], parameters[pad.y]
    if pad.region:
        ax.fill(*zip(*pad.region), color=FAINT, alpha=0.25, linewidth=0)
    groups = list(dict.fromkeys(mark.group for mark in pad.marks))
    for mark in pad.marks:
        k = groups.index(mark.group)
        ax.plot(mark.x, mark.y, "os^D"[k % 4], color=pad.looks[mark.group].colour, clip_on=False)
        # inwards from the right and the upper edge, where there is no room
        right = mark.x > x.place(0.9)
        above = mark.y <= y.place(0.9)
        ax.annotate(
            mark.label,
            (mark.x, mark.y),
            (-6 if right else 6, 4 if above else -4),
            textcoords="offset points",
            ha="right" if right else "left",
            va="bottom" if above else "top",
        )
    ax.plot(x.value, y.value, "o", ms=11, mfc="none", mec=INK, clip_on=False)
    ax.set(xscale=x.scale, yscale=y.scale)
    ax.set(xlim=(x.low, x.high), ylim=(y.low, y.high), aspect="auto")
    ax.set(xlabel=_name(x), ylabel=_name(y))


def _name(parameter: Parameter) -> str:
    return f"{parameter.label}, {parameter.unit}" if parameter.unit else parameter.label
