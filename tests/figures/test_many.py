"""Rows of many networks side by side, and dots of what was read beside what is true."""

import numpy as np
import pytest
from pictures import check_sound

from ddlib.figures import gallery, readings


def test_each_row_is_as_high_as_its_own_largest_weight():
    rows = np.array([np.full((2, 5), 3.0), [[0, 0, -1e-4, 0, 0]] * 2, np.zeros((2, 5))])
    made = gallery({"one": rows, "": rows[:1]}, "Rows.")
    check_sound(made)
    first, second = made.figure.axes
    heights = [np.abs(line.get_ydata()).max() for line in first.lines]
    assert np.allclose(heights, [1, 1, 0] * 2)
    assert [line.get_linestyle() for line in first.lines] == ["-"] * 3 + ["--"] * 3
    assert first.get_title(loc="left") == "one" and len(second.lines) == 2


def test_dots_stand_in_the_row_of_their_name_and_strokes_where_there_is_a_truth():
    values = {"arm": np.array([1.0, 2.0]), "spring": np.array([0.0])}
    made = readings({"M, kg m²": values}, "Dots.", {"M, kg m²": {"arm": 1.5}})
    check_sound(made)
    (axis,) = made.figure.axes
    found = {(line.get_marker(), *line.get_ydata()): list(line.get_xdata()) for line in axis.lines}
    assert found["o", 0, 0] == [1, 2] and found["o", 1] == [0] and found["|", 0] == [1.5]
    assert ("|", 1) not in found
    with pytest.raises(ValueError, match="names"):
        readings({"M, kg m²": values, "N, kg m²": {"arm": np.ones(1)}}, "Dots.")
