"""Figures of learning: every network a curve, the median on top, errors that name the family."""

import numpy as np
import pytest
from pictures import drawn

from ddlib.figures import COLOURS, Illustration, families
from workshop.chapters.convolution_filters import clusters
from workshop.chapters.why_smooth_filters import predicted_curves

X = np.linspace(1.0, 10.0, 6)
FAN = X[:, None] * [1.0, 2.0, 6.0]
LABELS = ("epoch", "error")


def by_width(figure, colour) -> dict[float, list[np.ndarray]]:
    """Points of the curves of a colour, by line width."""
    found = {}
    for line in (line for axis in figure.axes for line in axis.lines):
        if line.get_color() == colour and line.get_linestyle() != "None":
            found.setdefault(line.get_linewidth(), []).append(line.get_xydata())
    return found


def test_every_network_and_the_median_are_drawn():
    picture, figure = drawn(lambda: families({"": {"slow": (X, FAN)}}, LABELS, "three networks"))
    assert isinstance(picture, Illustration)
    curves = by_width(figure, COLOURS[0])
    for curve, values in zip(curves[0.6], FAN.T, strict=True):
        np.testing.assert_array_equal(curve, np.stack([X, values], -1))
    (median,) = curves[2.2]
    np.testing.assert_array_equal(median, np.stack([X, 2 * X], -1))


def test_a_family_looks_the_same_in_every_panel():
    panels = {"a": {"one": (X, FAN)}, "b": {"two": (X, FAN), "one": (X, FAN)}}
    picture, figure = drawn(lambda: families(panels, LABELS, "two panels", y_log=True))
    assert [len(by_width(figure, colour)[2.2]) for colour in COLOURS[:2]] == [2, 1]
    assert {axis.get_yscale() for axis in figure.axes} == {"log"}
    assert picture.alt == "two panels"


@pytest.mark.parametrize(
    "panels, words",
    [
        ({}, "panels must hold one panel or more"),
        ({"": {"a": (X, X)}}, "y of 'a' must have shape"),
        ({"": {"a": (X[:3], FAN)}}, "y of 'a' must have shape"),
        ({"": {"a": (X, FAN * np.nan)}}, "y of 'a' must be finite"),
    ],
)
def test_refusals(panels, words):
    with pytest.raises(ValueError, match=words):
        families(panels, LABELS, "text")


def test_clusters_draw_medians_and_the_wanted_value():
    groups = {"few, one": np.array([1.0, 2.0, 6.0]), "many": np.array([3.0, 3.0, 5.0, 9.0])}
    picture, figure = drawn(
        lambda: clusters({"left": (groups, 4.0), "right": (groups, 0.0)}, "N m", "Dots.")
    )
    few, many = (by_width(figure, COLOURS[k])[2.2] for k in (0, 1))
    assert [set(bar[:, 1]) for bar in (*few, *many)] == [{2.0}, {2.0}, {4.0}, {4.0}]  # two panels
    wanted = [line for axis in figure.axes for line in axis.lines if line.get_linestyle() == "--"]
    assert [set(line.get_ydata()) for line in wanted] == [{4.0}, {0.0}]
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


AXES = ("epoch", "change", "predicted change", "measured change")


def test_courses_and_their_ends():
    """Measured solid, predicted dashed in the same colour; ends beside a diagonal."""
    courses = {"slow": (X, 2 * X), "fast": (X**2, X**3)}
    ends = {"one": ([1e-3, 1.0], [1e-2, 1.0]), "two": ([10.0], [5.0])}
    picture, figure = drawn(lambda: predicted_curves(X, courses, ends, AXES, "Two."))
    left, right = figure.axes
    for k, (measured, predicted) in enumerate(courses.values()):
        dashed, solid = left.lines[2 * k : 2 * k + 2]
        assert (dashed.get_linestyle(), solid.get_linestyle()) == ("--", "-")
        assert dashed.get_color() == solid.get_color() == COLOURS[k]
        np.testing.assert_array_equal(solid.get_xydata(), np.stack([X, measured], -1))
        np.testing.assert_array_equal(dashed.get_xydata(), np.stack([X, predicted], -1))
    one, two, diagonal = (line.get_xydata().tolist() for line in right.lines)
    assert one == [[1e-3, 1e-2], [1.0, 1.0]] and two == [[10.0, 5.0]]
    assert diagonal == [[1e-3, 1e-3], [10.0, 10.0]]
    assert {axis.get_xscale() for axis in figure.axes} == {"log"}
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["slow", "fast", "predicted"]
    assert picture.alt == "Two."


@pytest.mark.parametrize(
    "courses, ends, words",
    [
        ({"a": (X, X[:3])}, {}, "values of 'a' must have shape"),
        ({"a": (X, -X)}, {}, "values of 'a' must"),
        ({"a": (X, X)}, {"b": (X, X[:3])}, "values of 'b' must have shape"),
        ({"a": (X, X)}, {"b": (X, 0 * X)}, "values of 'b' must"),
    ],
)
def test_courses_refuse_bad_arguments(courses, ends, words):
    with pytest.raises(ValueError, match=words):
        predicted_curves(X, courses, ends, AXES, "Two.")
