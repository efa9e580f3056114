"""Figures of the chapters of Part IV: accessible, and true to what they are given."""

import re

import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from pictures import boxes, check_sound, curves, drawn, words

from ddlib.figures import COLOURS, FAINT
from workshop.beyond.figures import maps
from workshop.chapters import (
    adaptive_control,
    joints_three_and_four,
    learning_in_the_loop,
    real_arm,
    rivals,
    run_time,
    stirring,
)

LABELS = "motions, number", "error, mm"
SIZE = np.array([5, 10, 20])
ERRORS = np.array([[0.5, 0.7, 0.6], [0.3, 0.2, 0.1], [0.08, 0.09, 0.1]])
INERTIA = np.array([[2.0, 0.5], [0.6, 1.0]])
REAL = INERTIA + np.array([-0.1, 0.0, 0.1])[:, None, None]
UNRELATED = np.linspace(-1.0, 1.0, 21)[:, None, None] * np.ones((2, 2))
GAINS = np.array([[1.0, 0.9, 1.1, 1.2, 0.8, 1.0], [1.1, 1.0, 1.2, 1.3, 0.9, 1.1]])
SPEED = np.linspace(-2.0, 1.0, 31)
GROUPS = np.array([-1.5, 0.5]), np.array([-2.0, 1.2])
FRICTION = {
    name: (SPEED, 0.5 * SPEED + jump * np.sign(SPEED), *GROUPS, (0.5, jump))
    for name, jump in (("joint 1", 0.2), ("joint 2", 0.4))
}
STOPPED = np.array([[False, True, False], [False, False, False]])
RATIOS = {
    "the same": {"one": np.array([0.1, 0.2, 0.9]), "two": np.array([1.0, 2.0, 3.0])},
    "faster": {"one": np.array([0.5, 0.6, 0.7]), "two": np.array([1.0, 4.0, 5.0])},
}
COST = [100, 10, 1000], np.full((3, 4), 0.1), np.full((3, 4), 0.3)
UNSORTED = COST[0], ERRORS / 2, ERRORS
GROUPED = {"11": (np.array([1.0, 2.0]), np.array([3.0, 4.0])), "21": (np.ones(3), 7 * np.ones(3))}
PHASE = np.linspace(0, 2 * np.pi, 40)
WANTED = np.stack([np.cos(PHASE), np.sin(PHASE)], -1)
OFF = WANTED + np.array((0.01, -0.02))
STATES = np.arange(24.0).reshape(4, 6)
EDGE = np.array([10.0, 20.0, 30.0])
SQUARES = {"one": np.arange(1.0, 10.0).reshape(3, 3), "two": np.full((3, 3), 0.5)}
SQUARES["three"] = 2 * SQUARES["two"]
EXAMPLES = {
    "courses": lambda: adaptive_control.courses(
        {"A": {"one": ERRORS, "two": 2 * ERRORS}, "B": {"one": ERRORS, "two": ERRORS}},
        2, "a load", "error, mm", "Two.",
    ),
    "stops_map": lambda: adaptive_control.stops_map(
        [0.1, 1.0, 10.0], [0, 2], {"A": (np.where(STOPPED, np.inf, 1.0), STOPPED)},
        ("rate", "delay, ms", "error, mm"), "A map.",
    ),
    "ladders": lambda: joints_three_and_four.ladders(
        {"network": {"two joints": (SIZE, ERRORS)}, "linear": {"two joints": (SIZE, 2 * ERRORS)}},
        LABELS, "Errors.", level=0.2,
    ),
    "growth": lambda: joints_three_and_four.growth(
        [2, 4, 7], [4, 9, 15], [[3, 8, 12], [5, 10, 20]], [4, 8, 14], LABELS, ("found", "a law"),
        "Growth.",
    ),
    "couplings": lambda: joints_three_and_four.couplings(
        INERTIA, REAL, UNRELATED, "gain over the deviation", "Gains."
    ),
    "by_trial": lambda: learning_in_the_loop.by_trial(
        {"from nothing": {"none": (SIZE, ERRORS), "one": (SIZE, 2 * ERRORS)}}, LABELS, "Falls.",
        change=(7.5, "a load"),
    ),
    "by_motion": lambda: learning_in_the_loop.by_motion(RATIOS, "error ratio", "Two."),
    "friction_by_joint": lambda: real_arm.friction_by_joint(FRICTION, LABELS, "Two joints."),
    "gains_by_joint": lambda: real_arm.gains_by_joint(
        {"velocity": (GAINS, np.linspace(-0.5, 0.5, 21)[:, None] * np.ones(6))}, "gain", "Two nets."
    ),
    "costs": lambda: rivals.costs(
        {"tables": {"one": UNSORTED, "two": COST}, "bases": {"three": COST}}, ("network", COST),
        0.02, ("stored numbers", "RMSS"), "Errors over numbers.",
    ),
    "against": lambda: run_time.against(
        {"RMSS": GROUPED, "loop, mm": {"21": (np.ones(2) * 5, np.ones(2) * 6)}}, "error, mm",
        "two panels", ("loop, mm",),
    ),
    "traded": lambda: stirring.traded(
        {"one": ([1.0, 2.0], [30.0, 20.0]), "other": ([3.0], [4.0])}, (10.0, 15.0), LABELS, "Dots."
    ),
    "paths": lambda: stirring.paths(WANTED, {"none": OFF, "exact": WANTED}, 10, "Two paths."),
    "two_families": lambda: stirring.two_families({"first": STATES, "second": -STATES}, "Clouds."),
    "maps": lambda: maps(EDGE, SQUARES, ("x, °", "y, °", "error"), "Maps.", mark=(20.0, 30.0)),
}  # fmt: skip


