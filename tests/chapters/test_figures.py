"""All figures of the book: sound and accessible, and what is drawn are the data that were given.

A figure that is tested in a module of its own need not stand here: `pictures.check` asks the same.
"""

import re
from functools import cache, partial

import control
import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from pictures import check, drawn, ids, words

from beyond.chapters import (
    adaptive_control,
    joints_three_and_four as more_joints,
    real_arm,
    rivals,
    run_time,
    verdict,
)
from beyond.figures import maps
from ddlib import figures as shared
from ddlib.dynamics import CMU_DD_ARM_II, Operations
from ddlib.figures import COLOURS, INK
from ddlib.identification import Equations, check_recording, least_squares
from ddlib.learning import Weights
from ddlib.logs import Log, LoggedRun, resample
from workshop.chapters import (
    convolution_filters as filters,
    dynamics,
    feedforward,
    global_view,
    trajectories_and_recording as recording,
    what_lagrange_euler_leaves_out as left_out,
    whole_state_space as states,
    window_networks as windows,
)

RNG = np.random.default_rng(3)
LABELS = "motions, number", "error, mm"
X = np.linspace(1.0, 10.0, 6)
T = np.linspace(0.0, 3.0, 50)
W = np.geomspace(1 / 8, 25, 400)
GAIN = W * np.hypot(W, 2) / 5  # one over that of 5 / (s² + 2 s)

# Shared by chapters
SPIKED = LoggedRun(
    "own.csv", T, np.stack([np.sin(3 * T) + 0.5 * (np.arange(50) == 20), np.cos(T)], -1),
    np.stack([-9 * np.sin(3 * T), -np.cos(T)], -1), np.arange(2, 52),
)  # fmt: skip
FAN = X[:, None] * [1.0, 2.0, 4.0, 7.0]
CURVES = {"q, rad": {"one": X, "two": X**2}, "error": {"two": (X[1:], 1 / X[1:])}}
CASES = {"small swing": np.sin(X), "large swing": 3 * np.sin(X), "none": 0 * X}
CLOUDS = {"a line": (X, 3 * X), "a bend": (X, X**2)}
PRINTED = {"training": {11: 0.1, 21: 0.09, 41: 0.08}, "test": {11: 0.2, 21: 0.19, 41: 0.18}}
TABLE = {
    name: {column: {w: RNG.uniform(0.02, 0.4, 25) for w in (11, 21, 41)} for column in PRINTED}
    for name in ("one", "other")
}

# Parts I to III
COUNTS = {
    "steep": {n: Operations(10**n, 3) for n in (2, 3, 4)},
    "level": {n: Operations(500, 3) for n in (2, 3, 4)},
}
RINGING = np.zeros((2, 30, 6))
RINGING[1, 3] = [0.5, -0.7, 1.5, 0.0, 0.0, -9.0]
TIED = {
    "tight": np.stack([np.linspace(0, 1, 30), -2 * np.linspace(0, 1, 30)], -1)[None],
    "dots": RNG.normal(size=(2, 30, 2)),
}
SIDES = {
    ("a", "b"): {"one": (X, X), "two": (X, X**2)},
    ("c", "d"): {"two": (X, 2 * X), "three": (X, 3 * X)},
    ("e", "f"): {"alone": (X, X)},
}
SIZES = {"small": [0.02, 0.01], "large": [8.0, 2.0], "middle": [0.5, 0.9]}
INTERVALS = {
    "left": {"a": {"gain": (0.5, 1.0, 2.0), "friction": (1.0, 1.0, 1.0)}, "b": {"gain": (1, 2, 4)}},
    "right": {"a": {"gain": (0.2, 0.3, 0.4)}},
}
GROUPS = {"few, one": np.array([1.0, 2.0, 6.0]), "many": np.array([3.0, 3.0, 5.0, 9.0])}
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
EXACT = np.stack([np.sin(T), 0.1 * np.cos(T)], -1)
NETWORKS = EXACT + np.array([0.01, 0.02, 0.05])[:, None, None]

# Part IV
SIZE = np.array([5, 10, 20])
ERRORS = np.array([[0.5, 0.7, 0.6], [0.3, 0.2, 0.1], [0.08, 0.09, 0.1]])
STOPPED = np.array([[False, True, False], [False, False, False]])
INERTIA = np.array([[2.0, 0.5], [0.6, 1.0]])
REAL = INERTIA + np.array([-0.1, 0.0, 0.1])[:, None, None]
UNRELATED = np.linspace(-1.0, 1.0, 21)
GAINS = np.array([[1.0, 0.9, 1.1, 1.2, 0.8, 1.0], [1.1, 1.0, 1.2, 1.3, 0.9, 1.1]])
MEMBERS = {"11": (np.array([1.0, 2.0]), np.array([3.0, 4.0])), "21": (np.ones(3), 7 * np.ones(3))}
EDGE = np.array([10.0, 20.0, 30.0])
SQUARES = {"one": np.arange(1.0, 10.0).reshape(3, 3), "two": np.full((3, 3), 0.5)}
SQUARES["three"] = 2 * SQUARES["two"]


