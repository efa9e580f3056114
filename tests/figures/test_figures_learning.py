"""Figures of learning: every network a curve, the median on top, errors that name the family."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from ddlib.figures import COLOURS, Illustration, clusters, families

SVG = "{http://www.w3.org/2000/svg}"
X = np.linspace(1.0, 10.0, 6)
FAN = X[:, None] * [1.0, 2.0, 6.0]
LABELS = ("epoch", "error")


def strokes(figure, colour) -> dict[float, list[np.ndarray]]:
    """Vertices of the curves of a colour, by line width."""
    found = {}
    for element in ET.fromstring(figure.svg).iter(f"{SVG}path"):
        style = element.attrib.get("style", "")
        if f"stroke: {colour}" in style and "clip-path" in element.attrib:
            width = float(re.search(r"stroke-width: ([\d.]+)", style)[1])
            numbers = re.findall(r"[ML] ([\d.-]+) ([\d.-]+)", element.attrib["d"])
            found.setdefault(width, []).append(np.array(numbers, float))
    return found


def test_every_network_and_the_median_are_drawn():
    figure = families({"": {"slow": (X, FAN)}}, LABELS, "three networks and their median")
    assert isinstance(figure, Illustration)
    curves = strokes(figure, COLOURS[0])
    assert len(curves[0.6]) == 3 and len(curves[2.2]) == 1
    np.testing.assert_allclose(curves[2.2][0], curves[0.6][1], atol=0.02)


def test_a_family_looks_the_same_in_every_panel():
    panels = {"a": {"one": (X, FAN)}, "b": {"two": (X, FAN), "one": (X, FAN)}}
    figure = families(panels, LABELS, "two panels", y_log=True)
    assert len(strokes(figure, COLOURS[0])[2.2]) == 2
    assert len(strokes(figure, COLOURS[1])[2.2]) == 1
    assert figure.alt == "two panels" and 'role="img"' in figure.svg


@pytest.mark.parametrize(
    "panels, words",
    [
        ({}, "panels must hold one panel or more"),
        ({"": {"a": (X, X)}}, "x and y of 'a' must have shapes"),
        ({"": {"a": (X[:3], FAN)}}, "x and y of 'a' must have shapes"),
        ({"": {"a": (X, FAN * np.nan)}}, "y of 'a' must be finite"),
    ],
)
def test_refusals(panels, words):
    with pytest.raises(ValueError, match=words):
        families(panels, LABELS, "text")


def test_clusters_draw_medians_and_the_wanted_value():
    groups = {"few, one": np.array([1.0, 2.0, 6.0]), "many": np.array([3.0, 3.0, 5.0, 9.0])}
    picture = clusters({"left": (groups, 4.0), "right": (groups, 0.0)}, "N m", "Dots.")
    few, many = (strokes(picture, COLOURS[k])[2.2] for k in (0, 1))
    assert len(few) == len(many) == 2  # panels
    assert few[0][0, 1] > many[0][0, 1]  # a median of 2 below one of 4; SVG counts downwards
    lines = [e.attrib["d"] for e in ET.fromstring(picture.svg).iter(f"{SVG}path")
             if "stroke-dasharray" in e.attrib.get("style", "")]  # fmt: skip
    left = np.array(re.findall(r"[ML] ([\d.-]+) ([\d.-]+)", lines[0]), float)
    assert many[0][0, 1] == pytest.approx(left[0, 1], abs=0.02)
    assert picture.alt == "Dots."


@pytest.mark.parametrize(
    "panels, name",
    [
        ({}, "panels"),
        ({"a": ({"b": np.zeros((2, 2))}, 1.0)}, "values of 'b'"),
        ({"a": ({"b": np.array([np.nan])}, 1.0)}, "values of 'b'"),
        ({"a": ({"b": np.zeros(2)}, np.inf)}, "wanted"),
    ],
)
def test_clusters_refuse_bad_arguments_by_name(panels, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        clusters(panels, "N m", "Dots.")
