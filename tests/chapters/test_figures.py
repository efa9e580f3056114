"""All figures of the book: sound and accessible, and what is drawn are the data that were given."""

import inspect
import pkgutil
import re
from dataclasses import replace
from functools import partial
from importlib import import_module

import control
import figure_examples as given
import numpy as np
import pytest
from figure_examples import EXAMPLES, SHOWN, T, X, fitted, made
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.contour import ContourSet
from pictures import black_or_white, check_sound, curves, ids, shapes, size, words

from ddlib import figures
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.figures import COLOURS, INK
from ddlib.trajectories import APPENDIX_I
from workshop import chapters
from workshop.beyond import figures as beyond
from workshop.chapters import (
    convolution_filters as filters,
    dynamics,
    feedback,
    stirring,
    trajectories_and_recording as recording,
    what_lagrange_euler_leaves_out as left_out,
    whole_state_space as states,
    why_smooth_filters as smooth,
    window_networks as windows,
)

UPON_A_COLOUR = {
    "ranking": "#000000", "hinton": "#ffffff", "hinton_states": "#ffffff", "plane": "#ffffff",
    "maps": "#ffffff", "hand_paths": "#ffffff", "arm_sketch": "#ffffff",
}  # fmt: skip
"""What these paint black or white lies on a colour, or has an edge in the page's ink."""

OF_THEIR_OWN = {
    "hinton", "hinton_states", "network_diagram", "feedforward_loop", "hand_paths", "estimates",
    "root_loci", "nyquist", "ranking", "rmss_by_window", "verdicts",
}  # fmt: skip
"""Figures with a test of their own, because more is drawn than was given."""


L1, L2 = CMU_DD_ARM_II.lengths
NEAR = np.hypot(L1 + L2 * np.sqrt(0.5), L2 * np.sqrt(0.5))  # at the largest elbow angle, 45°
TOLD = {
    "network_diagram": "2 times 21 inputs, 10 hidden units and 2 outputs",
    "decomposition": "unit 0; unit 1; unit 2",
    "rmss_by_window": f"one, median test error 11: {np.median(given.TABLE['one']['test'][11]):.3f}",
    "arm_sketch": "link 1 turned by q1 = 34 degrees from the x axis, link 2 by q2 = 52 degrees",
    "hand_paths": f"from {NEAR:.2f} to {L1 + L2:.2f} m",
    "operations": "steep: 10,000; level: 500",
    "estimates": "off: x 50, y 25",
    "root_loci": "P: −0.12 ± 5i; PD: −3.1 ± 3.9i.",  # of s² + s / 4 + 25, s² + 25 s / 4 + 25
    "extents_square": "39.5 and 14.4 degrees",
    "reached": "ringing: 0.7 rad, 1.5 rad/s, 9.0 rad/s²",
    "rounding": "3 in all; below, accelerations computed from them, with standard deviations in "
    "rad/s²: rough 1.000, fine 0.000",
    "tied": f"line, correlation -1.00, dots, correlation {np.corrcoef(*given.DOTS.T)[0, 1]:.2f}",
    "ranking": "largest first: large 8.0 and 2.0; middle 0.50 and 0.90; small 0.020 and 0.010.",
    "overlay": f"{np.sqrt(np.mean((np.sin(T) - np.cos(T)) ** 2)):.2f} N m",
    "torque_along": "shoulder 0.02 N m, elbow 0.02 N m",
    "error_by_size": "solver: from 0.20 with 100 to 0.020 with 10,000 samples",
    "responses": "q1 0.00, v1 0.00, a1 0.00, q2 1.00",
}
"""Numbers that the alternative texts say."""

LOGARITHMIC = {
    **dict.fromkeys(("curves", "side_by_side, log", "predicted_curves", "error_by_size"), "xy"),
    **dict.fromkeys(("ladders", "growth", "costs", "against", "traded"), "xy"),
    **dict.fromkeys(("families", "rmss_by_window", "operations", "courses", "by_trial"), "y"),
    **dict.fromkeys(("ranking", "intervals", "by_motion"), "x"),
}


def test_every_figure_has_an_example():
    modules = [beyond]
    for package in (figures, chapters):
        names = [module.name for module in pkgutil.iter_modules(package.__path__)]
        modules += [
            import_module(f"{package.__name__}.{name}") for name in names if name != "style"
        ]
    drawing = {
        name
        for module in modules
        for name, function in inspect.getmembers(module, inspect.isfunction)
        if function.__module__ == module.__name__ and name[0] != "_"
        if inspect.signature(function).return_annotation == "Illustration"
    }
    assert drawing == {name.partition(",")[0] for name in EXAMPLES} and len(drawing) > 40
    assert set(EXAMPLES) - set(SHOWN) == OF_THEIR_OWN


