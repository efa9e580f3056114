"""Figures of the chapters of Parts I to III: what is drawn are the data that were given."""

import re
from dataclasses import replace

import control
import figure_examples as given
import numpy as np
import pytest
from figure_examples import COUNTS, EXACT, LOOPS, NETWORKS, T, X, fitted, made
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.contour import ContourSet
from pictures import curves, size, words

from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.figures import COLOURS, INK
from ddlib.trajectories import APPENDIX_I
from workshop.chapters import (
    convolution_filters,
    dynamics,
    feedback,
    trajectories_and_recording as recording,
    what_lagrange_euler_leaves_out as left_out,
    whole_state_space,
    why_smooth_filters as smooth,
    window_networks as windows,
)


def points(line) -> list:
    return line.get_xydata().tolist()


def legend(figure) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_sketch_says_its_angles():
    picture, figure = made("arm_sketch")
    assert "q1 = 34 degrees" in picture.alt and "q2 = 52 degrees" in picture.alt
    elbow, hand = CMU_DD_ARM_II.forward_kinematics(np.array([0.6, 0.9]))
    np.testing.assert_allclose(curves(figure, COLOURS[0])[0], [[0, 0], elbow])
    np.testing.assert_allclose(curves(figure, COLOURS[1])[0], [elbow, hand])


def test_hand_paths_begin_in_one_point_and_end_where_the_arm_does():
    picture, figure = made("hand_paths")
    paths = [max(curves(figure, colour), key=len) for colour in COLOURS]
    starts, turns = np.array([(path[0], path[-1]) for path in paths]).swapaxes(0, 1)
    l1, l2 = CMU_DD_ARM_II.lengths
    np.testing.assert_allclose(starts, np.tile([l1 + l2, 0.0], (len(COLOURS), 1)), atol=1e-9)
    t = np.deg2rad(-APPENDIX_I)
    x = l1 * np.cos(t[:, 0]) + l2 * np.cos(t.sum(1))
    y = l1 * np.sin(t[:, 0]) + l2 * np.sin(t.sum(1))
    np.testing.assert_allclose(turns, np.stack([x, y], -1), atol=1e-9)
    assert figure.axes[0].get_aspect() == 1.0
    near = np.sqrt(l1**2 + l2**2 + 2 * l1 * l2 * np.cos(np.deg2rad(45.0)))  # largest elbow angle
    assert f"from {near:.2f} to {l1 + l2:.2f} m" in picture.alt


def test_counts_are_drawn_on_a_logarithmic_scale():
    picture, figure = made("operations")
    assert figure.axes[0].get_yscale() == "log"
    for colour, by_joints in zip(COLOURS, COUNTS.values()):
        (line,) = curves(figure, colour)
        assert line.tolist() == [[n, count.multiplications] for n, count in by_joints.items()]
    assert "steep: 10,000; level: 500" in picture.alt
    assert all(name in picture.narrow for name in COUNTS)


def test_shares_stand_beside_repeated_estimates_only():
    picture, _ = made("estimates")
    shares = [text.removesuffix(" %") for text in words(picture) if re.fullmatch(r"\d+ %", text)]
    fair = 100 * fitted(100).covers([1.0, 2.0]).mean(0)
    assert shares == [f"{fair[0]:.0f}", "0", f"{fair[1]:.0f}", "0"]  # two panels
    assert "off: x 50, y 25" in picture.alt and "fair: x" in picture.alt


def test_root_loci_name_the_poles():
    """Of s² + s / 4 + 25, and of s² + 25 s / 4 + 25."""
    picture, figure = made("root_loci")
    assert picture.alt == "Root loci. Poles at factor 1: P: −0.12 ± 5i; PD: −3.1 ± 3.9i."
    for axis, loop in zip(figure.axes, LOOPS.values()):
        start = axis.lines[1].get_xydata()[0]
        assert np.abs(loop.poles() - complex(*start)).min() < 0.05


def test_nyquist_tells_the_largest_sensitivity():
    """Against python-control's stability margin, the smallest distance from -1."""
    picture, _ = made("nyquist")
    told = []
    for title, loop in LOOPS.items():
        _, _, nearest, _, _, at = control.stability_margins(loop)
        told.append(f"{title}: {1 / nearest:.3g} at {at:.2g} rad/s")
    assert picture.alt == f"Nyquist plots. Largest sensitivity: {'; '.join(told)}."


def test_the_block_diagram_stands_on_a_narrow_page():
    """From top to bottom, with the same blocks, signals and signs."""
    lying, _ = made("feedforward_loop")
    standing = replace(lying, svg=lying.narrow)
    assert sorted(words(standing)) == sorted(words(lying)) and "inverse arm" in words(lying)
    (width, height), (narrow, tall) = size(lying.svg), size(standing.svg)
    assert width > 2 * height and tall > narrow