@pytest.fixture(scope="module")
def made():
    return {name: drawn(make) for name, make in EXAMPLES.items()}


def segments(axis):
    return np.array(axis.collections[0].get_segments())


def dots(axis):
    """Heights of the markers of the first colour, a row for each line."""
    lines = [x for x in axis.lines if x.get_color() == COLOURS[0] and x.get_linestyle() == "None"]
    return np.array([line.get_ydata() for line in lines])


def test_figures_are_accessible_and_name_what_they_show(made):
    said = {
        "courses": {"A", "B", "one", "two", "a load", "error, mm", "motion, number"},
        "growth": {"found", "a law", "2", "4", "7"},
        "gains_by_joint": {"unrelated currents", "real currents", "as identified"},
        "costs": {"tables", "bases", "one", "two", "three", "network", "test", "training", "noise"},
    }
    for name, (picture, _) in made.items():
        check_sound(picture)
        assert said.get(name, set()) <= set(words(picture)), name


def test_lines_are_medians(made):
    middle = np.median(ERRORS, 1)
    left, _ = made["courses"][1].axes
    assert [list(line.get_ydata()) for line in left.lines[:2]] == [list(middle), list(2 * middle)]
    figure = made["ladders"][1]
    first, second = curves(figure, COLOURS[0])
    np.testing.assert_allclose(first, np.transpose([SIZE, middle]))
    np.testing.assert_allclose(second[:, 1], 2 * middle)
    assert {tuple(line[:, 1]) for line in curves(figure, FAINT)} == {(0.2, 0.2)}
    ends = np.transpose([ERRORS.min(1), ERRORS.max(1)])
    np.testing.assert_allclose(segments(figure.axes[0])[..., 1], ends)
    lines = {line.get_label(): line for line in made["by_trial"][1].axes[0].lines}
    np.testing.assert_allclose(lines["none"].get_ydata(), middle)
    assert [7.5, 7.5] in [list(line.get_xdata()) for line in lines.values()]
    tables = made["costs"][1].axes[0]  # from small to large
    lines = {line.get_label(): line.get_xydata() for line in tables.lines}
    np.testing.assert_allclose(lines["one"], np.transpose([[10, 100, 1000], middle[[1, 0, 2]]]))


def test_what_is_needed_has_dots_intervals_and_a_law(made):
    figure = made["growth"][1]
    (line,) = curves(figure, FAINT)
    np.testing.assert_allclose(line, [[2, 4], [4, 8], [7, 14]])
    np.testing.assert_allclose(dots(figure.axes[0]), [[4, 9, 15]])
    np.testing.assert_allclose(segments(figure.axes[0])[..., 1], [[3, 5], [8, 10], [12, 20]])


def test_networks_are_dots_and_those_on_unrelated_torques_bars(made):
    figure = made["couplings"][1]
    for j, axis in enumerate(figure.axes):
        np.testing.assert_allclose(segments(axis)[:, 0, 1], INERTIA[j])
        np.testing.assert_allclose(dots(axis), REAL[:, j])
    np.testing.assert_allclose(boxes(figure, FAINT)[:, [1, 3]], [[-0.9, 0.9]] * 4)
    figure = made["gains_by_joint"][1]
    np.testing.assert_allclose(dots(figure.axes[0]), GAINS)
    bars = boxes(figure, FAINT)
    np.testing.assert_allclose(bars[:, [1, 3]], [[-0.45, 0.45]] * 6)
    assert (bars[:, 0] < np.arange(1, 7)).all() and (np.arange(1, 7) < bars[:, 2]).all()


