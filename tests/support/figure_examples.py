"""Every figure of the book, by its name: drawn from few numbers, and what must then be seen."""

from functools import cache, partial

import numpy as np
from matplotlib.figure import Figure
from pictures import drawn

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
from ddlib.figures import Illustration
from ddlib.identification import Equations, least_squares
from ddlib.learning import Weights
from ddlib.logs import Log, LoggedRun, check_recording
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

# Shared by chapters
SPIKED = LoggedRun(
    "own.csv", T, np.stack([np.sin(3 * T) + 0.5 * (np.arange(50) == 20), np.cos(T)], -1),
    np.stack([-9 * np.sin(3 * T), -np.cos(T)], -1), np.arange(2, 52),
)  # fmt: skip
FAN = X[:, None] * [1.0, 2.0, 4.0, 7.0]
CURVES = {"q, rad": {"one": X, "two": X**2}, "error": {"two": (X[1:], 1 / X[1:])}}
CASES = {"small swing": np.sin(X), "large swing": 3 * np.sin(X), "none": 0 * X}
FILTERS = {f"unit {k}": RNG.normal(size=21).cumsum() for k in range(3)}
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
    "line": np.stack([np.linspace(0, 1, 30), -2 * np.linspace(0, 1, 30)], -1)[None],
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


EXAMPLES = {
    "curves": partial(shared.curves, X, CURVES, "time, s", "Lines.", x_log=True, y_log=True),
    "families": lambda: shared.families(
        {"a": {"one": (X, FAN)}, "b": {"two": (X, FAN), "one": (X, 2 * FAN)}}, LABELS, "Networks.",
        y_log=True,
    ),
    "by_case": partial(shared.by_case, X, CASES, "time, s", "error, °", "Three swings."),
    "rmss_by_window": partial(shared.rmss_by_window, TABLE, PRINTED),
    "network_diagram": lambda: shared.network_diagram(Weights.random(1, 21)[0]),
    "hinton": lambda: shared.hinton(Weights.random(1, 41)[0]),
    "decomposed": partial(shared.decomposed, FILTERS, 0.01),
    "checked": lambda: shared.checked(check_recording(Log((SPIKED,)))),
    "decomposed, one": lambda: shared.decomposed(FILTERS["unit 0"], 0.01),

    "arm_sketch": partial(dynamics.arm_sketch, CMU_DD_ARM_II, [0.6, 0.9]),
    "operations": partial(
        dynamics.operations, COUNTS, {"book": (4, 9000), "paper": (3, 600)}, (200, 1000)
    ),
    "estimates": lambda: dynamics.estimates(
        {"fair": fitted(100), "off": fitted(100, 0.5), "once": fitted()}, [1, 2], ("x", "y"), 20.0
    ),
    "feedforward_loop": feedforward.feedforward_loop,
    "reached": partial(
        recording.reached, {"quiet": 0.1 * RINGING, "ringing": RINGING}, radius=np.pi
    ),
    "rounding": partial(
        recording.rounding, T[:4], [0, 1, 1, 3], {"rough": [1, -1, 1, -1], "fine": np.zeros(4)}
    ),
    "tied": partial(recording.tied, {"one": TIED}),
    "side_by_side": partial(left_out.side_by_side, SIDES, "Three panels."),
    "side_by_side, log": partial(left_out.side_by_side, SIDES, "The same.", log=True),
    "ranking": partial(left_out.ranking, SIZES),
    "intervals": partial(
        windows.intervals, INTERVALS, "factor", "Rows.", log=True, band=(0.7, 1.4)
    ),
    "against_nulls": partial(filters.against_nulls, NULLS, "share of the filters", "Bars."),
    "by_explained": partial(
        filters.by_explained, NULLS["hidden"], {"mixed": GROUPS},
        ("share of the filters", "share explained"), "Two panels.",
    ),
    "hinton_states": lambda: states.hinton_states(Weights.random(1, 3)[0]),
    "torque_along": partial(states._torque_along, T, EXACT, NETWORKS),

    "courses": partial(
        adaptive_control.courses,
        {"A": {"one": ERRORS, "two": 2 * ERRORS}, "B": {"one": ERRORS, "two": ERRORS}},
        2, "a load", "error, mm", "Two.",
    ),
    "stops_map": partial(
        adaptive_control.stops_map, [0.1, 1.0, 10.0], [0, 2],
        {"A": (np.where(STOPPED, np.inf, 1.0), STOPPED)}, ("rate", "delay, ms", "error, mm"),
        "A map with a cross.",
    ),
    "ladders": partial(
        more_joints.ladders,
        {"network": {"two joints": (SIZE, ERRORS)}, "linear": {"two joints": (SIZE, 2 * ERRORS)}},
        LABELS, "Errors.", level=0.2,
    ),
    "couplings": partial(
        more_joints.gains_by_torque, INERTIA, REAL, UNRELATED[:, None, None] * np.ones((2, 2)),
        "gain over the deviation", "Gains.",
    ),
    "gains_by_joint": partial(
        real_arm.gains_by_joint, {"velocity": (GAINS, UNRELATED[:, None] / 2 * np.ones(6))}, "gain",
        "Two nets.",
    ),
    "dots": partial(
        rivals._dots, {"worse": ([0.2, 0.4, 0.3], "7"), "better": ([0.1, 0.2], "90")}, "better",
        0.02, ("RMSS", "numbers"), "Two rivals.",
    ),
    "six ways": rivals.from_window_to_torque,
    "parity": rivals.parity_drawn,
    "units at work": global_view.at_work,
    "against": partial(
        run_time.against,
        {"RMSS": MEMBERS, "loop, mm": {"21": (np.ones(2) * 5, np.ones(2) * 6)}}, "error, mm",
        "Two predictors.", ("loop, mm",),
    ),
    "verdicts": partial(verdict.sections_figure, {"section 2": {"reproduced": 3, "refuted": 1}}),
    "maps": partial(maps, EDGE, SQUARES, ("x, °", "y, °", "error"), "Maps.", mark=(20.0, 30.0)),
}  # fmt: skip


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

