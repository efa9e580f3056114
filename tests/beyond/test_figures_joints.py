"""Figures of the chapter on more joints: accessible, and true to what they are given."""

import numpy as np
import pytest
from pictures import boxes, check_sound, curves, drawn, figures_in, words

from ddlib.figures import COLOURS, FAINT
from workshop.beyond.figures import joints as figures_joints

SIZE = np.array([5, 10, 20])
ERRORS = np.array([[0.5, 0.7, 0.6], [0.3, 0.2, 0.1], [0.08, 0.09, 0.1]])
INERTIA = np.array([[2.0, 0.5], [0.6, 1.0]])
REAL = INERTIA + np.array([-0.1, 0.0, 0.1])[:, None, None]
NULL = np.linspace(-1.0, 1.0, 21)[:, None, None] * np.ones((2, 2))
LABELS = "training motions", "RMSS"
EXAMPLES = {
    "ladders": lambda: figures_joints.ladders(
        {"network": {"two joints": (SIZE, ERRORS)}, "linear": {"two joints": (SIZE, 2 * ERRORS)}},
        LABELS, "Errors.", level=0.2,
    ),
    "growth": lambda: figures_joints.growth(
        [2, 4, 7], [4, 9, 15], [[3, 8, 12], [5, 10, 20]], [4, 8, 14], LABELS, ("found", "a law"),
        "Growth.",
    ),
    "couplings": lambda: figures_joints.couplings(
        INERTIA, REAL, NULL, "gain over the deviation", "Gains."
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(figures_joints) == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)


def test_ladders_show_medians_and_the_level(made):
    picture, figure = made["ladders"]
    first, second = curves(figure, COLOURS[0])
    np.testing.assert_allclose(first, np.transpose([SIZE, np.median(ERRORS, 1)]))
    np.testing.assert_allclose(second[:, 1], 2 * np.median(ERRORS, 1))
    assert {tuple(line[:, 1]) for line in curves(figure, FAINT)} == {(0.2, 0.2)}
    bars = figure.axes[0].collections[0].get_segments()
    np.testing.assert_allclose(
        [b[:, 1] for b in bars], np.transpose([ERRORS.min(1), ERRORS.max(1)])
    )
    assert {"network", "linear", "two joints", *LABELS} <= set(words(picture))


def test_growth_shows_dots_intervals_and_a_line(made):
    picture, figure = made["growth"]
    (line,) = curves(figure, FAINT)
    np.testing.assert_allclose(line, [[2, 4], [4, 8], [7, 14]])
    (dots,) = (x.get_xydata() for x in figure.axes[0].lines if x.get_color() == COLOURS[0])
    np.testing.assert_allclose(dots[:, 1], [4, 9, 15])
    bars = figure.axes[0].collections[0].get_segments()
    np.testing.assert_allclose([b[:, 1] for b in bars], [[3, 5], [8, 10], [12, 20]])
    assert {"found", "a law", "2", "4", "7"} <= set(words(picture))


def test_couplings_show_the_arm_the_networks_and_the_null(made):
    picture, figure = made["couplings"]
    for j, axis in enumerate(figure.axes):
        levels = [b[0, 1] for b in axis.collections[0].get_segments()]
        np.testing.assert_allclose(levels, INERTIA[j])
        dots = np.array([x.get_ydata() for x in axis.lines if x.get_color() == COLOURS[0]])
        np.testing.assert_allclose(dots, REAL[:, j])
    bars = boxes(figure, FAINT)
    np.testing.assert_allclose(bars[:, [1, 3]], [[-0.9, 0.9]] * 4)
    assert {"torque 1", "torque 2", "the arm", "unrelated torques"} <= set(words(picture))


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="panels must hold one panel or more"):
        figures_joints.ladders({}, LABELS, "None.")
    with pytest.raises(ValueError, match="errors of 'two' must have shape"):
        figures_joints.ladders({"a": {"two": (SIZE, ERRORS[:2])}}, LABELS, "None.")
    with pytest.raises(ValueError, match="ends must have shape"):
        figures_joints.growth([2, 4], [1, 2], [[1, 2]], [1, 2], LABELS, ("a", "b"), "None.")
    with pytest.raises(ValueError, match="real must have shape"):
        figures_joints.couplings(INERTIA, REAL[:, :1], NULL, "gain", "None.")
