"""What predicts the end-point error: every member is a dot where it belongs."""

import numpy as np
import pytest
from pictures import drawn

from workshop.beyond.figures.run_time import against

GROUPS = {"11": (np.array([1.0, 2.0]), np.array([3.0, 4.0])), "21": (np.ones(3), np.ones(3) * 7)}
PANELS = {"RMSS": GROUPS, "error of the loop, mm": {"21": (np.ones(2) * 5, np.ones(2) * 6)}}


def test_a_dot_for_each_member_and_a_line_of_equal_values():
    picture, figure = drawn(
        lambda: against(PANELS, "error, mm", "two panels", equal=("error of the loop, mm",))
    )
    assert picture.alt == "two panels"
    first, second = figure.axes
    assert [axis.get_xlabel() for axis in figure.axes] == list(PANELS)
    assert first.get_ylabel() == "error, mm"
    for line, (x, y) in zip(first.lines, GROUPS.values(), strict=True):
        np.testing.assert_array_equal(line.get_xydata(), np.stack([x, y], -1))
        assert line.get_linestyle() == "None"
    dots, equal = second.lines
    assert equal.get_xydata().tolist() == [[5.0, 5.0], [6.0, 6.0]]
    # a group looks the same in every panel
    assert dots.get_color() == first.lines[1].get_color() != first.lines[0].get_color()
    assert dots.get_marker() == first.lines[1].get_marker() != first.lines[0].get_marker()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["11", "21"]


@pytest.mark.parametrize(
    "panels, words",
    [
        ({}, "panels must hold"),
        ({"RMSS": {"a": (np.array([1.0, -1.0]), np.ones(2))}}, "x of 'a' in 'RMSS' must be pos"),
        ({"RMSS": {"a": (np.ones(3), np.ones(2))}}, "y of 'a' in 'RMSS' must have shape"),
    ],
)
def test_against_refuses(panels, words):
    with pytest.raises(ValueError, match=words):
        against(panels, "error, mm", "alt")
