"""Every figure of the book: sound, accessible, small, and showing what it was given."""

import re
import warnings
import xml.etree.ElementTree as ET
from dataclasses import fields

import numpy as np
import pytest
from pictures import SVG, boxes as rectangles, curves as curves_of, drawn, on_paper, words

from ddlib import figures
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.figures import COLOURS, INK, Illustration
from ddlib.learning import Weights
from ddlib.trajectories import APPENDIX_I, random_extents
from workshop.chapters.convolution_filters import against_nulls
from workshop.chapters.dynamics import arm_sketch
from workshop.chapters.feedforward import feedforward_loop
from workshop.chapters.trajectories_and_recording import extents_square
from workshop.chapters.window_networks import overlay

NAMES = tuple(field.name for field in fields(Weights))
T = np.linspace(0, 3, 300)
RNG = np.random.default_rng(3)
FILTERS = RNG.normal(size=(60, 21)).cumsum(-1)

NULLS = {
    "hidden": {
        "velocity": {"real": np.full(5, 0.2), "one": np.full(3, 0.4), "two": np.full(4, 0.7)},
        "jerk": {"real": np.array([0.0, 0.2]), "one": np.zeros(3), "two": np.ones(4)},
    },
    "direct": {
        "velocity": {"real": np.zeros(5), "one": np.zeros(3), "two": np.zeros(4)},
        "jerk": {"real": np.ones(5), "one": np.zeros(3), "two": np.zeros(4)},
    },
}

EXAMPLES = {
    "curves": lambda: figures.curves(
        T,
        {"q, rad": {"shoulder": np.sin(T), "elbow": np.cos(T)}, "error": {"e": (T[1:], 1 / T[1:])}},
        "time, s",
        "Two joints over time, and an error.",
        y_log=False,
    ),
    "arm_sketch": lambda: arm_sketch(CMU_DD_ARM_II, [0.6, 0.9]),
    "extents_square": lambda: extents_square(APPENDIX_I[:5], APPENDIX_I[5], random_extents(200, 0)),
    "network_diagram": lambda: figures.network_diagram(Weights.random(1, 21)[0]),
    "overlay": lambda: overlay(
        T, np.sin(T), {"window 11": np.cos(T), "window 41": 0.9 * np.sin(T)}
    ),
    "hinton": lambda: figures.hinton(Weights.random(1, 41)[0]),
    "decomposition": lambda: figures.decomposition(
        {f"unit {k}": FILTERS[k] for k in range(3)}, 0.01
    ),
    "against_nulls": lambda: against_nulls(
        NULLS, "share of the filters", "Bars of shares, dots of draws."
    ),
    "feedforward_loop": feedforward_loop,
}


@pytest.fixture(scope="module")
def made():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return {name: make() for name, make in EXAMPLES.items()}


def ids(svg):
    return [e.attrib["id"] for e in ET.fromstring(svg).iter() if "id" in e.attrib]


each = pytest.mark.parametrize("name", EXAMPLES)


@each
def test_sound_and_accessible(made, name):
    figure = made[name]
    assert isinstance(figure, Illustration)
    root = ET.fromstring(figure.svg)
    assert root.tag == f"{SVG}svg" and root.attrib["role"] == "figure"
    assert root.attrib["aria-label"] == figure.alt and len(figure.alt) > 20
    assert "nan" not in figure.alt and not re.search(r"\bnan\b", figure.svg)
    assert "<style" not in figure.svg and "<script" not in figure.svg
    assert INK not in figure.svg
    assert "currentColor" in figure.svg or name == "hinton"  # which has no text
    assert len(figure.svg) < 400_000
    own = ids(figure.svg)
    assert len(own) == len(set(own))
    targets = {a or b for a, b in re.findall(r'href="#([^"]*)"|url\(#([^)]*)\)', figure.svg)}
    assert targets <= set(own)


def test_no_two_figures_share_an_id(made):
    everything = [i for figure in made.values() for i in ids(figure.svg)]
    assert len(everything) == len(set(everything)) > 20


@each
def test_text_follows_the_page(made, name):
    """Nothing but the signs of a Hinton diagram is painted black or white."""
    colours = set(re.findall(r"(?:fill|stroke): (#[0-9a-f]{6}|white|black)", made[name].svg))
    fixed = colours & {"#000000", "#ffffff"}
    assert not fixed or (name, fixed) in [("hinton", {"#ffffff"}), ("arm_sketch", {"#ffffff"})]


# --- curves -----------------------------------------------------------------------------


def test_curves_go_where_the_data_goes():
    x = np.linspace(0, 1, 7)
    y = np.array([0.0, 3.0, 1.0, 4.0, 1.0, 5.0, 9.0])
    panels = {"y": {"first": y, "second": -y}, "z": {"second": (x[:3], y[:3])}}
    _, figure = drawn(lambda: figures.curves(x, panels, "x", "Three curves."))
    found = [curves_of(figure, colour) for colour in COLOURS[:3]]
    assert list(map(len, found)) == [1, 2, 0]  # the same curve looks the same in every panel
    for line, wanted in zip([*found[0], *found[1]], ((x, y), (x, -y), (x[:3], y[:3]))):
        np.testing.assert_array_equal(line, np.stack(wanted, -1))