def fitted(repetitions=None, offset=0.0):
    """Estimates of two parameters of which the truth is 1 and 2."""
    rng = np.random.default_rng(0)
    a = rng.normal(size=(50, 2))
    shape = (50,) if repetitions is None else (repetitions, 50)
    y = a @ [1.0 + offset, 2.0 + offset] + 0.1 * rng.normal(size=shape)
    return least_squares(Equations(("x", "y"), (np.broadcast_to(a, (*shape, 2)),), (y,)))


def xy(x, *heights) -> list[np.ndarray]:
    """A curve for each array of heights over the same places."""
    return [np.transpose([x, y]) for y in heights]


def spans(x, values) -> list:
    """A vertical stroke at each place, from the least to the largest of its values."""
    return [[(x, low), (x, high)] for x, low, high in zip(x, values.min(1), values.max(1))]


MIDDLE = np.median(ERRORS, 1)
ELBOW, HAND = CMU_DD_ARM_II.forward_kinematics(np.array([0.6, 0.9]))
DOTS = TIED["dots"].reshape(-1, 2)
SIDE_BY_SIDE = [xy(X, X, X**2), xy(X, 2 * X, 3 * X), xy(X, X)]
JOINTS = np.arange(1, 7)


def figure(make, **seen):
    """How a figure is made, and what `pictures.check` is to find in it."""
    return make, seen


