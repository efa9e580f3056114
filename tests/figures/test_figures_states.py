"""Figures of the chapter on the whole state space: accessible, and true to what they are given."""

import inspect
import re
import xml.etree.ElementTree as ET
from dataclasses import fields

import numpy as np
import pytest

from ddlib.figures import COLOURS, INK, Illustration
from ddlib.figures import states as figures_states
from ddlib.learning import Weights

SVG = "{http://www.w3.org/2000/svg}"
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
    return {name: make() for name, make in EXAMPLES.items()}


def strokes(figure, colour) -> list[np.ndarray]:
    """Vertices of the curves of a colour, y downwards."""
    found = []
    for element in ET.fromstring(figure.svg).iter(f"{SVG}path"):
        style = element.attrib.get("style", "")
        if f"stroke: {colour}" in style and "clip-path" in element.attrib:
            numbers = re.findall(r"[ML] ([\d.-]+) ([\d.-]+)", element.attrib["d"])
            found.append(np.array(numbers, float))
    return found


def boxes(figure, colour) -> np.ndarray:
    """Left, top, width, height of the filled rectangles of a colour."""
    found = []
    for element in ET.fromstring(figure.svg).iter(f"{SVG}path"):
        style = element.attrib.get("style", "")
        black = "fill:" not in style and "clip-path" in element.attrib  # SVG's default
        if f"fill: {colour}" in style or (black and colour == "#000000"):
            numbers = re.findall(r"[ML] ([\d.-]+) ([\d.-]+)", element.attrib["d"])
            corners = np.array(numbers, float)
            found.append([*corners.min(0), *np.ptp(corners, axis=0)])
    return np.array(found).reshape(-1, 4)


def test_every_figure_has_an_example():
    functions = inspect.getmembers(figures_states, inspect.isfunction)
    own = {n for n, f in functions if f.__module__ == figures_states.__name__ and n[0] != "_"}
    assert own == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure = made[name]
    assert isinstance(figure, Illustration)
    root = ET.fromstring(figure.svg)
    assert root.attrib["role"] == "img" and root.attrib["aria-label"] == figure.alt
    assert INK not in figure.svg and "currentColor" in figure.svg
    assert "nan" not in figure.alt and not re.search(r"\bnan\b", figure.svg)
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
    figure = figures_states.hinton_states(one_weight(field, index, value))
    units = boxes(figure, "#8c8c8c")
    assert len(units) == 12
    lefts, tops = np.unique(units[:, 0].round(1)), np.unique(units[:, 1].round(1))
    marks = [m for m in boxes(figure, colour) if m[2] > 1]
    assert len(marks) == 1
    x, y, w, h = marks[0]
    inside = [u for u in units if u[0] <= x and x + w <= u[0] + u[2] and u[1] <= y <= u[1] + u[3]]
    assert len(inside) == 1
    assert inside[0][0].round(1) == lefts[column] and inside[0][1].round(1) == tops[row]
    assert y + h <= inside[0][1] + inside[0][3]


def test_inputs_stand_in_their_order():
    places = []
    for joint, place in np.ndindex(2, 3):
        weights = one_weight("hidden_weights", (0, joint, place), 1.0)
        (mark,) = [m for m in boxes(figures_states.hinton_states(weights), "#ffffff") if m[2] > 1]
        places.append(mark[0])
    assert (np.diff(places) > 0).all() and np.ptp(np.diff(places)) < 0.1


def test_a_weight_between_units_is_seen_at_both_ends_and_area_is_size():
    weights = one_weight("output_weights", (1, 4), 4.0)
    weights.hidden_bias[0] = 1.0
    marks = boxes(figures_states.hinton_states(weights), "#ffffff")
    sides = np.sort(marks[marks[:, 2] > 0.5][:, 2])
    assert len(sides) == 3
    np.testing.assert_allclose(sides, sides[-1] * np.array([0.5, 1.0, 1.0]), rtol=0.01)


@pytest.mark.parametrize("hidden", [1, 5, 10])
def test_squares_do_not_overlap(hidden):
    weights = Weights.random(1, 3, hidden)[0]
    for name in (field.name for field in fields(Weights)):
        getattr(weights, name)[...] = 1.0
    marks = boxes(figures_states.hinton_states(weights), "#ffffff")
    assert len(marks) == 2 * (1 + hidden + 6) + hidden * (1 + 2 + 6)
    for k, (x, y, w, h) in enumerate(marks):
        others = np.delete(marks, k, 0)
        apart = (
            (x + w <= others[:, 0]) | (others[:, 0] + others[:, 2] <= x)
            | (y + h <= others[:, 1]) | (others[:, 1] + others[:, 3] <= y)
        )  # fmt: skip
        assert apart.all()


def test_the_bold_line_is_the_median_network(made):
    bold = max(strokes(made["torque_along"], COLOURS[1]), key=len)
    fine = max(strokes(made["torque_along"], "currentColor"), key=len)
    fit = np.polyfit(EXACT[:, 0], fine[:, 1], 1)  # picture's y of a torque
    drawn = (bold[:, 1] - fit[1]) / fit[0]
    np.testing.assert_allclose(drawn, EXACT[:, 0] + OFFSETS[1], atol=2e-3)
    assert "shoulder 0.02 N m, elbow 0.02 N m" in made["torque_along"].alt


def test_sizes_are_drawn_log_log(made):
    (line,) = [s for s in strokes(made["error_by_size"], COLOURS[0]) if len(s) == 2]
    (other,) = [s for s in strokes(made["error_by_size"], COLOURS[1]) if len(s) == 2]
    per_decade = [np.diff(s[:, 1])[0] / np.log10(r) for s, r in ((line, 10.0), (other, 2.0))]
    np.testing.assert_allclose(per_decade[0], per_decade[1], rtol=0.01)
    assert "solver: from 0.20 with 100 to 0.020 with 10,000 samples" in made["error_by_size"].alt


def test_one_input_swings_and_the_others_rest(made):
    assert "q1 0.00" in made["responses"].alt and "q2 1.00" in made["responses"].alt
    swings = [np.ptp(s[:, 1]) for s in strokes(made["responses"], COLOURS[1]) if len(s) > 2]
    assert sum(swing > 20 for swing in swings) == 4


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
        (lambda: figures_states.torque_along(T, EXACT, EXACT), "t, exact and predicted must"),
        (lambda: figures_states.torque_along(T, EXACT, PREDICTED, 0.0), "share must lie"),
        (lambda: figures_states.responses(X, ACTIVITY[0]), "activity must have shape"),
    ],
)
def test_refusals(make, words):
    with pytest.raises(ValueError, match=words):
        make()
