"""Hinton diagrams: area is size, white is positive, and each weight lies where it belongs."""

from dataclasses import fields

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from pictures import boxes, check, drawn

from ddlib.figures import ROLES, hinton, squares as squares_of
from ddlib.figures.weights import hinton_on, relative_weights
from ddlib.learning import Weights
from workshop.chapters.whole_state_space import hinton_states

NAMES = tuple(field.name for field in fields(Weights))

diagrams = pytest.mark.parametrize(
    "diagram, width", [(hinton, 11), (hinton, 21), (hinton_states, 3)]
)


def planted(width: int, rest: float = 0.0, hidden: int = 5, **values) -> Weights:
    """A network with all weights `rest`, but for ``field={index: value}``."""
    weights = Weights.random(1, width, hidden)[0]
    for name in NAMES:
        getattr(weights, name)[...] = rest
        for index, value in values.get(name, {}).items():
            getattr(weights, name)[index] = value
    return weights


def squares(diagram, weights) -> tuple[np.ndarray, np.ndarray]:
    """Centre, side and sign of every square; left, right, top, bottom of units as one reads.

    y runs downwards.
    """
    picture, figure = drawn(lambda: diagram(weights))
    check(picture, figure, upon="#ffffff")
    marks = []
    for sign, colour in ((1, "#ffffff"), (-1, "#000000")):
        for left, bottom, right, top in boxes(figure, colour):
            assert right - left == pytest.approx(top - bottom)
            marks.append(((left + right) / 2, -(bottom + top) / 2, right - left, sign))
    units = boxes(figure, "#8c8c8c")[:, [0, 2, 3, 1]] * [1, 1, -1, -1]
    return np.array(marks), units[np.lexsort((units[:, 0], units[:, 2].round()))]


def units_of(marks, units) -> list[int]:
    """The unit that each square lies in; a square lies in one unit, and all of it."""
    centre, half = marks[:, None, :2], marks[:, None, 2:3] / 2
    inside = (units[:, 0::2] <= centre - half) & (centre + half <= units[:, 1::2])
    assert (inside.all(-1).sum(1) == 1).all()
    return inside.all(-1).argmax(1).tolist()


@diagrams
def test_area_is_size_and_white_is_positive(diagram, width):
    """Weights between hidden and output units are seen at both ends."""
    weights = Weights.random(1, width, seed=width)[0]
    marks, units = squares(diagram, weights)
    values = np.concatenate([getattr(weights, n).ravel() for n in (*NAMES, "output_weights")])
    area = np.sort(marks[:, 3] * marks[:, 2] ** 2)
    np.testing.assert_allclose(area / abs(area).max(), np.sort(values) / weights.largest)
    assert len(units) == 12 and set(units_of(marks, units)) == set(range(12))


@diagrams
@pytest.mark.parametrize("hidden", [1, 5, 10])
def test_squares_do_not_overlap(diagram, width, hidden):
    marks, _ = squares(diagram, planted(width, 1.0, hidden))
    apart = np.abs(marks[:, None, :2] - marks[None, :, :2]).max(-1)
    np.fill_diagonal(apart, np.inf)
    assert apart.min() >= marks[:, 2].max() - 1e-9


@diagrams
def test_each_weight_lies_in_its_unit(diagram, width):
    """Units as one reads: two outputs, then the hidden ones; biases at the upper left."""
    for field, index, places in (
        ("hidden_weights", (3, 0, 1), [5]),
        ("hidden_bias", 4, [6]),
        ("direct_weights", (1, 1, 0), [1]),
        ("output_bias", 0, [0]),
        ("output_weights", (1, 2), [1, 4]),
    ):
        for value in (2.0, -2.0):
            marks, units = squares(diagram, planted(width, **{field: {index: value}}))
            assert sorted(units_of(marks, units)) == places and set(marks[:, 3]) == {np.sign(value)}
            if "bias" in field:
                left, right, top, bottom = units[places[0]]
                assert marks[0, 0] < left + 0.3 * (right - left)
                assert marks[0, 1] < (top + bottom) / 2