def test_extents_lie_in_their_square():
    picture, figure = made("extents_square")
    extra, training, test = map(points, figure.axes[0].lines)
    assert (extra, training, test) == ([[10, 20]], APPENDIX_I[:5].tolist(), [[*APPENDIX_I[5]]])
    assert "39.5 and 14.4 degrees" in picture.alt


def test_states_are_seen_in_three_planes():
    picture, figure = made("reached")
    for k, axis in enumerate(figure.axes):
        np.testing.assert_array_equal(
            axis.lines[3].get_xydata(), given.RINGING[1, :, 2 * k : 2 * k + 2]
        )
    assert "ringing: 0.7 rad, 1.5 rad/s, 9.0 rad/s²" in picture.alt and "±3.14" in picture.alt


def test_readings_stand_over_accelerations():
    picture, figure = made("rounding")
    assert [list(line.get_ydata()) for line in figure.axes[1].lines] == [[1, -1, 1, -1], [0] * 4]
    assert list(figure.axes[0].lines[1].get_ydata()) == [0, 1, 1, 3]
    assert "3 in all" in picture.alt and "rough 1.000, fine 0.000" in picture.alt


def test_the_text_tells_how_close_the_points_are_to_a_line():
    picture, figure = made("tied")
    dots = given.TIED["dots"].reshape(-1, 2)
    cloud = figure.axes[0].lines[1]
    np.testing.assert_allclose(cloud.get_xydata(), dots * [180 / np.pi, 1])
    assert "one: line, correlation -1.00" in picture.alt
    assert f"dots, correlation {np.corrcoef(*dots.T)[0, 1]:.2f}" in picture.alt


def test_a_curve_looks_the_same_in_every_panel():
    """One: first colour, and the one that stands alone; two: second, twice; three: third."""
    for name, scale in (("side_by_side", "linear"), ("side_by_side, log", "log")):
        _, figure = made(name)
        assert [len(curves(figure, c)) for c in COLOURS[:4]] == [2, 2, 1, 0]
        np.testing.assert_array_equal(curves(figure, COLOURS[1])[0], np.stack([X, X**2], -1))
        scales = {axis.get_xscale() for axis in figure.axes}
        assert scales == {axis.get_yscale() for axis in figure.axes} == {scale}


def test_bars_stand_in_order_and_are_as_long_as_their_torques():
    picture, figure = made("ranking")
    assert picture.alt == (
        "Bars of torque in N m for shoulder and elbow, largest first: large 8.0 and 2.0; "
        "middle 0.50 and 0.90; small 0.020 and 0.010."
    )
    (axis,) = figure.axes
    assert axis.get_xscale() == "log" and axis.yaxis_inverted()
    for j, container in enumerate(axis.containers):
        ends = [bar.get_x() + bar.get_width() for bar in container]
        wanted = [given.SIZES[name][j] for name in ("large", "middle", "small")]
        np.testing.assert_allclose(ends, wanted)
        assert (np.diff([bar.get_y() for bar in container]) > 0).all()
    name = "encoder, acceleration by differences"  # stands above its bars on a narrow page
    assert name in left_out.ranking(given.SIZES | {name: [4.0, 1.0]}).narrow


def test_torques_lie_over_each_other():
    picture, figure = made("overlay")
    for axis, predicted in zip(figure.axes, given.PREDICTED.values(), strict=True):
        network, measured = (line.get_ydata() for line in axis.lines)
        np.testing.assert_array_equal((network, measured), (predicted, given.MEASURED))
    worst = np.sqrt(np.mean((np.sin(T) - np.cos(T)) ** 2))
    assert f"{worst:.2f} N m" in picture.alt and "window 11" in picture.alt


def test_a_plane_has_a_cell_for_every_value_contours_and_marks():
    axis = made("plane")[1].axes[0]
    (cells,) = (part for part in axis.collections if isinstance(part, QuadMesh))
    np.testing.assert_array_equal(cells.get_array().reshape(given.PLANE.shape), given.PLANE)
    corners = cells.get_coordinates()
    middles = (corners[1:, 1:] + corners[:-1, :-1]) / 2
    np.testing.assert_allclose(middles, np.stack(np.meshgrid(given.ACROSS, given.UP), -1))
    assert isinstance(cells.norm, LogNorm)
    assert [points(line) for line in axis.lines] == [
        [[*p] for p in place] for place in given.PLACES
    ]
    (outline,) = axis.patches
    assert {tuple(corner) for corner in outline.get_xy()} == set(
        given.PLACES[0][:3]
    )  # no inner one
    (contours,) = (part for part in axis.collections if isinstance(part, ContourSet))
    assert list(contours.levels) == [0.5, 1.0]