SHOWN = {
    "curves": [xy(X, X, X**2), xy(X[1:], 1 / X[1:])],
    "families": [xy(X, *FAN.T, 3 * X), xy(X, *FAN.T, 3 * X, *2 * FAN.T, 6 * X)],
    "by_case": [xy(X, case) for case in CASES.values()],
    "decomposition": [
        xy(10.0 * np.arange(-10, 11), f, (f + f[::-1]) / 2 - f.mean(), (f - f[::-1]) / 2)
        for f in FILTERS.values()
    ],
    "arm_sketch": [[[(0, 0), ELBOW], [ELBOW, HAND]]],
    "operations": [[[(2, 100), (3, 1000), (4, 10_000)], [(2, 500), (3, 500), (4, 500)]]],
    "reached": [list(RINGING[..., 2 * k : 2 * k + 2]) for k in range(3)],
    "rounding": [xy(T[:4], [0, 1, 1, 3]), xy(T[:4], [1, -1, 1, -1], [0, 0, 0, 0])],
    "tied": [[DOTS * [180 / np.pi, 1]]],
    "side_by_side": SIDE_BY_SIDE,
    "side_by_side, log": SIDE_BY_SIDE,
    "intervals": [  # one series above the other
        [
            [(0.5, -0.15), (2, -0.15)], [(1, -0.15)], [(1, 0.15), (4, 0.15)], [(2, 0.15)],
            [(1, 0.85), (1, 0.85)], [(1, 0.85)],
        ],
        [[(0.2, 0), (0.4, 0)], [(0.3, 0)]],
    ],
    "clusters": [
        [
            *xy([-0.25, 0, 0.25], GROUPS["few, one"]), [(-0.36, 2), (0.36, 2)],
            *xy(np.linspace(0.75, 1.25, 4), GROUPS["many"]), [(0.64, 4), (1.36, 4)],
            [(0, wanted), (1, wanted)],
        ]
        for wanted in (4, 0)
    ],
    "against_nulls": [  # bars with their ends, a dot for each draw
        [
            [(0, -0.43), (0.2, 0.43)], [(0.2, -0.43), (0.2, 0.43)], [(0.1, 0.57), (0.1, 1.43)],
            *xy([0.4] * 3, [-0.131, -0.129, np.nan]), *xy([0.7] * 3, [0.129, 0.131, np.nan]),
        ],
        [[(0, -0.43), (0, 0.43)], [(1, 0.57), (1, 1.43)]],
    ],
    "by_explained": [  # means, and the middle nine tenths
        [
            [(0.2, -0.38), (0.2, 0.38)], [(0.1, 0.62), (0.1, 1.38)], [(0.4, 0)], [(1, 1)],
        ],
        [[(0, 3), (1, 5)], [(0, 1.1), (0, 5.6)], [(1, 3), (1, 8.4)]],
    ],
    "torque_along": [xy(T, EXACT[:, j], NETWORKS[1, :, j]) for j in range(2)],  # the median network
    "courses": [xy([1, 2, 3], MIDDLE, 2 * MIDDLE), xy([1, 2, 3], MIDDLE)],
    "stops_map": [[[(1, 0)]]],
    "ladders": [
        [*xy(SIZE, MIDDLE), *spans(SIZE, ERRORS), [(0, 0.2), (1, 0.2)]],
        [*xy(SIZE, 2 * MIDDLE), *spans(SIZE, 2 * ERRORS)],
    ],
    "couplings": [
        [
            [(0.7, -0.9), (1.3, 0.9)], [(1.7, -0.9), (2.3, 0.9)],  # middle nine tenths of nulls
            [(0.64, 2.0), (1.36, 2.0)], [(1.64, 0.5), (2.36, 0.5)],
            *xy([0.8, 1.8], REAL[0, 0]), *xy([1, 2], REAL[1, 0]), *xy([1.2, 2.2], REAL[2, 0]),
        ],
        [*xy([0.8, 1.8], REAL[0, 1])],
    ],
    "gains_by_joint": [
        [
            *([(k - 0.275, -0.45), (k + 0.275, 0.45)] for k in JOINTS),
            *xy(JOINTS - 0.15, GAINS[0]), *xy(JOINTS + 0.15, GAINS[1]),
        ]
    ],
    "dots": [[[(0.1, 0), (0.2, 0)], [(0.2, 1), (0.4, 1)], [(0.3, 1)]]],  # the least on top
    "against": [[*xy([1, 2], [3, 4]), *xy([1] * 3, [7] * 3)], [[(5, 6)] * 2, [(5, 5), (6, 6)]]],
    "maps": [[[(20, 30)]]] * 3,
}  # fmt: skip
"""What each of a figure's axes must show: points, ``(x, y)``; bars from corner to corner."""


@cache
def made(name: str) -> tuple[Illustration, Figure]:
    """An example, and the matplotlib figure that it was made from."""
    return drawn(EXAMPLES[name])
