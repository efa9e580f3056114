"""Maps: what is drawn is what was given, and bad input is named."""

import re
from collections import Counter

import numpy as np
import pytest

from ddlib.figures import plane, scatter

X, Y = np.linspace(0, 45, 4), np.linspace(0, 45, 3)
VALUES = np.outer([1.0, 2.0, 4.0], [0.1, 0.2, 0.5, 1.0])
LABELS = ("shoulder, °", "elbow, °", "error")
POINTS = {"gain": (np.array([1.0, 2.0, 4.0]), np.array([0.1, 0.2, 0.3]))}


def cells(svg: str) -> Counter:
    """How many cells have each colour; the colour bar has every colour once."""
    return Counter(re.findall(r"fill: ?(#[0-9a-f]{6})", svg))


def test_a_plane_has_a_cell_for_every_value():
    svg = plane(X, Y, VALUES, LABELS, "a map").svg
    flat = plane(X, Y, np.full((3, 4), 0.5) * [1, 1, 1, 1.001], LABELS, "a map").svg
    assert 'aria-label="a map"' in svg
    more = cells(svg) - cells(plane(X, Y, VALUES[:, ::-1], LABELS, "a map").svg)
    assert not more  # the same cells elsewhere
    (_, most), *_ = cells(svg).most_common(1)
    (_, nearly_all), *_ = cells(flat).most_common(1)
    assert most == 3 and nearly_all == 10  # with the one of the bar


def test_contours_and_marks_are_drawn():
    bare = plane(X, Y, VALUES, LABELS, "a map").svg
    marked = plane(
        X, Y, VALUES, LABELS, "a map", levels=(0.5, 1.0),
        training=[(0, 0), (45, 0), (0, 45), (20, 20)], test=[(40, 10)],
    ).svg  # fmt: skip
    assert "stroke-dasharray" in marked and "stroke-dasharray" not in bare


@pytest.mark.parametrize(
    "x, y, values, words",
    [
        (X, Y, VALUES.T, r"values must have shape \(len\(y\), len\(x\)\) = \(3, 4\), got \(4, 3\)"),
        (X, Y, -VALUES, "values must be above 0"),
        (X, Y, VALUES * np.nan, "values"),
        ([0, np.inf, 1, 2], Y, VALUES, "x"),
    ],
)
def test_planes_refuse(x, y, values, words):
    with pytest.raises(ValueError, match=words):
        plane(x, y, values, LABELS, "a map")


def test_nothing_is_an_embedded_picture():
    """The pages' policy does not let `data:` in."""
    figures = (
        plane(X, Y, VALUES, LABELS, "a map"),
        scatter(POINTS, [1.0, 2.0, 3.0], "error", "distance", "arms"),
    )
    assert not [f for f in figures if "<image" in f.svg or "data:" in f.svg]


def test_a_scatter_has_a_panel_for_each_quantity():
    both = {**POINTS, "damping": POINTS["gain"]}
    one, two = (scatter(p, [1.0, 2.0, 3.0], "error", "distance", "arms") for p in (POINTS, both))
    panels = [len(re.findall(r'id="[^"]*PathCollection', f.svg)) for f in (one, two)]
    assert panels == [1, 2]
    ringed = scatter(POINTS, [1.0, 2.0, 3.0], "error", "distance", "arms", chosen=1)
    assert ringed.svg != one.svg


@pytest.mark.parametrize(
    "points, values, words",
    [
        ({"gain": ([1.0, 2.0], [1.0, 2.0])}, [1.0, 2.0, 3.0], "points of 'gain' must be 3 numbers"),
        ({"gain": ([1.0, -2.0], [1.0, 2.0])}, [1.0, 2.0], "points of 'gain' must be 2 numbers"),
        (POINTS, [0.0, 1.0, 2.0], "values must be above 0"),
    ],
)
def test_scatters_refuse(points, values, words):
    with pytest.raises(ValueError, match=words):
        scatter(points, values, "error", "distance", "arms")