def test_intervals_and_points_are_where_they_were_given():
    left, right = made("intervals")[1].axes
    lines = [line for line in left.lines if line.get_marker() == "None"]
    assert [line.get_xdata().tolist() for line in lines] == [[0.5, 2.0], [1.0, 1.0], [1, 4]]
    middles = [points(line)[0] for line in left.lines if line.get_marker() != "None"]
    assert [x for x, _ in middles] == [1.0, 1.0, 2]
    gain, friction, other = (y for _, y in middles)
    assert gain < 0 < other < 0.5 < friction  # first row above, series side by side
    assert [label.get_text() for label in left.get_yticklabels()] == ["gain", "friction"]
    assert left.yaxis_inverted() and left.get_xscale() == "log" and len(right.lines) == 2
    np.testing.assert_allclose(left.patches[0].get_bbox().intervalx, (0.7, 1.4))

    picture, figure = made("intervals, ends")
    (mark,) = (line for line in figure.axes[0].lines if line.get_marker() == "D")
    assert points(mark) == [[0.3, 0.0]] and figure.axes[0].get_xlim() == (-1, 1)
    assert {"300", "900"} <= set(words(picture))


def test_groups_have_their_medians_and_the_wanted_value():
    for axis, wanted in zip(made("clusters")[1].axes, (4.0, 0.0), strict=True):
        lines = [list(line.get_ydata()) for line in axis.lines]
        assert lines == [[wanted] * 2, [1, 2, 6], [2, 2], [3, 3, 5, 9], [4, 4]]


def test_bars_end_at_the_mean_and_every_draw_has_a_dot():
    _, figure = made("against_nulls")
    left, right, *_ = figure.axes
    assert [bar.get_width() for bar in left.patches] == pytest.approx([0.2, 0.1])
    assert [bar.get_width() for bar in right.patches] == pytest.approx([0, 1])
    dots = [line for line in left.lines if line.get_label() in ("one", "two")]
    assert [set(line.get_xdata()) for line in dots] == [{0.4}, {0.7}, {0.0}, {1.0}]
    assert [line.get_color() for line in dots] == [*COLOURS[:2]] * 2
    assert all(abs(line.get_ydata()[0] - row) < 0.4 for line, row in zip(dots, (0, 0, 1, 1)))
    assert legend(figure) == ["real", "one", "two"]


def test_courses_are_measured_and_predicted_and_end_beside_a_diagonal():
    _, figure = made("predicted_curves")
    left, right = figure.axes
    for k, (measured, predicted) in enumerate(given.COURSES.values()):
        dashed, solid = left.lines[2 * k : 2 * k + 2]
        assert (dashed.get_linestyle(), solid.get_linestyle()) == ("--", "-")
        assert dashed.get_color() == solid.get_color() == COLOURS[k]
        np.testing.assert_array_equal(solid.get_xydata(), np.stack([X, measured], -1))
        np.testing.assert_array_equal(dashed.get_xydata(), np.stack([X, predicted], -1))
    one, two, diagonal = map(points, right.lines)
    assert one == [[1e-3, 1e-2], [1.0, 1.0]] and two == [[10.0, 5.0]]
    assert diagonal == [[1e-3, 1e-3], [10.0, 10.0]]
    assert {axis.get_xscale() for axis in figure.axes} == {"log"}


def test_the_bold_line_is_the_median_network():
    picture, figure = made("torque_along")
    bold, fine = (curves(figure, colour) for colour in (COLOURS[1], INK))
    for joint in range(2):
        np.testing.assert_array_equal(fine[joint], np.stack([T, EXACT[:, joint]], -1))
        np.testing.assert_array_equal(bold[joint], np.stack([T, NETWORKS[1, :, joint]], -1))
    assert "shoulder 0.02 N m, elbow 0.02 N m" in picture.alt


def test_every_network_of_a_size_is_a_point_and_medians_are_joined():
    picture, figure = made("error_by_size")
    left, right = figure.axes
    solver, descent = (line for line in left.lines if line.get_linestyle() != "None")
    assert points(solver) == [[100, 0.2], [10_000, 0.02]] and points(descent) == [[100, 0.3]]
    assert points(left.lines[0]) == [[100, error] for error in (0.4, 0.2, 0.1)]
    assert right.lines[-1].get_color() == descent.get_color() != solver.get_color()
    assert {axis.get_xscale() for axis in figure.axes} == {left.get_yscale()} == {"log"}
    assert "solver: from 0.20 with 100 to 0.020 with 10,000 samples" in picture.alt