@pytest.mark.parametrize("count, columns", [(1, 2), (3, 2), (2, 3)])
def test_curves_label_every_bottom_axis(count, columns):
    panels = {f"panel {k}": {"a": T} for k in range(count)}
    texts = words(figures.curves(T, panels, "the common axis", "Panels.", columns=columns))
    assert texts.count("the common axis") == min(count, columns)
    assert all(texts.count(label) == 1 for label in panels)


def test_logarithmic_axes_straighten_a_power_law():
    x = np.geomspace(1, 1000, 9)
    panels = {"y": {"a": 5 * x**-0.5}}
    _, figure = drawn(lambda: figures.curves(x, panels, "x", "A line.", x_log=True, y_log=True))
    line = on_paper(figure.axes[0], curves_of(figure, COLOURS[0])[0])
    np.testing.assert_allclose(np.diff(line, 2, axis=0), 0, atol=1e-6)


# --- the others' numbers ------------------------------------------------------------------


def test_alt_texts_say_the_numbers(made):
    assert "q1 = 34 degrees" in made["arm_sketch"].alt
    assert "39.5 and 14.4 degrees" in made["extents_square"].alt
    assert "2 times 21 inputs, 10 hidden units and 2 outputs" in made["network_diagram"].alt
    worst = np.sqrt(np.mean((np.sin(T) - np.cos(T)) ** 2))
    assert f"{worst:.2f} N m" in made["overlay"].alt and "window 11" in made["overlay"].alt


def test_one_panel_is_enough():
    one = overlay(T, np.sin(T), {"window 21": np.cos(T)})
    assert words(one).count("window 21") == 1
    assert "only" in figures.decomposition({"only": FILTERS[0]}, 0.01).alt


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: arm_sketch(CMU_DD_ARM_II, [0.1, np.nan]), "q must be finite"),
        (lambda: arm_sketch(CMU_DD_ARM_II, [0.1]), "q must have"),
        (lambda: extents_square(APPENDIX_I[:5], [np.inf, 0.0]), "test must be finite"),
        (lambda: figures.decomposition({"a": np.ones(10)}, 0.01), "f must have an odd"),
        (lambda: against_nulls({}, "share", "Bars."), "panels must hold"),
        (lambda: against_nulls({"a": {"b": {"c": [[1.0]]}}}, "share", "Bars."), "of 'b'"),
        (lambda: figures.curves(T, {"y": {"a": T}}, "x", " "), "alt must describe"),
        (lambda: figures.hinton(Weights.random(3, 11)), "weights must be of one network"),
        (lambda: figures.hinton(scaled(0.0)), "weights must be finite and not all zero"),
        (lambda: figures.hinton(scaled(np.nan)), "weights must be finite and not all zero"),
    ],
)
def test_refusals(make, message):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match=message):
            make()


# --- shares beside nulls ------------------------------------------------------------------


def test_bars_end_at_the_mean_and_every_draw_has_a_dot():
    _, figure = drawn(
        lambda: against_nulls(NULLS, "share of the filters", "Bars of shares, dots of draws.")
    )
    left, right, *_ = (axis for axis in figure.axes if axis.lines)
    assert [axis.get_title(loc="left") for axis in (left, right)] == ["hidden", "direct"]
    assert [bar.get_width() for bar in left.patches] == pytest.approx([0.2, 0.1])
    assert [bar.get_width() for bar in right.patches] == pytest.approx([0, 1])
    dots = [line for line in left.lines if line.get_label() in ("one", "two")]
    found = [(sorted(set(line.get_xdata())), line.get_color()) for line in dots]
    assert found == [
        ([0.4], COLOURS[0]), ([0.7], COLOURS[1]), ([0.0], COLOURS[0]), ([1.0], COLOURS[1]),
    ]  # fmt: skip
    rows = [line.get_ydata()[0] for line in dots]
    assert all(abs(y - row) < 0.4 for y, row in zip(rows, (0, 0, 1, 1)))
    assert [t.get_text() for t in left.get_yticklabels()] == ["velocity", "jerk"]
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["real", "one", "two"]


# --- Hinton diagrams ----------------------------------------------------------------------


def scaled(factor):
    weights = Weights.random(1, 11, hidden=5)[0]
    return Weights(*(factor * getattr(weights, name) for name in NAMES))


def squares(weights):
    """Centre, side and whiteness of every square, the units' left, right, top, bottom.

    In units of the largest square, y downwards, as one reads.
    """
    _, figure = drawn(lambda: figures.hinton(weights))
    found = []
    for white, colour in ((True, "#ffffff"), (False, "#000000")):
        for left, bottom, right, top in rectangles(figure, colour):
            assert right - left == pytest.approx(top - bottom)
            found.append(((left + right) / 2, -(bottom + top) / 2, right - left, white))
    return np.array(found), rectangles(figure, "#8c8c8c")[:, [0, 2, 3, 1]] * [1, 1, -1, -1]


