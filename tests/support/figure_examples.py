"""Every figure of the book, drawn from few and round numbers: `EXAMPLES`, by the figure's name."""

from functools import cache, partial

import numpy as np
from matplotlib.figure import Figure
from pictures import drawn

from ddlib import figures as shared
from ddlib.control import loop_gain
from ddlib.dynamics import CMU_DD_ARM_II, Operations
from ddlib.figures import Illustration
from ddlib.identification import Equations, least_squares
from ddlib.learning import Weights
from ddlib.trajectories import APPENDIX_I
from workshop.beyond.figures import maps
from workshop.chapters import (
    adaptive_control,
    convolution_filters as filters,
    dynamics,
    feedback,
    feedforward,
    joints_three_and_four as more_joints,
    learning_in_the_loop as in_loop,
    real_arm,
    rivals,
    run_time,
    stirring,
    trajectories_and_recording as recording,
    what_lagrange_euler_leaves_out as left_out,
    whole_state_space as states,
    why_smooth_filters as smooth,
    window_networks as windows,
)

RNG = np.random.default_rng(3)
LABELS = "motions, number", "error, mm"
X = np.linspace(1.0, 10.0, 6)
T = np.linspace(0.0, 3.0, 50)

# Shared by chapters
FAN = X[:, None] * [1.0, 2.0, 6.0]
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
LOOPS = {"P": loop_gain(4.0, 1.0, 100.0), "PD": loop_gain(4.0, 1.0, 100.0, 0.0, 24.0)}
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
MEASURED = np.sin(T)
PREDICTED = {"window 11": np.cos(T), "window 41": 0.9 * np.sin(T)}
ACROSS, UP = np.linspace(0, 45, 4), np.linspace(0, 45, 3)
PLANE = np.outer([1.0, 2.0, 4.0], [0.1, 0.2, 0.5, 1.0])
PLACES = [(0, 0), (45, 0), (0, 45), (20, 20)], [(40, 10)]
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
COURSES = {"slow": (X, 2 * X), "fast": (X**2, X**3)}
ENDS = {"one": ([1e-3, 1.0], [1e-2, 1.0]), "two": ([10.0], [5.0])}
EXACT = np.stack([np.sin(T), 0.1 * np.cos(T)], -1)
NETWORKS = EXACT + np.array([0.01, 0.02, 0.05])[:, None, None]
ACTIVITY = np.zeros((2, 3, 6, 4))
ACTIVITY[1, 0] = np.linspace(0.0, 1.0, 6)[:, None]
BY_SIZE = {
    "samples": {
        "solver": {100: [0.4, 0.2, 0.1], 10_000: [0.05, 0.02, 0.01]},
        "descent": {100: [0.3, 0.3]},
    },
    "units": {"descent": {5: [0.2], 80: [0.1]}},
}

