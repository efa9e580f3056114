"""Figures of learning in the loop: accessible, and true to what they are given."""

import numpy as np
import pytest
from pictures import check_sound, drawn, figures_in

from workshop.beyond.figures import learning

TRIALS = np.arange(1, 5)
ERRORS = np.array([[8.0, 4, 2, 1], [9.0, 5, 3, 2], [30.0, 6, 4, 3]]).T
PANELS = {"from nothing": {"none": (TRIALS, ERRORS), "one": (TRIALS, 2 * ERRORS)}}
LABELS = "trial", "error, mm"
MOTIONS = {
    "the same": {"one": np.array([0.1, 0.2, 0.9]), "two": np.array([1.0, 2.0, 3.0])},
    "faster": {"one": np.array([0.5, 0.6, 0.7]), "two": np.array([1.0, 4.0, 5.0])},
}
EXAMPLES = {
    "by_trial": lambda: learning.by_trial(PANELS, LABELS, "Falls.", change=(2.5, "a load")),
    "by_motion": lambda: learning.by_motion(MOTIONS, "error over that of the feedback", "Two."),
}


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(learning) == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)


def test_lines_are_medians_and_the_change_stands_where_it_was(made):
    axis = made["by_trial"][1].axes[0]
    lines = {line.get_label(): line for line in axis.lines}
    np.testing.assert_allclose(lines["none"].get_ydata(), [9, 5, 3, 2])
    np.testing.assert_allclose(lines["one"].get_ydata(), [18, 10, 6, 4])
    assert [2.5, 2.5] in [list(line.get_xdata()) for line in axis.lines]
    assert "a load" in [text.get_text() for text in axis.texts]


def test_marks_are_medians_and_bars_reach_over_all_seeds(made):
    axis = made["by_motion"][1].axes[0]
    marks = [line.get_xdata()[0] for line in axis.lines if len(line.get_xdata()) == 1]
    np.testing.assert_allclose(marks, [0.2, 2.0, 0.6, 4.0])
    bars = [list(line.get_xdata()) for line in axis.lines if len(line.get_xdata()) == 2][:4]
    np.testing.assert_allclose(bars, [[0.1, 0.9], [1, 3], [0.5, 0.7], [1, 5]])
    assert [t.get_text() for t in axis.get_yticklabels()] == list(MOTIONS)


def test_bad_values_are_refused():
    with pytest.raises(ValueError, match="panels"):
        learning.by_trial({}, LABELS, "")
    with pytest.raises(ValueError, match="'one'"):
        learning.by_trial({"a": {"one": (TRIALS, -ERRORS)}}, LABELS, "")
    with pytest.raises(ValueError, match="motions"):
        learning.by_motion({}, "x", "")
    with pytest.raises(ValueError, match="'one' on 'faster'"):
        learning.by_motion({"faster": {"one": np.zeros(3)}}, "x", "")