def test_stopped_runs_are_crossed_out(made):
    axis = made["stops_map"][1].axes[0]
    assert axis.lines[0].get_xydata().tolist() == [[1, 0]]
    (mesh,) = (found for found in axis.collections if isinstance(found, QuadMesh))
    np.testing.assert_array_equal(mesh.get_array().mask.reshape(2, 3), STOPPED)


def test_marks_are_medians_and_bars_reach_over_all_seeds(made):
    axis = made["by_motion"][1].axes[0]
    lines = [list(line.get_xdata()) for line in axis.lines]
    assert [x for x in lines if len(x) == 1] == [[0.2], [2.0], [0.6], [4.0]]
    assert [x for x in lines if len(x) == 2][:4] == [[0.1, 0.9], [1, 3], [0.5, 0.7], [1, 5]]


def test_friction_lines_jump_at_rest_and_slope_beyond(made):
    picture, figure = made["friction_by_joint"]
    lines = curves(figure, COLOURS[1])
    np.testing.assert_allclose(lines[0], [[0, -0.2], [-2, -1.2]])
    np.testing.assert_allclose(lines[1], [[0, 0.2], [2, 1.2]])
    np.testing.assert_allclose(lines[3], [[0, 0.4], [2, 1.4]])
    cloud, marks = (x.get_path().vertices[::2] for x in figure.axes[0].patches)
    np.testing.assert_allclose(sorted(map(tuple, marks)), sorted(zip(*GROUPS)))
    assert 0.2 * len(SPEED) < len(cloud) <= len(SPEED)  # points nearly on each other are drawn once
    assert picture.narrow


def test_every_member_is_a_dot_where_it_belongs(made):
    first, second = made["against"][1].axes
    for line, (x, y) in zip(first.lines, GROUPED.values(), strict=True):
        np.testing.assert_array_equal(line.get_xydata(), np.stack([x, y], -1))
    marks, equal = second.lines
    assert equal.get_xydata().tolist() == [[5.0, 5.0], [6.0, 6.0]]
    assert marks.get_color() == first.lines[1].get_color() != first.lines[0].get_color()
    (axis,) = made["traded"][1].axes
    lines = {line.get_label(): line.get_xydata() for line in axis.lines}
    np.testing.assert_array_equal(lines["one"], [[1, 30], [2, 20]])
    crossing = [line for line in axis.lines if line.get_label()[0] == "_"]
    assert crossing[0].get_xdata()[0] == 10 and crossing[1].get_ydata()[0] == 15


def test_errors_of_the_hand_are_exaggerated_and_the_path_is_not(made):
    none, exact = made["paths"][1].axes
    np.testing.assert_allclose(none.lines[0].get_xydata(), WANTED)
    np.testing.assert_allclose(none.lines[1].get_xydata(), WANTED + np.array((0.1, -0.2)))
    np.testing.assert_allclose(exact.lines[1].get_xydata(), WANTED)


def test_states_are_shoulder_against_elbow_and_few_elements(made):
    for k, axis in enumerate(made["two_families"][1].axes):
        first, second = (patch.get_path().vertices[::2] for patch in axis.patches)
        np.testing.assert_array_equal(first, STATES[:, [k, k + 3]])
        np.testing.assert_array_equal(second, -first)
    states = np.random.default_rng(0).normal(size=(3000, 6))
    svg = stirring.two_families({"only": states, "other": states + 1}, "Clouds.").svg
    assert svg.count("<use") < 100 and svg.count("<path") < 60
    marks = [len(re.findall(r"M\S+ \S+h0", d)) for d in re.findall(r'<path d="([^"]*)"', svg)]
    assert sorted(marks)[-7:] == [0] + [3000] * 6


def test_maps_have_one_scale_and_a_mark(made):
    panels = [axis for axis in made["maps"][1].axes if axis.get_title(loc="left")]
    assert [axis.get_title(loc="left") for axis in panels] == list(SQUARES)
    for axis, values in zip(panels, SQUARES.values()):
        (cells,) = (found for found in axis.collections if isinstance(found, QuadMesh))
        np.testing.assert_array_equal(cells.get_array().reshape(3, 3), values.T)
        assert (cells.norm.vmin, cells.norm.vmax) == (0.5, 9.0)
        assert axis.lines[0].get_xydata().tolist() == [[20.0, 30.0]]


@pytest.mark.parametrize(
    "errors, said",
    [
        ({}, "errors must hold a panel"),
        ({"a": -SQUARES["one"]}, "errors of 'a' must be positive"),
        ({"a": np.ones((2, 3))}, "errors of 'a' must have shape"),
    ],
)
def test_maps_refuse(errors, said):
    with pytest.raises(ValueError, match=said):
        maps(EDGE, errors, ("x, °", "y, °", "error"), "maps")
