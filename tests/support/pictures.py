"""What a picture shows: the artists behind an illustration, and the words in its SVG."""

from __future__ import annotations

import inspect
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from types import ModuleType
from unittest import mock

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from ddlib.figures import INK, Illustration, style

SVG = "{http://www.w3.org/2000/svg}"


def drawn(make: Callable[[], Illustration]) -> tuple[Illustration, Figure]:
    """An illustration and the matplotlib figure that it was made from."""
    kept = []

    class Kept(Figure):
        def __init__(self, *args, **options):
            super().__init__(*args, **options)
            kept.append(self)

    with mock.patch.object(style, "Figure", Kept):
        picture = make()
    return picture, kept[-1]


def figures_in(module: ModuleType) -> set[str]:
    """The public figures that a module defines itself."""
    functions = inspect.getmembers(module, inspect.isfunction)
    return {n for n, f in functions if f.__module__ == module.__name__ and n[0] != "_"}


def check_sound(figure: Illustration) -> None:
    """Read aloud as its alternative text, drawn in the page's own ink, with numbers only."""
    assert isinstance(figure, Illustration)
    root = ET.fromstring(figure.svg)
    assert root.attrib["role"] == "figure" and root.attrib["aria-label"] == figure.alt
    assert INK not in figure.svg and "currentColor" in figure.svg
    assert not re.search(r"\bnan\b", figure.svg)


def curves(figure: Figure, colour: str) -> list[np.ndarray]:
    """The points of each line of a colour, ``(points, 2)`` in the units of its axes."""
    shown = [line for axis in figure.axes for line in axis.lines if line.get_linestyle() != "None"]
    return [line.get_xydata() for line in shown if line.get_color() == colour]


def on_paper(axis, points) -> np.ndarray:
    """Where an axis draws points, in pixels from the lower left corner."""
    return axis.transData.transform(points)


def boxes(figure: Figure, colour: str) -> np.ndarray:
    """Left, bottom, right, top of the rectangles of a colour, in the units of their axes."""
    found = [
        (*patch.get_bbox().min, *patch.get_bbox().max)
        for axis in figure.axes
        for patch in axis.patches
        if isinstance(patch, Rectangle) and to_hex(patch.get_facecolor()) == colour
    ]
    return np.array(found).reshape(-1, 4)


def words(picture: Illustration) -> list[str]:
    """The texts of a picture, each whole and from left to right, as a reader finds them."""
    texts = ["".join(e.itertext()) for e in ET.fromstring(picture.svg).iter(f"{SVG}text")]
    return [text.replace("\N{NO-BREAK SPACE}", " ") for text in texts]