# Part IV
SIZE = np.array([5, 10, 20])
ERRORS = np.array([[0.5, 0.7, 0.6], [0.3, 0.2, 0.1], [0.08, 0.09, 0.1]])
STOPPED = np.array([[False, True, False], [False, False, False]])
INERTIA = np.array([[2.0, 0.5], [0.6, 1.0]])
REAL = INERTIA + np.array([-0.1, 0.0, 0.1])[:, None, None]
UNRELATED = np.linspace(-1.0, 1.0, 21)
GAINS = np.array([[1.0, 0.9, 1.1, 1.2, 0.8, 1.0], [1.1, 1.0, 1.2, 1.3, 0.9, 1.1]])
SPEED = np.linspace(-2.0, 1.0, 31)
MIDDLES = np.array([-1.5, 0.5]), np.array([-2.0, 1.2])
FRICTION = {
    name: (SPEED, 0.5 * SPEED + jump * np.sign(SPEED), *MIDDLES, (0.5, jump))
    for name, jump in (("joint 1", 0.2), ("joint 2", 0.4))
}
RATIOS = {
    "the same": {"one": np.array([0.1, 0.2, 0.9]), "two": np.array([1.0, 2.0, 3.0])},
    "faster": {"one": np.array([0.5, 0.6, 0.7]), "two": np.array([1.0, 4.0, 5.0])},
}
COST = [100, 10, 1000], np.full((3, 4), 0.1), np.full((3, 4), 0.3)
UNSORTED = COST[0], ERRORS / 2, ERRORS
MEMBERS = {"11": (np.array([1.0, 2.0]), np.array([3.0, 4.0])), "21": (np.ones(3), 7 * np.ones(3))}
WANTED = np.stack([np.cos(2 * T), np.sin(2 * T)], -1)
OFF = WANTED + np.array((0.01, -0.02))
STATES = np.arange(24.0).reshape(4, 6)
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
    "decomposition": partial(shared.decomposition, FILTERS, 0.01),

    "arm_sketch": partial(dynamics.arm_sketch, CMU_DD_ARM_II, [0.6, 0.9]),
    "hand_paths": partial(dynamics.hand_paths, CMU_DD_ARM_II, APPENDIX_I),
    "operations": partial(
        dynamics.operations, COUNTS, {"book": (4, 9000), "paper": (3, 600)}, (200, 1000)
    ),
    "estimates": lambda: dynamics.estimates(
        {"fair": fitted(100), "off": fitted(100, 0.5), "once": fitted()}, [1, 2], ("x", "y"), 20.0
    ),
    "root_loci": partial(feedback.root_loci, LOOPS, np.geomspace(1e-4, 5, 50)),
    "nyquist": partial(feedback.nyquist, LOOPS, np.geomspace(0.5, 50, 401)),
    "feedforward_loop": feedforward.feedforward_loop,
    "extents_square": partial(
        recording.extents_square, APPENDIX_I[:5], APPENDIX_I[5], [[10.0, 20.0]]
    ),
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
    "overlay": partial(windows.overlay, T, MEASURED, PREDICTED),
    "plane": partial(
        windows.plane, ACROSS, UP, PLANE, ("shoulder, °", "elbow, °", "error"), "A map.",
        levels=(1.0, 0.5), training=PLACES[0], test=PLACES[1],
    ),
    "intervals": partial(
        windows.intervals, INTERVALS, "factor", "Rows.", log=True, band=(0.7, 1.4)
    ),
    "intervals, ends": partial(
        windows.intervals, {"all": {"a": {"gain": (-0.5, 0.0, 0.9)}}}, "place", "Rows with ends.",
        marks={"all": {"gain": 0.3}}, ends={"gain": ("300", "900")},
    ),
    "clusters": partial(
        filters.clusters, {"left": (GROUPS, 4.0), "right": (GROUPS, 0.0)}, "N m", "Groups."
    ),
    "against_nulls": partial(filters.against_nulls, NULLS, "share of the filters", "Bars."),
    "predicted_curves": partial(
        smooth.predicted_curves, X, COURSES, ENDS, ("epoch", "change", "foreseen", "measured"),
        "Lines and dots.",
    ),
    "hinton_states": lambda: states.hinton_states(Weights.random(1, 3)[0]),
    "torque_along": partial(states.torque_along, T, EXACT, NETWORKS),
    "error_by_size": partial(states.error_by_size, BY_SIZE),
    "responses": partial(states.responses, X, ACTIVITY),

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
    "growth": partial(
        more_joints.growth, [2, 4, 7], [4, 9, 15], [[3, 8, 12], [5, 10, 20]], [4, 8, 14],
        LABELS, ("found", "a law"), "Growth.",
    ),
    "couplings": partial(
        more_joints.couplings, INERTIA, REAL, UNRELATED[:, None, None] * np.ones((2, 2)),
        "gain over the deviation", "Gains.",
    ),
    "by_trial": partial(
        in_loop.by_trial,
        {"from nothing": {"none": (SIZE, ERRORS), "one": (SIZE, 2 * ERRORS)}}, LABELS, "Falls.",
        change=(7.5, "a load"),
    ),
    "by_motion": partial(in_loop.by_motion, RATIOS, "error ratio", "Two motions."),
    "friction_by_joint": partial(real_arm.friction_by_joint, FRICTION, LABELS, "Two joints."),
    "gains_by_joint": partial(
        real_arm.gains_by_joint, {"velocity": (GAINS, UNRELATED[:, None] / 2 * np.ones(6))}, "gain",
        "Two nets.",
    ),
    "costs": partial(
        rivals.costs, {"tables": {"one": UNSORTED, "two": COST}, "bases": {"three": COST}},
        ("network", COST), 0.02, ("stored numbers", "RMSS"), "Errors over numbers.",
    ),
    "against": partial(
        run_time.against,
        {"RMSS": MEMBERS, "loop, mm": {"21": (np.ones(2) * 5, np.ones(2) * 6)}}, "error, mm",
        "Two predictors.", ("loop, mm",),
    ),
    "traded": partial(
        stirring.traded, {"one": ([1.0, 2.0], [30.0, 20.0]), "other": ([3.0], [4.0])}, (10.0, 15.0),
        LABELS, "Dots.",
    ),
    "paths": partial(stirring.paths, WANTED, {"none": OFF, "exact": WANTED}, 10, "Two paths."),
    "two_families": partial(stirring.two_families, {"first": STATES, "second": -STATES}, "Clouds."),
    "maps": partial(maps, EDGE, SQUARES, ("x, °", "y, °", "error"), "Maps.", mark=(20.0, 30.0)),
}  # fmt: skip


@cache
def made(name: str) -> tuple[Illustration, Figure]:
    """An example, and the matplotlib figure that it was made from."""
    return drawn(EXAMPLES[name])