@pytest.mark.parametrize("name", EXAMPLES)
def test_sound_accessible_and_true_to_the_data(name):
    picture, figure = made(name)
    check_sound(picture)
    assert black_or_white(picture) <= {UPON_A_COLOUR.get(name)}
    assert len(picture.svg) < (400_000 if name == "hinton" else 150_000)
    assert TOLD.get(name, "") in picture.alt
    for axis, wanted in zip(figure.axes, SHOWN.get(name, [])):
        drawn = shapes(axis)
        for points in map(np.asarray, wanted):
            same = [part for part in drawn if part.shape == points.shape]
            assert any(np.allclose(part, points, equal_nan=True) for part in same), points
        if "map" not in name and name != "plane":
            scales = {"x": axis.get_xscale(), "y": axis.get_yscale()}
            logarithmic = {side for side, scale in scales.items() if scale == "log"}
            assert logarithmic == set(LOGARITHMIC.get(name, ""))


def test_no_two_figures_share_an_id():
    every = [name for key in EXAMPLES for name in ids(made(key)[0].svg)]
    assert len(every) == len(set(every)) > 20


@pytest.mark.parametrize(
    "name, counts",
    [
        ("curves", [1, 2, 0]),
        ("side_by_side", [2, 2, 1]),  # what stands alone has the first colour
        ("families", [10, 5, 0]),
        ("predicted_curves", [2, 2, 0]),
        ("torque_along", [0, 2, 0]),
    ],
)
def test_a_curve_looks_the_same_in_every_panel(name, counts):
    assert [len(curves(made(name)[1], colour)) for colour in COLOURS[:3]] == counts


@pytest.mark.parametrize(
    "name, told",
    [
        ("by_case", {*given.CASES, "error, °", "time, s"}),
        ("courses", {"A", "B", "one", "two", "a load", "error, mm", "motion, number"}),
        ("growth", {"found", "a law", "2", "4", "7"}),
        ("gains_by_joint", {"unrelated currents", "real currents", "as identified"}),
        (
            "costs",
            {"tables", "bases", "one", "two", "three", "network", "test", "training", "noise"},
        ),
        ("intervals", {"a", "b", "gain", "friction"}),
        ("intervals, ends", {"300", "900"}),
        ("predicted_curves", {"slow", "fast", "predicted", "one", "two"}),
        ("against_nulls", {"hidden", "direct", "velocity", "jerk", "real", "one", "two"}),
    ],
)
def test_figures_name_what_they_show(name, told):
    assert told <= set(words(made(name)[0]))


@pytest.mark.parametrize("count, columns", [(1, 2), (3, 2), (2, 3)])
def test_curves_label_every_bottom_axis(count, columns):
    panels = {f"panel {k}": {"a": T} for k in range(count)}
    texts = words(figures.curves(T, panels, "the common axis", "Panels.", columns=columns))
    assert texts.count("the common axis") == min(count, columns)
    assert all(texts.count(label) == 1 for label in panels)


def test_table_4_1_has_every_network_medians_and_printed_values():
    _, figure = made("rmss_by_window")
    for axis, (column, printed) in zip(figure.axes, given.PRINTED.items(), strict=True):
        cells = [errors for named in given.TABLE.values() for errors in named[column].values()]
        clouds = [line for line in axis.lines if line.get_marker() != "None"]
        bars = [line for line in axis.lines if line.get_color() == INK]
        for k, (cloud, bar, errors) in enumerate(zip(clouds, bars, cells, strict=True)):
            np.testing.assert_array_equal(cloud.get_ydata(), np.sort(errors))
            assert (np.abs(cloud.get_xdata() - k % 3) < 0.5).all()  # three windows
            assert cloud.get_color() == COLOURS[k // 3] and set(bar.get_ydata()) == {
                np.median(errors)
            }
        dashed = [line.get_ydata()[0] for line in axis.lines if line.get_linestyle() == "--"]
        assert dashed == list(printed.values())


def test_maps_have_a_cell_for_every_value():
    """Stopped runs are masked; of several maps there is one scale of colours."""

    def cells(axis):
        return next(part for part in axis.collections if isinstance(part, QuadMesh))

    plane = made("plane")[1].axes[0]
    np.testing.assert_array_equal(cells(plane).get_array(), given.PLANE)
    corners = cells(plane).get_coordinates()
    middles = (corners[1:, 1:] + corners[:-1, :-1]) / 2
    np.testing.assert_allclose(middles, np.stack(np.meshgrid(given.ACROSS, given.UP), -1))
    assert isinstance(cells(plane).norm, LogNorm)
    assert {tuple(corner) for corner in plane.patches[0].get_xy()} == set(
        given.PLACES[0][:3]
    )  # the hull
    (contours,) = (part for part in plane.collections if isinstance(part, ContourSet))
    assert list(contours.levels) == [0.5, 1.0]
    for axis, (title, values) in zip(made("maps")[1].axes, given.SQUARES.items()):
        assert axis.get_title(loc="left") == title
        np.testing.assert_array_equal(cells(axis).get_array(), values.T)
        assert (cells(axis).norm.vmin, cells(axis).norm.vmax) == (0.5, 9.0)
    np.testing.assert_array_equal(
        cells(made("stops_map")[1].axes[0]).get_array().mask, given.STOPPED
    )


