"""Figures of the chapter on the whole state space: accessible, and true to what they are given."""

from dataclasses import fields

import numpy as np
import pytest
from pictures import boxes, check_sound, curves, drawn, figures_in, on_paper

from ddlib.figures import COLOURS, INK
from ddlib.learning import Weights
from workshop.chapters import whole_state_space as figures_states

RNG = np.random.default_rng(0)
T = np.linspace(0.0, 3.0, 50)
EXACT = np.stack([np.sin(T), 0.1 * np.cos(T)], -1)
OFFSETS = np.array([0.01, 0.02, 0.05])
PREDICTED = EXACT + OFFSETS[:, None, None]
X = np.linspace(-1.0, 1.0, 9)
ACTIVITY = np.zeros((2, 3, 9, 4))
ACTIVITY[1, 0] = np.linspace(0.0, 1.0, 9)[:, None]
PANELS = {
    "samples": {
        "solver": {100: [0.4, 0.2, 0.1], 10_000: [0.05, 0.02, 0.01]},
        "descent": {100: [0.3, 0.3]},
    },
    "units": {"descent": {5: [0.2], 80: [0.1]}},
}
EXAMPLES = {
    "hinton_states": lambda: figures_states.hinton_states(Weights.random(1, 3)[0]),
    "torque_along": lambda: figures_states.torque_along(T, EXACT, PREDICTED),
    "error_by_size": lambda: figures_states.error_by_size(PANELS),
    "responses": lambda: figures_states.responses(X, ACTIVITY),
}


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(figures_states) == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)
    assert "nan" not in figure.alt
    assert len(figure.svg) < 150_000


def one_weight(field, index, value) -> Weights:
    """A network with one weight of 1 that is seen nowhere else, and one of `value`."""
    weights = Weights.random(1, 3)[0]
    for name in (field.name for field in fields(Weights)):
        getattr(weights, name)[...] = 0.0
    getattr(weights, field)[index] = value
    return weights


@pytest.mark.parametrize(
    "field, index, row, column",
    [
        ("hidden_weights", (0, 0, 0), 1, 0),
        ("hidden_weights", (0, 1, 2), 1, 0),
        ("hidden_weights", (3, 0, 1), 2, 1),
        ("hidden_bias", (9,), 5, 1),
        ("direct_weights", (1, 1, 0), 0, 1),
        ("output_bias", (0,), 0, 0),
    ],
)
@pytest.mark.parametrize("value, colour", [(2.0, "#ffffff"), (-2.0, "#000000")])
def test_each_weight_lies_in_its_unit(field, index, row, column, value, colour):
    units, marks = hinton(one_weight(field, index, value), colour)
    assert len(units) == 12 and len(marks) == 1
    lefts, tops = np.unique(units[:, 0]), np.unique(-units[:, 3])
    (place,) = (unit for unit in units if inside(marks[0], unit))
    assert place[0] == lefts[column] and -place[3] == tops[row]


def hinton(weights, colour="#ffffff") -> tuple[np.ndarray, np.ndarray]:
    """Rectangles of the units, and of the weights of a colour but that of 1 elsewhere."""
    _, figure = drawn(lambda: figures_states.hinton_states(weights))
    return boxes(figure, "#8c8c8c"), boxes(figure, colour)


def inside(mark, unit) -> bool:
    return bool((mark[:2] >= unit[:2]).all() and (mark[2:] <= unit[2:]).all())


def test_inputs_stand_in_their_order():
    places = []
    for joint, place in np.ndindex(2, 3):
        _, (mark,) = hinton(one_weight("hidden_weights", (0, joint, place), 1.0))
        places.append(mark[0])
    assert (np.diff(places) > 0).all() and np.ptp(np.diff(places)) < 1e-9


def test_a_weight_between_units_is_seen_at_both_ends_and_area_is_size():
    weights = one_weight("output_weights", (1, 4), 4.0)
    weights.hidden_bias[0] = 1.0
    _, marks = hinton(weights)
    sides = np.sort(marks[:, 2] - marks[:, 0])
    np.testing.assert_allclose(sides, sides[-1] * np.array([0.5, 1.0, 1.0]))


@pytest.mark.parametrize("hidden", [1, 5, 10])
def test_squares_do_not_overlap(hidden):
    weights = Weights.random(1, 3, hidden)[0]
    for name in (field.name for field in fields(Weights)):
        getattr(weights, name)[...] = 1.0
    _, marks = hinton(weights)
    assert len(marks) == 2 * (1 + hidden + 6) + hidden * (1 + 2 + 6)
    for k, (left, bottom, right, top) in enumerate(marks):
        others = np.delete(marks, k, 0).T
        apart = (
            (right <= others[0]) | (others[2] <= left) | (top <= others[1]) | (others[3] <= bottom)
        )
        assert apart.all()


def test_the_bold_line_is_the_median_network(made):
    picture, figure = made["torque_along"]
    bold, fine = (curves(figure, colour) for colour in (COLOURS[1], INK))
    for joint in range(2):
        np.testing.assert_array_equal(fine[joint], np.stack([T, EXACT[:, joint]], -1))
        np.testing.assert_array_equal(bold[joint], np.stack([T, PREDICTED[1, :, joint]], -1))
    assert "shoulder 0.02 N m, elbow 0.02 N m" in picture.alt


def test_sizes_are_drawn_log_log(made):
    picture, figure = made["error_by_size"]
    paths = []
    for colour in COLOURS[:2]:
        pairs = [(a, c) for a in figure.axes for c in a.lines if c.get_color() == colour]
        paths += [on_paper(a, c.get_xydata()) for a, c in pairs if len(set(c.get_xdata())) == 2]
    per_decade = [
        np.diff(p[:, 1])[0] / np.log10(r) for p, r in zip(paths, (10.0, 2.0), strict=True)
    ]
    np.testing.assert_allclose(per_decade[0], per_decade[1])
    assert "solver: from 0.20 with 100 to 0.020 with 10,000 samples" in picture.alt


def test_one_input_swings_and_the_others_rest(made):
    picture, figure = made["responses"]
    assert "q1 0.00" in picture.alt and "q2 1.00" in picture.alt
    swings = [[np.ptp(line.get_ydata()) for line in axis.lines] for axis in figure.axes]
    assert swings == [[0.0] * 4] * 3 + [[1.0] * 4] + [[0.0] * 4] * 2


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: figures_states.hinton_states(Weights.random(2, 3)), "weights must be of one"),
        (lambda: figures_states.hinton_states(Weights.random(1, 5)[0]), "weights must be of one"),
        (
            lambda: figures_states.hinton_states(one_weight("hidden_bias", 0, np.nan)),
            "weights must be finite",
        ),
        (
            lambda: figures_states.hinton_states(one_weight("hidden_bias", 0, 0.0)),
            "not all zero",
        ),
        (lambda: figures_states.torque_along(T, EXACT, EXACT), "predicted must"),
        (lambda: figures_states.torque_along(T, EXACT, PREDICTED, 0.0), "share must lie"),
        (lambda: figures_states.responses(X, ACTIVITY[0]), "activity must have shape"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()