@diagrams
def test_inputs_stand_in_their_order(diagram, width):
    """From left to right; the shoulder's above the elbow's, or before them in one row."""
    shoulder = {(1, 0, k): k + 1.0 for k in range(width)}
    elbow = {(1, 1, k): -k - 1.0 for k in range(width)}
    marks, units = squares(diagram, planted(width, hidden_weights=shoulder | elbow))
    assert units_of(marks, units) == [3] * 2 * width
    upper, lower = (m[m[:, 0].argsort()] for m in (marks[:width], marks[width:]))
    for row in (upper, lower):
        np.testing.assert_allclose((row[:, 2] / row[-1, 2]) ** 2, np.arange(1, width + 1) / width)
        np.testing.assert_allclose(np.diff(row[:, 0], 2), 0, atol=1e-9)
        assert np.ptp(row[:, 1]) < 1e-9
    if diagram is hinton:
        assert upper[0, 1] < lower[0, 1]
    else:
        assert upper[0, 1] == lower[0, 1] and upper[-1, 0] < lower[0, 0]
    assert upper[0, 1] > units[3, 2:].mean()  # below biases and weights to the outputs


def test_each_row_has_a_scale_of_its_own():
    """Or is given that of another network, which cuts what is larger."""
    weights = Weights.random(1, 11, 5)[0]
    weights.hidden_weights[2, 1] *= 1e-3
    marks, _ = squares(lambda each: hinton(each, scale="row"), weights)
    shown = relative_weights(weights, "row")
    values = np.concatenate([getattr(shown, n).ravel() for n in (*NAMES, "output_weights")])
    np.testing.assert_allclose(np.sort(marks[:, 3] * marks[:, 2] ** 2), np.sort(values))
    np.testing.assert_allclose(np.abs(shown.hidden_weights).max(-1), 1)
    np.testing.assert_allclose(np.abs(shown.direct_weights).max(-1), 1)
    row = weights.hidden_weights[2, 1]
    np.testing.assert_allclose(shown.hidden_weights[2, 1], row / np.abs(row).max())
    half = Weights(*(getattr(weights, name) / 2 for name in NAMES))
    for scale in ("row", "network"):
        small = relative_weights(half, scale, weights)
        assert small.largest == pytest.approx(0.5)
        assert relative_weights(weights, scale, half).largest == 1


@pytest.mark.parametrize("unit, joint", [(1, 0), (2, 1), (5, 0)])
def test_a_row_gets_a_frame(unit, joint):
    """Which holds all squares of this row, and no others."""
    rest = Weights.random(1, 11, 5)[0]
    axis = Figure().subplots()
    hinton_on(axis, rest, ring=(unit, joint))
    frame = next(
        p for p in axis.patches if to_hex(p.get_edgecolor()) == ROLES["window"][1]
    ).get_bbox()
    inside = [
        p
        for p in axis.patches
        if p.get_bbox().width <= 1 and frame.contains(*p.get_bbox().get_points().mean(0))
    ]
    rows = np.concatenate([rest.direct_weights, rest.hidden_weights])
    found = sorted(
        p.get_bbox().width ** 2 * (1 if to_hex(p.get_facecolor()) == "#ffffff" else -1)
        for p in inside
    )
    np.testing.assert_allclose(found, np.sort(rows[unit, joint]) / rest.largest)


def test_rows_of_squares_are_areas_beside_their_names():
    """Two rows of two joints; a row that is drawn to the scale of another one is cut there."""
    rows = np.array([[[1.0, -4, 0], [2, 2, -2]], [[0, 9, -1], [-1, 0.25, 1]]])
    scale = rows * [[[1.0], [4]], [[0.5], [1]]]
    picture, figure = drawn(lambda: squares_of(rows, ("first", "second"), scale=scale))
    check(picture, figure, upon="#ffffff")
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["first", "second"]
    for joint, axis in enumerate(figure.axes):
        found = np.zeros((2, 3))
        for square in axis.patches[1:]:
            x, y = np.add(square.get_xy(), square.get_width() / 2).round().astype(int)
            sign = 1 if to_hex(square.get_facecolor()) == "#ffffff" else -1
            found[y, x] = sign * square.get_width() * square.get_height()
        most = abs(scale[:, joint]).max(-1, keepdims=True)
        np.testing.assert_allclose(found / 0.9, np.clip(rows[:, joint] / most, -1 / 0.9, 1 / 0.9))


@pytest.mark.parametrize("wrong", [{"names": ["one"]}, {"scale": np.ones((2, 3))}])
def test_rows_of_squares_need_a_name_and_a_scale_each(wrong):
    with pytest.raises((TypeError, ValueError), match=next(iter(wrong))):
        squares_of(**{"rows": np.ones((2, 2, 3)), "names": ["a", "b"], **wrong})