def test_thousands_of_dots_are_few_elements():
    dots = np.random.default_rng(0).normal(size=(3000, 6))
    svg = stirring.two_families({"only": dots, "other": dots + 1}, "Clouds.").svg
    assert svg.count("<use") < 100 and svg.count("<path") < 60
    marks = [len(re.findall(r"M\S+ \S+h0", d)) for d in re.findall(r'<path d="([^"]*)"', svg)]
    assert sorted(marks)[-7:] == [0] + [3000] * 6
    cloud = made("friction_by_joint")[1].axes[0].patches[0].get_path().vertices[::2]
    speed = given.FRICTION["joint 1"][0]  # points nearly on each other are drawn once
    assert 0.2 * len(speed) < len(cloud) <= len(speed)


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
    for axis, loop in zip(figure.axes, given.LOOPS.values()):
        start = axis.lines[1].get_xydata()[0]
        assert np.abs(loop.poles() - complex(*start)).min() < 0.05


def test_nyquist_tells_the_largest_sensitivity():
    """Against python-control's stability margin, the smallest distance from -1."""
    picture, _ = made("nyquist")
    told = []
    for title, loop in given.LOOPS.items():
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


BAD = np.nan
PLANE = partial(windows.plane, levels=(), training=(), test=())
NO_AXIS = [0, 1], [2, 1], [1], [1, BAD]
ARM = CMU_DD_ARM_II
LABELS = "x, s", "error, m"
REFUSALS = [
    (figures.curves, (T, {"y": {"a": T}}, "x", " "), "alt must describe"),
    (figures.families, ({}, LABELS, "A."), "panels must hold one panel or more"),
    *(
        (figures.families, ({"": {"a": (X, bad)}}, LABELS, "A."), "y of 'a' must")
        for bad in (X, given.FAN[:3], BAD * given.FAN)
    ),
    (figures.by_case, (X, {}, *LABELS, "A."), "cases must hold one case or more"),
    (figures.by_case, (X, given.CASES, "time, s", "elbow, °", "A."), "axis label must"),
    (
        figures.rmss_by_window,
        ({"a": {"test": {11: [0.1, 0.0]}}}, given.PRINTED),
        "errors of 'a' must be",
    ),
    (figures.decomposition, ({"a": np.ones(10)}, 0.01), "f must have an odd"),
    (beyond.maps, (X, {}, ("x", "y", "z"), "A."), "errors must hold a panel"),
    (beyond.maps, (X[:2], {"a": -np.ones((2, 2))}, (), "A."), "errors of 'a' must be positive"),
    (beyond.maps, (X[:2], {"a": np.ones((2, 3))}, (), "A."), "errors of 'a' must have shape"),
    (dynamics.arm_sketch, (ARM, [0.1, BAD]), "q must be finite"),
    (dynamics.arm_sketch, (ARM, [0.1]), "q must have"),
    (dynamics.hand_paths, (ARM, [BAD, 0.0]), "extents_deg must"),
    (dynamics.estimates, ({"a": fitted()}, [1.0, 2.0], ("x", "y"), 0.0), "limit must"),
    (dynamics.estimates, ({"a": fitted()}, [1.0], ("x", "y"), 5.0), "truth must"),
    (feedback.root_loci, ({}, [0.5, 1.0]), "loops must"),
    (feedback.nyquist, ({}, [1.0, 2.0]), "loops must"),
    *((feedback.root_loci, (given.LOOPS, bad), "gains must") for bad in NO_AXIS),
    *((feedback.nyquist, (given.LOOPS, bad), "frequencies must") for bad in NO_AXIS),
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
    (PLANE, (X, X[:2], given.PLANE, (), "A."), r"values must have .* \(2, 6\), got"),
    (PLANE, (X, X[:1], [-X], (), "A."), "values must be above 0"),
    (PLANE, (X, [np.inf], [X], (), "A."), "y must be finite"),
    (windows.intervals, ({"a": {"b": {"c": (1, 0, 2)}}}, "x", "A."), "of 'c' must be in order"),
    (filters.clusters, ({}, "N m", "A."), "panels must"),
    (filters.clusters, ({"a": ({"b": [BAD]}, 1.0)}, "N m", "A."), "values of 'b' must"),
    (filters.clusters, ({"a": ({"b": [0.0]}, np.inf)}, "N m", "A."), "wanted must"),
    (filters.against_nulls, ({}, "share", "A."), "panels must"),
    (filters.against_nulls, ({"a": {"b": {"c": [[1.0]]}}}, "share", "A."), "of 'b' must"),
    (smooth.predicted_curves, (X, {"a": (X, X[:3])}, {}, (), "A."), "values of 'a' must have"),
    (smooth.predicted_curves, (X, {}, {"b": (X, 0 * X)}, (), "A."), "values of 'b' must"),
    (states.torque_along, (T, given.EXACT, given.EXACT), "predicted must"),
    (states.responses, (X, given.ACTIVITY[0]), "activity must have shape"),
]


@pytest.mark.parametrize("draw, arguments, message", REFUSALS)
def test_refusals(draw, arguments, message):
    with pytest.raises(ValueError, match=message):
        draw(*arguments)
