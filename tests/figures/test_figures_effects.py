"""Figures of the chapter on unmodelled effects: accessible, and true to the numbers given."""

import numpy as np
import pytest
from pictures import check_sound, curves, drawn, on_paper, words

from ddlib.figures import COLOURS, by_case
from workshop.chapters import what_lagrange_euler_leaves_out as figures_effects

X = np.linspace(1.0, 10.0, 5)
PANELS = {
    ("a", "b"): {"one": (X, X), "two": (X, X**2)},
    ("c", "d"): {"two": (X, 2 * X), "three": (X, 3 * X)},
    ("e", "f"): {"alone": (X, X)},
}
SIZES = {"small": [0.02, 0.01], "large": [8.0, 2.0], "middle": [0.5, 0.9]}
CASES = {"small swing": np.sin(X), "large swing": 3 * np.sin(X), "none": 0 * X}
EXAMPLES = {
    "cases": lambda: by_case(X, CASES, "time, s", "error, °", "three swings"),
    "panels": lambda: figures_effects.side_by_side(PANELS, "three panels"),
    "logarithmic": lambda: figures_effects.side_by_side(PANELS, "the same", log=True),
    "ranking": lambda: figures_effects.ranking(SIZES),
}


@pytest.fixture(scope="module")
def made():
    """Each picture, and the matplotlib figure behind it."""
    return {name: drawn(make) for name, make in EXAMPLES.items()}


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)
    assert len(figure.svg) < 150_000


def test_a_curve_looks_the_same_in_every_panel(made):
    """One: first colour, and the one that stands alone; two: second, twice; three: third."""
    assert [len(curves(made["panels"][1], c)) for c in COLOURS[:4]] == [2, 2, 1, 0]


def test_curves_are_drawn_to_scale(made):
    """Both axes linear: a straight line in both; logarithmic: a power is a line, twice as steep."""

    def paths(name):
        figure = made[name][1]
        return [on_paper(figure.axes[0], curves(figure, c)[0]) for c in COLOURS[:2]]

    line, square = paths("panels")
    assert np.ptp(np.diff(line[:, 1])) < 0.05 and np.ptp(np.diff(square[:, 1])) > 1
    one, two = paths("logarithmic")
    slopes = [np.diff(p[:, 1]) / np.diff(p[:, 0]) for p in (one, two)]
    np.testing.assert_allclose(slopes[1], 2 * slopes[0], rtol=0.01)


def test_each_case_has_a_title_and_the_quantity_on_its_axis(made):
    picture, figure = made["cases"]
    texts = words(picture)
    assert [text for text in texts if text in CASES] == list(CASES)
    assert texts.count("error, °") == 3 and texts.count("time, s") == 1
    swings = curves(figure, COLOURS[0])
    assert len(swings) == 3
    for swing, values in zip(swings, CASES.values()):
        np.testing.assert_array_equal(swing, np.stack([X, values], -1))


@pytest.mark.parametrize(
    ("cases", "label", "word"), [({}, "error, °", "cases"), (CASES, "elbow, °", "axis label")]
)
def test_cases_without_a_quantity_are_refused(cases, label, word):
    with pytest.raises(ValueError, match=word):
        by_case(X, cases, "time, s", label, "no figure")


def test_bars_stand_in_order_and_are_as_long_as_their_logarithms(made):
    picture, figure = made["ranking"]
    assert picture.alt == (
        "Bars of torque in N m for shoulder and elbow, largest first: large 8.0 and 2.0; "
        "middle 0.50 and 0.90; small 0.020 and 0.010."
    )
    (axis,) = figure.axes
    assert axis.get_xscale() == "log" and axis.yaxis_inverted()
    for j, container in enumerate(axis.containers):
        ends = [bar.get_x() + bar.get_width() for bar in container]
        np.testing.assert_allclose(ends, [SIZES[name][j] for name in ("large", "middle", "small")])
        assert (np.diff([bar.get_y() for bar in container]) > 0).all()
    assert [text for text in words(picture) if text in SIZES] == ["large", "middle", "small"]


def test_on_a_narrow_page_names_stand_above_their_bars():
    name = "encoder, acceleration by differences"
    assert name in figures_effects.ranking(SIZES | {name: [4.0, 1.0]}).narrow


@pytest.mark.parametrize("bad", [[0.0, 1.0], [-1.0, 1.0], [np.nan, 1.0], [1.0]])
def test_torques_without_a_logarithm_are_refused(bad):
    with pytest.raises(ValueError, match="sizes"):
        figures_effects.ranking({"good": [1.0, 1.0], "bad": bad})
