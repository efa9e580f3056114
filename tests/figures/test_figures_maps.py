"""Maps: what is drawn is what was given, and bad input is named."""

import numpy as np
import pytest
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.contour import ContourSet
from pictures import drawn

from ddlib.figures import plane, scatter

X, Y = np.linspace(0, 45, 4), np.linspace(0, 45, 3)
VALUES = np.outer([1.0, 2.0, 4.0], [0.1, 0.2, 0.5, 1.0])
LABELS = ("shoulder, °", "elbow, °", "error")
POINTS = {"gain": (np.array([1.0, 2.0, 4.0]), np.array([0.1, 0.2, 0.3]))}


def test_a_plane_has_a_cell_for_every_value():
    picture, figure = drawn(lambda: plane(X, Y, VALUES, LABELS, "a map"))
    assert picture.alt == "a map"
    (cells,) = (found for found in figure.axes[0].collections if isinstance(found, QuadMesh))
    np.testing.assert_array_equal(cells.get_array().reshape(VALUES.shape), VALUES)
    middles = cells.get_coordinates()
    middles = (middles[1:, 1:] + middles[:-1, :-1]) / 2
    np.testing.assert_allclose(middles[0, :, 0], X)
    np.testing.assert_allclose(middles[:, 0, 1], Y)
    assert isinstance(cells.norm, LogNorm)


def test_contours_and_marks_are_drawn():
    _, bare = drawn(lambda: plane(X, Y, VALUES, LABELS, "a map"))
    assert not bare.axes[0].lines and not bare.axes[0].patches
    training, test = [(0, 0), (45, 0), (0, 45), (20, 20)], [(40, 10)]
    _, marked = drawn(
        lambda: plane(
            X, Y, VALUES, LABELS, "a map", levels=(1.0, 0.5), training=training, test=test
        )
    )
    axis = marked.axes[0]
    assert [line.get_xydata().tolist() for line in axis.lines] == [
        [list(map(float, place)) for place in places] for places in (training, test)
    ]
    (outline,) = axis.patches
    assert {tuple(corner) for corner in outline.get_xy()} == set(training[:3])  # no inner point
    (contours,) = (found for found in axis.collections if isinstance(found, ContourSet))
    assert list(contours.levels) == [0.5, 1.0]


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
    values = np.array([1.0, 2.0, 3.0])
    for given in (POINTS, both):
        _, figure = drawn(lambda given=given: scatter(given, values, "error", "distance", "arms"))
        found = [[c for c in a.collections if isinstance(c, PathCollection)] for a in figure.axes]
        panels = [cloud for clouds in found for cloud in clouds]
        assert len(panels) == len(given)
        for cloud, points in zip(panels, given.values()):
            np.testing.assert_array_equal(cloud.get_offsets(), np.transpose(points))
            np.testing.assert_array_equal(cloud.get_array(), values)
        assert not any(axis.lines for axis in figure.axes)
    _, ringed = drawn(lambda: scatter(POINTS, values, "error", "distance", "arms", chosen=1))
    (ring,) = ringed.axes[0].lines
    assert ring.get_xydata().tolist() == [[2.0, 0.2]]


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
