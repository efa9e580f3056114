"""Figures of the chapter on stirring: accessible, and true to what they are given."""

import re

import numpy as np
import pytest
from pictures import check_sound, drawn, figures_in

from workshop.beyond.figures import stirring as figures_stirring

PHASE = np.linspace(0, 2 * np.pi, 40)
WANTED = np.stack([np.cos(PHASE), np.sin(PHASE)], -1)
OFF = WANTED + np.array((0.01, -0.02))
POINTS = {"one": ([1.0, 2.0], [30.0, 20.0]), "other": ([3.0], [4.0])}
STATES = np.arange(24.0).reshape(4, 6)
EXAMPLES = {
    "traded": lambda: figures_stirring.traded(
        POINTS, (10.0, 15.0), ("error there, mm", "error here, mm"), "Dots."
    ),
    "paths": lambda: figures_stirring.paths(
        WANTED, {"none": OFF, "exact": WANTED}, 10, "Two paths.", columns=2
    ),
    "two_families": lambda: figures_stirring.two_families(
        {"first": STATES, "second": -STATES}, "Two clouds."
    ),
}


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(figures_stirring) == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)


def test_dots_and_lines_are_where_they_belong(made):
    (axis,) = made["traded"][1].axes
    lines = {line.get_label(): line.get_xydata() for line in axis.lines}
    np.testing.assert_array_equal(lines["one"], np.transpose(POINTS["one"]))
    crossing = [line for line in axis.lines if line.get_label()[0] == "_"]
    assert crossing[0].get_xdata()[0] == 10 and crossing[1].get_ydata()[0] == 15


def test_errors_are_exaggerated_and_the_path_is_not(made):
    none, exact = made["paths"][1].axes
    np.testing.assert_allclose(none.lines[0].get_xydata(), WANTED)
    np.testing.assert_allclose(none.lines[1].get_xydata(), WANTED + np.array((0.1, -0.2)))
    np.testing.assert_allclose(exact.lines[1].get_xydata(), WANTED)


def test_states_are_shoulder_against_elbow(made):
    for k, axis in enumerate(made["two_families"][1].axes):
        first, second = (patch.get_path().vertices[::2] for patch in axis.patches)
        np.testing.assert_array_equal(first, STATES[:, [k, k + 3]])
        np.testing.assert_array_equal(second, -first)


def test_thousands_of_states_are_few_elements_and_none_is_dropped():
    states = np.random.default_rng(0).normal(size=(3000, 6))
    svg = figures_stirring.two_families({"only": states, "other": states + 1}, "Clouds.").svg
    assert svg.count("<use") < 100 and svg.count("<path") < 60
    dots = [len(re.findall(r"M\S+ \S+h0", d)) for d in re.findall(r'<path d="([^"]*)"', svg)]
    assert sorted(dots)[-7:] == [0] + [3000] * 6


def test_bad_data_are_refused():
    with pytest.raises(ValueError, match="points must hold"):
        figures_stirring.traded({}, (1, 1), ("a", "b"), "x")
    with pytest.raises(ValueError, match="points of 'one'"):
        figures_stirring.traded({"one": ([1.0], [0.0])}, (1, 1), ("a", "b"), "x")
    with pytest.raises(ValueError, match="path of 'a'"):
        figures_stirring.paths(WANTED, {"a": OFF[:3]}, 10, "x")
    with pytest.raises(ValueError, match="panels must hold"):
        figures_stirring.paths(WANTED, {}, 10, "x")
    with pytest.raises(ValueError, match="states must hold"):
        figures_stirring.two_families({}, "x")