FIGURES = {
    "curves": figure(
        partial(shared.curves, X, CURVES, "time, s", "Lines.", x_log=True, y_log=True),
        shows=[xy(X, X, X**2), xy(X[1:], 1 / X[1:])], log="xy",
    ),
    "families": figure(
        lambda: shared.families(
            {"a": {"one": (X, FAN)}, "b": {"two": (X, FAN), "one": (X, 2 * FAN)}},
            LABELS, "Networks.", y_log=True,
        ),
        shows=[xy(X, *FAN.T, 3 * X), xy(X, *FAN.T, 3 * X, *2 * FAN.T, 6 * X)], log="y",
    ),
    "clouds": figure(
        partial(shared.clouds, CLOUDS, ("position, °", "time, s"), "Dots.", slope=2.0),
        shows=[xy(X[[0, -1]], 2 * X[[0, -1]])] * 2,
    ),
    "by_case": figure(
        partial(shared.by_case, X, CASES, "time, s", "error, °", "Three swings."),
        shows=[xy(X, case) for case in CASES.values()],
    ),
    "poles_and_bode": figure(
        partial(
            shared.poles_and_bode, {"one": control.tf(5, [1, 2, 0])}, "One loop.", decay=1.0
        ),
        shows=[[np.array([[-1.0, 2.0], [-1.0, -2.0]])], [xy(W, -20 * np.log10(GAIN))[0]]], log=None,
    ),
    "rmss_by_window": figure(partial(shared.rmss_by_window, TABLE, PRINTED), log="y"),
    "network_diagram": figure(lambda: shared.network_diagram(Weights.random(1, 21)[0])),
    "checked": figure(lambda: shared.checked(check_recording(resample(Log((SPIKED,)))))),
    "arm_sketch": figure(
        partial(dynamics.arm_sketch, CMU_DD_ARM_II, [0.6, 0.9]),
        shows=[[[(0, 0), ELBOW], [ELBOW, HAND]]], upon="#ffffff",
    ),
    "operations": figure(
        partial(
            dynamics.operations, COUNTS, {"book": (4, 9000), "paper": (3, 600)}, (200, 1000)
        ),
        shows=[[[(2, 100), (3, 1000), (4, 10_000)], [(2, 500), (3, 500), (4, 500)]]], log="y",
    ),
    "estimates": figure(
        lambda: dynamics.estimates(
            {"fair": fitted(100), "off": fitted(100, 0.5), "once": fitted()},
            [1, 2], ("x", "y"), 20.0,
        ),
    ),
    "feedforward_loop": figure(feedforward.feedforward_loop),
    "reached": figure(
        partial(
            recording.reached, {"quiet": 0.1 * RINGING, "ringing": RINGING}, radius=np.pi
        ),
        shows=[list(RINGING[..., 2 * k : 2 * k + 2]) for k in range(3)],
    ),
    "rounding": figure(
        partial(
            recording.rounding, T[:4], [0, 1, 1, 3], {"rough": [1, -1, 1, -1], "fine": np.zeros(4)}
        ),
        shows=[xy(T[:4], [0, 1, 1, 3]), xy(T[:4], [1, -1, 1, -1], [0, 0, 0, 0])],
    ),
    "tied": figure(partial(recording.tied, {"one": TIED}), shows=[[DOTS * [180 / np.pi, 1]]]),
    "side_by_side": figure(
        partial(left_out.side_by_side, SIDES, "Three panels."), shows=SIDE_BY_SIDE,
    ),
    "side_by_side, log": figure(
        partial(left_out.side_by_side, SIDES, "The same.", log=True), shows=SIDE_BY_SIDE, log="xy",
    ),
    "ranking": figure(partial(left_out.ranking, SIZES), log="x", upon="#000000"),
    "intervals": figure(
        partial(
            windows.intervals, INTERVALS, "factor", "Rows.", log=True, band=(0.7, 1.4)
        ),
        shows=[  # one series above the other
            [
                [(0.5, -0.15), (2, -0.15)], [(1, -0.15)], [(1, 0.15), (4, 0.15)], [(2, 0.15)],
                [(1, 0.85), (1, 0.85)], [(1, 0.85)],
            ],
            [[(0.2, 0), (0.4, 0)], [(0.3, 0)]],
        ],
        log="x",
    ),
    "against_nulls": figure(
        partial(filters.against_nulls, NULLS, "share of the filters", "Bars."),
        shows=[  # bars with their ends, a dot for each draw
            [
                [(0, -0.43), (0.2, 0.43)], [(0.2, -0.43), (0.2, 0.43)], [(0.1, 0.57), (0.1, 1.43)],
                *xy([0.4] * 3, [-0.131, -0.129, np.nan]), *xy([0.7] * 3, [0.129, 0.131, np.nan]),
            ],
            [[(0, -0.43), (0, 0.43)], [(1, 0.57), (1, 1.43)]],
        ],
    ),
    "by_explained": figure(
        partial(
            filters.by_explained, NULLS["hidden"], {"mixed": GROUPS},
            ("share of the filters", "share explained"), "Two panels.",
        ),
        shows=[  # means, and the middle nine tenths
            [
                [(0.2, -0.38), (0.2, 0.38)], [(0.1, 0.62), (0.1, 1.38)], [(0.4, 0)], [(1, 1)],
            ],
            [[(0, 3), (1, 5)], [(0, 1.1), (0, 5.6)], [(1, 3), (1, 8.4)]],
        ],
    ),
    "torque_along": figure(
        partial(states._torque_along, T, EXACT, NETWORKS),
        shows=[xy(T, EXACT[:, j], NETWORKS[1, :, j]) for j in range(2)],
    ),
    "courses": figure(
        partial(
            adaptive_control.courses,
            {"A": {"one": ERRORS, "two": 2 * ERRORS}, "B": {"one": ERRORS, "two": ERRORS}},
            2, "a load", "error, mm", "Two.",
        ),
        shows=[xy([1, 2, 3], MIDDLE, 2 * MIDDLE), xy([1, 2, 3], MIDDLE)], log="y",
    ),
    "stops_map": figure(
        partial(
            adaptive_control.stops_map, [0.1, 1.0, 10.0], [0, 2],
            {"A": (np.where(STOPPED, np.inf, 1.0), STOPPED)}, ("rate", "delay, ms", "error, mm"),
            "A map with a cross.",
        ),
        shows=[[[(1, 0)]]], log=None,
    ),
    "ladders": figure(
        partial(
            more_joints.ladders,
            {"network": {"two joints": (SIZE, ERRORS)},
             "linear": {"two joints": (SIZE, 2 * ERRORS)}},
            LABELS, "Errors.", level=0.2,
        ),
        shows=[
            [*xy(SIZE, MIDDLE), *spans(SIZE, ERRORS), [(0, 0.2), (1, 0.2)]],
            [*xy(SIZE, 2 * MIDDLE), *spans(SIZE, 2 * ERRORS)],
        ],
        log="xy",
    ),
    "couplings": figure(
        partial(
            more_joints.gains_by_torque, INERTIA, REAL, UNRELATED[:, None, None] * np.ones((2, 2)),
            "gain over the deviation", "Gains.",
        ),
        shows=[
            [
                [(0.7, -0.9), (1.3, 0.9)], [(1.7, -0.9), (2.3, 0.9)],  # middle nine tenths of nulls
                [(0.64, 2.0), (1.36, 2.0)], [(1.64, 0.5), (2.36, 0.5)],
                *xy([0.8, 1.8], REAL[0, 0]), *xy([1, 2], REAL[1, 0]), *xy([1.2, 2.2], REAL[2, 0]),
            ],
            [*xy([0.8, 1.8], REAL[0, 1])],
        ],
    ),
    "gains_by_joint": figure(
        partial(
            real_arm.gains_by_joint, {"velocity": (GAINS, UNRELATED[:, None] / 2 * np.ones(6))},
            "gain", "Two nets.",
        ),
        shows=[
            [
                *([(k - 0.275, -0.45), (k + 0.275, 0.45)] for k in JOINTS),
                *xy(JOINTS - 0.15, GAINS[0]), *xy(JOINTS + 0.15, GAINS[1]),
            ]
        ],
    ),
    "dots": figure(
        partial(
            rivals._dots, {"worse": ([0.2, 0.4, 0.3], "7"), "better": ([0.1, 0.2], "90")}, "better",
            0.02, ("RMSS", "numbers"), "Two rivals.",
        ),
        shows=[[[(0.1, 0), (0.2, 0)], [(0.2, 1), (0.4, 1)], [(0.3, 1)]]], log="x",
    ),
    "six ways": figure(rivals.from_window_to_torque),
    "units at work": figure(global_view.at_work),
    "against": figure(
        partial(
            run_time.against,
            {"RMSS": MEMBERS, "loop, mm": {"21": (np.ones(2) * 5, np.ones(2) * 6)}}, "error, mm",
            "Two predictors.", ("loop, mm",),
        ),
        shows=[[*xy([1, 2], [3, 4]), *xy([1] * 3, [7] * 3)], [[(5, 6)] * 2, [(5, 5), (6, 6)]]],
        log="xy",
    ),
    "verdicts": figure(
        partial(verdict.sections_figure, {"section 2": {"reproduced": 3, "refuted": 1}})
    ),
    "maps": figure(
        partial(maps, EDGE, SQUARES, ("x, °", "y, °", "error"), "Maps.", mark=(20.0, 30.0)),
        shows=[[[(20, 30)]]] * 3, log=None, upon="#ffffff",
    ),
}  # fmt: skip


