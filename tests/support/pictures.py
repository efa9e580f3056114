"""What a picture shows: the artists behind an illustration, and the words in its SVG."""

from __future__ import annotations

import re
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable
from unittest import mock

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch, Rectangle

from ddlib.figures import COLOURS, ROLES, TONES, Illustration, looks, style

SVG = "{http://www.w3.org/2000/svg}"


def drawn(make: Callable[[], Illustration]) -> tuple[Illustration, Figure]:
    """An illustration, made without a warning, and the matplotlib figure behind it."""
    figures = []

    class Kept(Figure):
        def __init__(self, *args, **options):
            super().__init__(*args, **options)
            figures.append(self)

    with mock.patch.object(style, "Figure", Kept), warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = make()
    return picture, figures[-1]


def check_sound(picture: Illustration) -> None:
    """It may stand in any page, is read aloud as its text, and drawn in the page's own ink."""
    root = ET.fromstring(picture.svg)
    assert root.tag == f"{SVG}svg" and root.attrib["role"] == "figure"
    assert root.attrib["aria-label"] == picture.alt
    tags = {element.tag.removeprefix(SVG) for element in root.iter()}
    assert not tags & {"style", "script", "metadata", "image"} and "data:" not in picture.svg
    assert style.INK not in picture.svg and ("currentColor" in picture.svg or not words(picture))
    assert not re.search(r"\bnan\b", picture.svg + picture.alt)
    own = ids(picture.svg)
    targets = {a or b for a, b in re.findall(r'href="([^"]*)"|url\(([^)]*)\)', picture.svg)}
    assert len(own) == len(set(own)) and targets == {f"#{name}" for name in own}


def check(picture: Illustration, figure: Figure, shows=(), log: str | None = "", upon=None) -> None:
    """It is sound, its colours mean what they mean, and its axes show what they were given.

    `shows` has for each of the first axes the points ``(x, y)`` of lines and dots, and bars from
    corner to corner; `log` the sides that are logarithmic in these axes (None: they differ). What
    is black or white lies on a colour, or has an edge in the page's ink: it is painted `upon`.
    """
    check_sound(picture)
    check_roles(picture, figure)
    assert black_or_white(picture) <= {upon}
    assert len(picture.svg) < 400_000
    for axis, expected in zip(figure.axes, shows):
        parts = shapes(axis)
        for points in map(np.asarray, expected):
            same = [part for part in parts if part.shape == points.shape]
            assert any(np.allclose(part, points, equal_nan=True) for part in same), points
    for axis in figure.axes[: len(shows) or 1] if log is not None else ():
        scales = {"x": axis.get_xscale(), "y": axis.get_yscale()}
        assert {side for side, scale in scales.items() if scale == "log"} == set(log)


GREY = "#8c8c8c"
"""What the squares of a Hinton diagram lie on."""


def role_of(name: str) -> str | None:
    """The role that a name says, of those with a colour of their own."""
    tone = looks([name]).popitem()[1].tone
    return tone if tone in ROLES else None


def check_roles(picture: Illustration, figure: Figure) -> None:
    """What is drawn has the colour of a role, or of what has none; what says its role, that one.

    Where it stands in a page, the role's colour follows the theme.
    """
    known = {*TONES.values(), *COLOURS, *(dark for _, dark in ROLES.values())}
    known |= {GREY, "#000000", "#ffffff"}
    drawn = [part for axis in figure.axes for part in (*axis.lines, *axis.patches)]
    drawn += [c for axis in figure.axes for c in axis.collections if c.get_array() is None]
    assert {colour for part in drawn for colour in colours_of(part)} <= known
    legends = [*figure.legends, *(axis.get_legend() for axis in figure.axes if axis.get_legend())]
    for legend in legends:
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            role = role_of(text.get_text())
            assert role is None or colours_of(handle) == {TONES[role]}, text.get_text()
    for role, (light, _) in ROLES.items():
        assert picture.svg.count(light) == picture.svg.count(f"var(--dd-{role}, {light})")


def colours_of(part) -> set[str]:
    """Colours of lines, dots and areas of an artist that are seen."""
    if isinstance(part, Line2D):
        seen = [part.get_color()] if part.get_linestyle() != "None" else []
        dots = part.get_markerfacecolor(), part.get_markeredgecolor()
        seen += dots if part.get_marker() not in ("None", "", None) else []
        return {to_hex(colour) for colour in seen if to_rgba(colour)[3]}
    if isinstance(part, Patch):
        seen = [part.get_facecolor()]
        seen += [part.get_edgecolor()] if part.get_linewidth() else []
    elif isinstance(part, Collection):
        seen = [*part.get_facecolor()]
        seen += [*part.get_edgecolor()] if np.max(part.get_linewidth(), initial=0) else []
    return {to_hex(colour) for colour in seen if to_rgba(colour)[3]}


def black_or_white(picture: Illustration) -> set[str]:
    """What cannot be seen on a dark or on a light page."""
    return set(re.findall(r"(?:fill|stroke): (#000000|#ffffff|black|white)", picture.svg))


def ids(svg: str) -> list[str]:
    return [e.attrib["id"] for e in ET.fromstring(svg).iter() if "id" in e.attrib]


def size(svg: str) -> list[float]:
    """Width and height in points."""
    return [float(x) for x in ET.fromstring(svg).attrib["viewBox"].split()[2:]]


def curves(figure: Figure, colour: str) -> list[np.ndarray]:
    """The points of each line of a colour, ``(points, 2)`` in the units of its axes."""
    shown = [line for axis in figure.axes for line in axis.lines if line.get_linestyle() != "None"]
    return [line.get_xydata() for line in shown if line.get_color() == colour]


def shapes(axis: Axes) -> list[np.ndarray]:
    """The points of lines, strokes and dots, and the corners of bars, ``(points, 2)`` each."""
    strokes = [part for part in axis.collections if isinstance(part, LineCollection)]
    parts = [line.get_xydata() for line in axis.lines]
    parts += [segment for part in strokes for segment in part.get_segments()]
    for patch in axis.patches:
        if isinstance(patch, Rectangle):
            parts.append(patch.get_bbox().get_points())
        elif isinstance(patch, PathPatch):
            parts.append(patch.get_path().vertices[::2])
    return parts


def boxes(figure: Figure, colour: str) -> np.ndarray:
    """Left, bottom, right, top of the rectangles of a colour, in the units of their axes."""
    corners = [
        (*patch.get_bbox().min, *patch.get_bbox().max)
        for axis in figure.axes
        for patch in axis.patches
        if isinstance(patch, Rectangle) and to_hex(patch.get_facecolor()) == colour
    ]
    return np.array(corners).reshape(-1, 4)


def words(picture: Illustration) -> list[str]:
    """The texts of a picture, each whole and from left to right, as a reader finds them."""
    texts = ["".join(e.itertext()) for e in ET.fromstring(picture.svg).iter(f"{SVG}text")]
    return [text.replace("\N{NO-BREAK SPACE}", " ") for text in texts]
