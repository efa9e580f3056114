"""Figures of the chapter on a real arm: accessible, and true to what they are given."""

import numpy as np
import pytest
from matplotlib.colors import to_hex
from pictures import check_sound, curves, drawn, figures_in, words

from ddlib.figures import COLOURS, FAINT
from workshop.beyond.figures import real_arm as figures_real_arm

SPEED = np.linspace(-2.0, 1.0, 31)
GROUPS = np.array([-1.5, 0.5]), np.array([-2.0, 1.2])
PANELS = {
    name: (SPEED, 0.5 * SPEED + jump * np.sign(SPEED), *GROUPS, (0.5, jump))
    for name, jump in (("joint 1", 0.2), ("joint 2", 0.4))
}
LABELS = "velocity, rad/s", "current, A"
REAL = np.array([[1.0, 0.9, 1.1, 1.2, 0.8, 1.0], [1.1, 1.0, 1.2, 1.3, 0.9, 1.1]])
NULL = np.linspace(-0.5, 0.5, 21)[:, None] * np.ones(6)
EXAMPLES = {
    "friction_by_joint": lambda: figures_real_arm.friction_by_joint(PANELS, LABELS, "Two joints."),
    "gains_by_joint": lambda: figures_real_arm.gains_by_joint(
        {"velocity": (REAL, NULL)}, "gain over inertia", "Gains of two networks."
    ),
}


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def test_every_figure_has_an_example():
    assert figures_in(figures_real_arm) == set(EXAMPLES)


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_and_accessible(made, name):
    figure, _ = made[name]
    check_sound(figure)


def test_friction_lines_jump_at_rest_and_slope_beyond(made):
    picture, figure = made["friction_by_joint"]
    lines = curves(figure, COLOURS[1])
    np.testing.assert_allclose(lines[0], [[0, -0.2], [-2, -1.2]])
    np.testing.assert_allclose(lines[1], [[0, 0.2], [2, 1.2]])
    np.testing.assert_allclose(lines[3], [[0, 0.4], [2, 1.4]])
    cloud, dots = (x.get_path().vertices[::2] for x in figure.axes[0].patches)
    np.testing.assert_allclose(sorted(map(tuple, dots)), sorted(zip(*GROUPS)))
    assert 0.2 * len(SPEED) < len(cloud) <= len(SPEED)  # points nearly on each other are drawn once
    assert picture.narrow
    assert {"joint 1", "joint 2", *LABELS} <= set(words(picture))


def test_gains_are_dots_and_nulls_bars(made):
    picture, figure = made["gains_by_joint"]
    (axis,) = figure.axes
    dots = np.concatenate([x.get_ydata() for x in axis.lines if x.get_color() == COLOURS[0]])
    np.testing.assert_allclose(np.sort(dots), np.sort(REAL.ravel()))
    bars = [p for p in axis.patches if to_hex(p.get_facecolor()) == FAINT]
    assert len(bars) == 6
    for k, bar in enumerate(bars, 1):
        assert bar.get_x() < k < bar.get_x() + bar.get_width()
        assert bar.get_y() == pytest.approx(-0.45) and bar.get_height() == pytest.approx(0.9)
    assert {"unrelated currents", "real currents", "as identified"} <= set(words(picture))


def test_what_makes_no_sense_is_refused():
    friction, gains = figures_real_arm.friction_by_joint, figures_real_arm.gains_by_joint
    with pytest.raises(ValueError, match="one panel or more"):
        friction({}, LABELS, "a")
    with pytest.raises(ValueError, match="one panel or more"):
        gains({}, "gain", "a")
    with pytest.raises(ValueError, match="current of 'x'"):
        friction({"x": (SPEED, SPEED[1:], *GROUPS, (1, 1))}, LABELS, "a")
    with pytest.raises(ValueError, match="gains of 'x'"):
        gains({"x": (REAL[:, :4], NULL)}, "gain", "a")