@cache
def made(name: str):
    """A figure, and the matplotlib figure behind it."""
    return drawn(FIGURES[name][0])


@pytest.mark.parametrize("name", FIGURES)
def test_sound_accessible_and_true_to_the_data(name):
    check(*made(name), **FIGURES[name][1])


def test_no_two_figures_share_an_id():
    every = [name for key in FIGURES for name in ids(made(key)[0].svg)]
    assert len(every) == len(set(every)) > 20


def test_table_4_1_has_every_network_medians_and_printed_values():
    _, figure = made("rmss_by_window")
    for axis, (column, printed) in zip(figure.axes, PRINTED.items(), strict=True):
        cells = [errors for named in TABLE.values() for errors in named[column].values()]
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


def test_clouds_have_a_dot_for_each_pair():
    for axis, (title, pair) in zip(made("clouds")[1].axes, CLOUDS.items()):
        assert axis.get_title(loc="left") == title
        (dots,) = axis.patches
        np.testing.assert_array_equal(dots.get_path().vertices[::2], np.stack(pair, -1))


def test_panels_are_headed_by_their_cases():
    axes = made("by_case")[1].axes
    assert [axis.get_title(loc="left") for axis in axes] == list(CASES)


def test_maps_have_a_cell_for_every_value():
    """Stopped runs are masked; of several maps there is one scale of colours."""

    def cells(axis):
        return next(part for part in axis.collections if isinstance(part, QuadMesh))

    for axis, (title, values) in zip(made("maps")[1].axes, SQUARES.items()):
        assert axis.get_title(loc="left") == title
        np.testing.assert_array_equal(cells(axis).get_array(), values.T)
        assert (cells(axis).norm.vmin, cells(axis).norm.vmax) == (0.5, 9.0)
    np.testing.assert_array_equal(cells(made("stops_map")[1].axes[0]).get_array().mask, STOPPED)


def test_shares_stand_beside_repeated_estimates_only():
    picture, _ = made("estimates")
    shares = [text.removesuffix(" %") for text in words(picture) if re.fullmatch(r"\d+ %", text)]
    fair = 100 * fitted(100).covers([1.0, 2.0]).mean(0)
    assert shares == [f"{fair[0]:.0f}", "0", f"{fair[1]:.0f}", "0"]  # two panels
    assert "off: x 50, y 25" in picture.alt and "fair: x" in picture.alt


def test_bars_stand_in_order_and_are_as_long_as_their_torques():
    _, figure = made("ranking")
    (axis,) = figure.axes
    assert axis.get_xscale() == "log" and axis.yaxis_inverted()
    for j, container in enumerate(axis.containers):
        ends = [bar.get_x() + bar.get_width() for bar in container]
        wanted = [SIZES[name][j] for name in ("large", "middle", "small")]
        np.testing.assert_allclose(ends, wanted)
        assert (np.diff([bar.get_y() for bar in container]) > 0).all()