def everything(weights):
    """All weights; those between hidden and output units are shown at both ends."""
    names = (*NAMES, "output_weights")
    return np.concatenate([getattr(weights, name).ravel() for name in names])


@pytest.mark.parametrize("width, hidden", [(11, 10), (21, 3)])
def test_area_is_size_and_white_is_positive(width, hidden):
    weights = Weights.random(1, width, hidden, seed=width)[0]
    marks, boxes = squares(weights)
    values = everything(weights)
    assert len(marks) == len(values) and len(boxes) == hidden + 2
    for white, some in ((True, values[values > 0]), (False, -values[values < 0])):
        sides = np.sort(marks[marks[:, 3] == white, 2])
        assert len(sides) == len(some)
        wanted = np.sqrt(np.sort(some) / weights.largest) * marks[:, 2].max()
        np.testing.assert_allclose(sides, wanted)
    assert np.ptp(boxes[:, 1] - boxes[:, 0]) < 1e-9  # units of one size
    for x, y, side, _ in marks:  # each square inside one unit
        inside = (boxes[:, 0] < x - side / 2) & (x + side / 2 < boxes[:, 1])
        inside &= (boxes[:, 2] < y - side / 2) & (y + side / 2 < boxes[:, 3])
        assert inside.sum() == 1


def test_squares_do_not_overlap():
    ones = Weights(*(np.sign(getattr(scaled(1.0), name)) for name in NAMES))
    marks, _ = squares(ones)
    gap = np.abs(marks[:, None, :2] - marks[None, :, :2]).max(-1)  # of centres
    np.fill_diagonal(gap, np.inf)
    assert gap.min() >= marks[:, 2].max() - 1e-9


def only(**arrays):
    """A network of window 11 with a few weights, the rest zero."""
    zero = scaled(0.0)
    return Weights(*(arrays.get(name, getattr(zero, name)) for name in NAMES))


def visible(weights):
    marks, boxes = squares(weights)
    return marks[marks[:, 2] > 0], boxes[np.lexsort((boxes[:, 0], boxes[:, 2].round()))]


def unit_of(mark, boxes):
    x, y = mark[:2]
    inside = (boxes[:, 0] < x) & (x < boxes[:, 1]) & (boxes[:, 2] < y) & (y < boxes[:, 3])
    return int(np.flatnonzero(inside)[0])


@pytest.mark.parametrize("unit, place", [(0, 2), (1, 3), (4, 6)])
def test_windows_run_to_the_right_with_the_shoulder_above(unit, place):
    """Of hidden unit k: box k + 2, counted by rows from the top left."""
    window = np.zeros((5, 2, 11))
    window[unit, 0] = np.arange(1, 12)
    window[unit, 1] = -np.arange(1, 12)
    marks, boxes = visible(only(hidden_weights=window))
    assert len(marks) == 22 and {unit_of(m, boxes) for m in marks} == {place}
    upper, lower = marks[marks[:, 3] == 1], marks[marks[:, 3] == 0]
    assert upper[:, 1].max() < lower[:, 1].min()  # y runs downwards
    for row in (upper, lower):
        assert np.ptp(row[:, 1]) < 0.05
        row = row[row[:, 0].argsort()]
        np.testing.assert_allclose((row[:, 2] / row[-1, 2]) ** 2, np.arange(1, 12) / 11, atol=0.02)
        np.testing.assert_allclose(np.diff(row[:, 0], 2), 0, atol=0.05)
    box = boxes[place]
    assert upper[:, 1].min() > (box[2] + box[3]) / 2  # the lower half of the unit


def test_direct_weights_lie_in_the_output_units():
    skip = np.zeros((2, 2, 11))
    skip[0, 0, 0], skip[1, 1, 10] = 1.0, -1.0
    (first, second), boxes = visible(only(direct_weights=skip))
    assert (unit_of(first, boxes), unit_of(second, boxes)) == (0, 1)
    assert first[3] == 1 and second[3] == 0
    assert first[0] < boxes[0, :2].mean() and second[0] > boxes[1, :2].mean()


def test_one_weight_is_shown_at_both_of_its_ends():
    """From hidden unit 2 to the elbow: in the output unit's row and on top of the hidden unit."""
    weights = np.zeros((2, 5))
    weights[1, 2] = 1.0
    marks, boxes = visible(only(output_weights=weights))
    assert sorted(unit_of(m, boxes) for m in marks) == [1, 4]
    assert all(m[1] < boxes[unit_of(m, boxes), 2:].mean() for m in marks)  # upper half


def test_biases_are_at_the_upper_left():
    marks, boxes = visible(only(hidden_bias=np.ones(5), output_bias=-np.ones(2)))
    assert sorted(unit_of(m, boxes) for m in marks) == list(range(7))
    for mark in marks:
        k = unit_of(mark, boxes)
        assert mark[0] < boxes[k, 0] + 0.3 * (boxes[k, 1] - boxes[k, 0])
        assert mark[1] < boxes[k, 2:].mean()
        assert mark[3] == (k > 1)
