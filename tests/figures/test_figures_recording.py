"""Figures of the chapter on trajectories and recording."""

import numpy as np
import pytest

from workshop.chapters.trajectories_and_recording import reached, rounding, tied


def test_the_text_names_the_largest_values():
    states = np.zeros((2, 30, 6))
    states[1, 3] = [0.5, -0.7, 1.5, 0.0, 0.0, -9.0]
    picture = reached({"quiet": 0.1 * states, "ringing": states}, np.pi)
    assert "ringing: 0.7 rad, 1.5 rad/s, 9.0 rad/s²" in picture.alt
    assert "±3.14" in picture.alt


@pytest.mark.parametrize(
    "states, radius, name",
    [
        ({}, 1.0, "states"),
        ({"a": np.zeros((10, 6))}, 1.0, r"states\['a'\]"),
        ({"a": np.zeros((1, 10, 5))}, 1.0, r"states\['a'\]"),
        ({"a": np.full((1, 10, 6), np.nan)}, 1.0, r"states\['a'\]"),
        ({"a": np.zeros((1, 10, 6))}, 0.0, "radius"),
    ],
)
def test_bad_arguments_are_refused_by_name(states, radius, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        reached(states, radius)


def test_the_text_tells_steps_and_spread():
    t = np.arange(4) * 0.01
    picture = rounding(t, [0, 1, 1, 3], {"rough": [1, -1, 1, -1], "fine": np.zeros(4)})
    assert "3 in all" in picture.alt
    assert "rough 1.000, fine 0.000" in picture.alt


@pytest.mark.parametrize(
    "steps, estimates, name",
    [
        ([0, 1], {}, "steps"),
        ([0, 1, np.nan], {}, "steps"),
        ([0, 1, 2], {"a": [1, 2]}, r"estimates\['a'\]"),
    ],
)
def test_rounding_refuses_bad_arguments_by_name(steps, estimates, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        rounding([0.0, 0.1, 0.2], steps, estimates)


PLANTED = {
    "line": np.stack([np.linspace(0, 1, 30), -2 * np.linspace(0, 1, 30)], -1)[None],
    "dots": np.random.default_rng(0).normal(size=(2, 30, 2)),
}


def test_the_text_tells_how_close_the_points_are_to_a_line():
    points = PLANTED["dots"].reshape(-1, 2)
    wanted = f"dots, correlation {np.corrcoef(*points.T)[0, 1]:.2f}"
    picture = tied({"one": PLANTED})
    assert "one: line, correlation -1.00" in picture.alt and wanted in picture.alt


@pytest.mark.parametrize(
    "panels, name",
    [
        ({}, "panels"),
        ({"a": {}}, "panels"),
        ({"a": {"b": np.zeros((5, 2))}}, "points of 'b'"),
        ({"a": {"b": np.zeros((1, 5, 3))}}, "points of 'b'"),
        ({"a": {"b": np.full((1, 5, 2), np.nan)}}, "points of 'b'"),
    ],
)
def test_points_are_refused_by_name(panels, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        tied(panels)
