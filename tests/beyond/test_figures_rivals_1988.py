"""Maps around one trajectory: what is drawn is what was given, and bad input is named."""

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from pictures import drawn

from workshop.beyond.figures.rivals_1988 import maps

EDGE = np.array([10.0, 20.0, 30.0])
ERRORS = {"one": np.arange(1.0, 10.0).reshape(3, 3), "two": np.full((3, 3), 0.5)}
LABELS = ("shoulder, °", "elbow, °", "error")


def test_a_panel_for_each_rival_on_one_scale():
    picture, figure = drawn(lambda: maps(EDGE, ERRORS, LABELS, "two maps", mark=(20.0, 30.0)))
    assert picture.alt == "two maps"
    panels = [axis for axis in figure.axes if axis.get_title(loc="left")]
    assert [axis.get_title(loc="left") for axis in panels] == list(ERRORS)
    for axis, values in zip(panels, ERRORS.values()):
        (cells,) = (found for found in axis.collections if isinstance(found, QuadMesh))
        np.testing.assert_array_equal(cells.get_array().reshape(3, 3), values.T)
        assert (cells.norm.vmin, cells.norm.vmax) == (0.5, 9.0)
        assert axis.lines[0].get_xydata().tolist() == [[20.0, 30.0]]


@pytest.mark.parametrize(
    "errors, words",
    [
        ({}, "errors must hold a panel"),
        ({"a": -ERRORS["one"]}, "errors of 'a' must be above 0, got -9"),
        ({"a": np.ones((2, 3))}, "errors of 'a' must have shape"),
    ],
)
def test_maps_refuse(errors, words):
    with pytest.raises(ValueError, match=words):
        maps(EDGE, errors, LABELS, "maps")
