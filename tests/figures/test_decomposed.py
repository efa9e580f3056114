"""Rows of weights taken apart: the curves are the parts, the squares the weights."""

import numpy as np
import pytest
from matplotlib.collections import PathCollection
from matplotlib.colors import to_hex
from pictures import boxes, check, drawn

from ddlib.figures import decomposed

X = np.arange(-5, 6)
ROWS = {
    "line": 0.5 * X,
    "parabola": X**2.0 + 2,
    "rough": np.random.default_rng(1).normal(size=11),
    "one weight": 3.0 * (X == 2),
}


@pytest.mark.parametrize("given", [ROWS["rough"], ROWS])
def test_curves_are_a_row_and_parts_that_add_up_to_it(given):
    picture, figure = drawn(lambda: decomposed(given, 0.02))
    check(picture, figure, upon="#ffffff")
    rows = given if isinstance(given, dict) else {"": given}
    assert len(figure.axes) == len(rows)
    for axis, (title, f) in zip(figure.axes, rows.items()):
        assert title in (axis.get_title(), axis.get_title(loc="left"))
        lines = {line.get_label(): line.get_ydata() for line in axis.lines}
        np.testing.assert_allclose(axis.lines[0].get_xdata(), 20 * X)
        np.testing.assert_allclose(lines["weights"], f)
        np.testing.assert_allclose(lines["constant"] + lines["even"] + lines["odd"], f, atol=1e-12)
        np.testing.assert_allclose(lines["even"], lines["even"][::-1], atol=1e-12)
        np.testing.assert_allclose(lines["odd"], -lines["odd"][::-1], atol=1e-12)
        assert lines["even"].mean() == pytest.approx(0, abs=1e-12)


def test_squares_are_the_weights_and_lie_above_the_curves():
    _, figure = drawn(lambda: decomposed(ROWS, 0.02))
    for axis, f in zip(figure.axes, ROWS.values()):
        (squares,) = (c for c in axis.collections if isinstance(c, PathCollection))
        places, area = squares.get_offsets(), squares.get_sizes()
        np.testing.assert_allclose(places[:, 0], 20 * X)
        np.testing.assert_allclose(area / area.max(), np.abs(f) / np.abs(f).max())
        colours = [to_hex(colour) for colour in squares.get_facecolors()]
        assert all(c == ("#ffffff" if w > 0 else "#000000") for c, w in zip(colours, f) if w)
        low, high = axis.get_ylim()
        drawn_to = max(line.get_ydata().max() for line in axis.lines)
        assert (drawn_to - low) / (high - low) < 0.84 and max(axis.get_yticks()) <= high * 0.84
        side = np.sqrt(area.max()) * figure.dpi / 72  # pixels
        assert side < 0.16 * axis.get_window_extent().height
        assert side < np.diff(axis.transData.transform([[0, 0], [20, 0]])[:, 0])[0]
    assert len(boxes(figure, "#8c8c8c")) == len(ROWS)


def test_the_text_tells_the_shares_of_the_parts():
    picture = decomposed({"line": ROWS["line"], "parabola": ROWS["parabola"]}, 0.01)
    assert "line: constant 0 %, even 0 %, odd 100 %" in picture.alt
    assert "odd 0 %" in picture.alt.partition("parabola")[2]
    assert picture.narrow


@pytest.mark.parametrize("f", [np.zeros(5), np.ones(3)])
def test_rows_without_a_shape_are_drawn(f):
    drawn(lambda: decomposed(f, 0.01))
