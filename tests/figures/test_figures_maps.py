"""Maps: what is drawn is what was given, and bad input is named."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.contour import ContourSet
from pictures import drawn, words

from ddlib import paper
from ddlib.figures import COLOURS, INK, rmss_by_window
from workshop.chapters.window_networks import intervals, plane

X, Y = np.linspace(0, 45, 4), np.linspace(0, 45, 3)
VALUES = np.outer([1.0, 2.0, 4.0], [0.1, 0.2, 0.5, 1.0])
LABELS = ("shoulder, °", "elbow, °", "error")


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
        intervals({"a": {"b": {"c": (1, 2, 3)}}}, "x", "rows"),
    )
    assert not [f for f in figures if "<image" in f.svg or "data:" in f.svg]


# --- Table 4-1 under set-ups --------------------------------------------------------------------

RNG = np.random.default_rng(3)
PRINTED = {
    "training": {w: row.training for w, row in paper.TABLE_4_1.items()},
    "test": {w: row.test for w, row in paper.TABLE_4_1.items()},
}
TABLE = {
    name: {column: {w: RNG.uniform(0.02, 0.4, 25) for w in (11, 21, 41)} for column in PRINTED}
    for name in ("one", "other")
}


def test_every_network_of_each_set_up_is_drawn():
    picture, figure = drawn(lambda: rmss_by_window(TABLE, PRINTED))
    for axis, (column, marks) in zip(figure.axes, PRINTED.items()):
        assert axis.get_yscale() == "log"
        clouds = [line for line in axis.lines if line.get_marker() != "None"]
        assert len(clouds) == 6
        for k, name in enumerate(TABLE):
            mine = [line for line in clouds if line.get_color() == COLOURS[k]]
            for line, (place, values) in zip(mine, enumerate(TABLE[name][column].values())):
                x, y = line.get_xydata().T
                np.testing.assert_array_equal(y, np.sort(values))
                assert (np.abs(x - place) < 0.5).all()
        bars = [line.get_ydata()[0] for line in axis.lines if line.get_color() == INK]
        wanted = [np.median(v) for name in TABLE for v in TABLE[name][column].values()]
        np.testing.assert_allclose(bars, wanted)
        dashed = [line.get_ydata()[0] for line in axis.lines if line.get_linestyle() == "--"]
        np.testing.assert_allclose(dashed, list(marks.values()))
    assert f"one, median test error 11: {np.median(TABLE['one']['test'][11]):.3f}" in picture.alt
    assert [word for word in words(picture) if word == "printed"] == ["printed"]
    with pytest.raises(ValueError, match="errors of 'one' must be above 0"):
        rmss_by_window({"one": {"test": {11: [0.1, 0.0]}}}, PRINTED)


# --- rows of intervals --------------------------------------------------------------------------

PANELS = {
    "left": {"a": {"gain": (0.5, 1.0, 2.0), "friction": (1.0, 1.0, 1.0)}, "b": {"gain": (1, 2, 4)}},
    "right": {"a": {"gain": (0.2, 0.3, 0.4)}},
}


def test_intervals_and_points_are_where_they_were_given():
    picture, figure = drawn(lambda: intervals(PANELS, "factor", "rows", log=True, band=(0.7, 1.4)))
    left, right = figure.axes
    assert left.get_xscale() == "log" and picture.alt == "rows"
    lines = [line for line in left.lines if line.get_marker() == "None"]
    assert [line.get_xdata().tolist() for line in lines] == [[0.5, 2.0], [1.0, 1.0], [1, 4]]
    points = [line.get_xydata()[0] for line in left.lines if line.get_marker() != "None"]
    assert [point[0] for point in points] == [1.0, 1.0, 2]
    heights = [point[1] for point in points]
    assert heights[0] < 0 < heights[2] < 0.5 < heights[1]  # first row above, series side by side
    assert [label.get_text() for label in left.get_yticklabels()] == ["gain", "friction"]
    assert left.get_ylim()[0] > left.get_ylim()[1]
    (shade,) = left.patches
    np.testing.assert_allclose(shade.get_bbox().intervalx, (0.7, 1.4))
    assert len([line for line in right.lines if line.get_marker() == "None"]) == 1
    assert {"a", "b"} <= set(words(picture))


def test_rows_with_ends_and_marks():
    panels = {"all": {"a": {"gain": (-0.5, 0.0, 0.9)}}}
    picture, figure = drawn(
        lambda: intervals(
            panels, "place", "rows", marks={"all": {"gain": 0.3}}, ends={"gain": ("300", "900")}
        )
    )
    (axis,) = figure.axes
    assert axis.get_xlim() == (-1, 1)
    (mark,) = [line for line in axis.lines if line.get_marker() == "D"]
    np.testing.assert_allclose(mark.get_xydata(), [[0.3, 0]])
    assert {"300", "900"} <= set(words(picture))
    with pytest.raises(ValueError, match="interval of 'gain' must be in order"):
        intervals({"all": {"a": {"gain": (0.5, 0.0, 0.9)}}}, "place", "rows")