def test_one_input_swings_and_the_others_rest():
    picture, figure = made("responses")
    swings = [[np.ptp(line.get_ydata()) for line in axis.lines] for axis in figure.axes]
    assert swings == [[0.0] * 4] * 3 + [[1.0] * 4] + [[0.0] * 4] * 2
    assert "q1 0.00" in picture.alt and "q2 1.00" in picture.alt


BAD = np.nan
ARM = CMU_DD_ARM_II
REFUSALS = [
    (dynamics.arm_sketch, (ARM, [0.1, BAD]), "q must be finite"),
    (dynamics.arm_sketch, (ARM, [0.1]), "q must have"),
    (dynamics.hand_paths, (ARM, [BAD, 0.0]), "extents_deg must"),
    (dynamics.estimates, ({"a": fitted()}, [1.0, 2.0], ("x", "y"), 0.0), "limit must"),
    (dynamics.estimates, ({"a": fitted()}, [1.0], ("x", "y"), 5.0), "truth must"),
    (feedback.root_loci, ({}, [0.5, 1.0]), "loops must"),
    *(
        (feedback.root_loci, (LOOPS, bad), "gains must")
        for bad in ([0, 1], [1, 0.5], [1], [1, BAD])
    ),
    (feedback.nyquist, ({}, [1.0, 2.0]), "loops must"),
    *(
        (feedback.nyquist, (LOOPS, bad), "frequencies must")
        for bad in ([0, 1], [2, 1], [1], [1, BAD])
    ),
    (recording.extents_square, (APPENDIX_I[:5], [np.inf, 0.0]), "test must be finite"),
    (recording.reached, ({}, 1.0), "states must"),
    (recording.reached, ({"a": np.zeros((10, 6))}, 1.0), r"states\['a'\] must"),
    (recording.reached, ({"a": np.full((1, 10, 6), BAD)}, 1.0), r"states\['a'\] must"),
    (recording.reached, ({"a": np.zeros((1, 10, 6))}, 0.0), "radius must"),
    (recording.rounding, ([0.0, 0.1, 0.2], [0, 1, BAD], {}), "steps must"),
    (recording.rounding, ([0.0, 0.1], [0, 1], {"a": [1]}), r"estimates\['a'\] must"),
    (recording.tied, ({"a": {}},), "panels must"),
    (recording.tied, ({"a": {"b": np.zeros((1, 5, 3))}},), "points of 'b' must"),
    *((left_out.ranking, ({"a": bad},), "sizes") for bad in ([0, 1], [-1, 1], [BAD, 1], [1])),
    (
        windows.plane,
        (X, X[:2], given.PLANE, ("x", "y", "z"), "A."),
        r"values must have .* \(2, 6\), got",
    ),
    (windows.plane, (X, X[:1], [-X], ("x", "y", "z"), "A."), "values must be above 0"),
    (windows.plane, (X, [np.inf], [X], ("x", "y", "z"), "A."), "y must be finite"),
    (
        windows.intervals,
        ({"a": {"b": {"c": (1, 0, 2)}}}, "x", "A."),
        "interval of 'c' must be in order",
    ),
    (convolution_filters.clusters, ({}, "N m", "A."), "panels must"),
    (convolution_filters.clusters, ({"a": ({"b": [BAD]}, 1.0)}, "N m", "A."), "values of 'b' must"),
    (convolution_filters.clusters, ({"a": ({"b": [0.0]}, np.inf)}, "N m", "A."), "wanted must"),
    (convolution_filters.against_nulls, ({}, "share", "A."), "panels must"),
    (
        convolution_filters.against_nulls,
        ({"a": {"b": {"c": [[1.0]]}}}, "share", "A."),
        "of 'b' must",
    ),
    (smooth.predicted_curves, (X, {"a": (X, X[:3])}, {}, (), "A."), "values of 'a' must have"),
    (
        smooth.predicted_curves,
        (X, {"a": (X, X)}, {"b": (X, 0 * X)}, (), "A."),
        "values of 'b' must",
    ),
    (whole_state_space.torque_along, (T, EXACT, EXACT), "predicted must"),
    (whole_state_space.responses, (X, given.ACTIVITY[0]), "activity must have shape"),
]


@pytest.mark.parametrize("draw, arguments, message", REFUSALS)
def test_refusals(draw, arguments, message):
    with pytest.raises(ValueError, match=message):
        draw(*arguments)
