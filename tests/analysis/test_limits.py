"""Limits of single arguments as documented: what lies on them is taken, what lies beyond is not.

Every row names an argument, calls with a value of it, values that are accepted (the limits where
they belong to the range) and values just beyond that are refused by name.
"""

import warnings

import numpy as np
import pytest

from ddlib import trajectories
from ddlib.analysis import (
    coverage,
    filters,
    following,
    hidden_units,
    noise,
    sensitivity,
    simplified,
)
from ddlib.control import linear
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.identification import regression
from ddlib.learning import autograd, levenberg_marquardt, network, training, windows

OVER, UNDER = 1 + 1e-9, 1 - 1e-9
JUST_BELOW = -1e-12
RNG = np.random.default_rng(0)
SAMPLES = RNG.uniform(0.1, 0.9, (30, 4))
T = np.arange(40) * 0.01
MOTION = trajectories.pick_and_place((20.0, 30.0), T)
FILTERS = RNG.normal(size=(3, 11))
WEIGHTS = network.Weights.random(1, 5)
DATA = training.TrainingSet(
    RNG.uniform(size=(12, 2, 5)), RNG.uniform(0.2, 0.8, (12, 2)),
    windows.Scaler(np.zeros(2), np.ones(2)), windows.Scaler(np.zeros(2), np.ones(2)),
)  # fmt: skip
EQUATIONS = regression.from_states(*MOTION, ARM.inverse_dynamics(*MOTION))
COURSE = training.History(np.array([1, 10, 100]), np.array([[1.0], [0.5], [0.4]]), None)


def solve(**options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", levenberg_marquardt.NotConverged)
        return levenberg_marquardt.solve(WEIGHTS, DATA, progress=False, **{"steps": 1, **options})


ROWS = [
    ("radius", lambda x: coverage.cells_reached(SAMPLES, x, 3), [1e-6, 0.5], [0.0]),
    ("cells", lambda x: coverage.cells_reached(SAMPLES, 1.0, x), [1, 2], [0, 1.5]),
    ("width", lambda x: coverage.log10_reachable_share(x, 0.1), [1, 2], [0, 2.0]),
    ("step", lambda x: coverage.log10_reachable_share(5, x), [1e-6, 0.5], [0.0, 0.5 * OVER]),
    ("resolution", lambda x: coverage.used_dimensions(SAMPLES, x), [0.0, 0.5], [JUST_BELOW]),
    ("name", lambda x: filters.purest(FILTERS, x), ["not analysable"], ["speed"]),
    ("width", filters.basis, [4, 5], [3, 4.0]),
    ("width", lambda x: filters.savitzky_golay(x, 1, 0.1, 2), [3, 5], [1, 2, 4]),
    ("degree", lambda x: filters.savitzky_golay(5, 0, 0.1, x), [0, 4], [-1, 5]),
    ("derivative", lambda x: filters.savitzky_golay(7, x, 0.1, 3), [0, 3], [-1, 4]),
    ("step", lambda x: filters.savitzky_golay(5, 1, x), [1e-6, 0.5], [0.0]),
    ("step", lambda x: filters.frequency_response(FILTERS, [1.0], x), [1e-6, 0.5], [0.0]),
    ("rounds", lambda x: regression.least_squares(EQUATIONS, x), [1, 2], [0, 1.0]),
    ("inertia", lambda x: linear.proportional_limit(x, 0.1, 1e-3), [1e-3, 0.5], [0.0]),
    ("viscous", lambda x: linear.proportional_limit(1.0, x, 1e-3), [1e-3, 0.5], [JUST_BELOW]),
    ("period", lambda x: linear.proportional_limit(1.0, 0.1, x), [1e-3, 0.5], [0.0]),
    ("hidden", lambda x: autograd.WindowNetwork(5, x), [1, 2], [0, 1.0]),
    ("members", lambda x: network.Weights.random(x, 5), [1, 2], [0, 1.0]),
    ("width", lambda x: network.Weights.random(1, x), [1, 2], [0, 1.0]),
    ("hidden", lambda x: network.Weights.random(1, 5, x), [1, 2], [0, 1.0]),
    ("seed", lambda x: network.Weights.random(1, 5, seed=x), [0, 1], [-1, 1.0]),
    ("initial", lambda x: autograd.WindowNetwork(5, initial=x), [1e-6, 0.5], [0.0]),
    ("deviation", lambda x: noise.noise_floor(ARM, x, 5, 16, 0.1, 0.1),
     [(0.5, 0.1)], [(0.5, 0.0), (0.0, 1.0), (1.0,), ((1.0, 1.0),)]),
    ("bits", lambda x: noise.noise_floor(ARM, (1, 1), 5, x, 0.1, 0.1),
     [1, 40], [UNDER, 40 * OVER]),
    ("torque_noise", lambda x: noise.noise_floor(ARM, (1, 1), 5, 9, x, 0.1),
     [0.0, 0.5], [JUST_BELOW]),
    ("step", lambda x: following.gains(FILTERS, x), [1e-6, 0.5], [0.0]),
    ("margin", lambda x: sensitivity.transition_range(WEIGHTS, x),
     [1e-6, 0.49], [0.0, 0.49 * OVER]),
    ("rotor", lambda x: simplified.share_of_other_joint(ARM, MOTION, [1.0], x),
     [0.0, 0.5], [JUST_BELOW]),
    ("steps", lambda x: solve(steps=x), [1, 2], [0, 1.0]),
    ("tolerance", lambda x: solve(tolerance=x), [0.0, 0.5, 1.0], [JUST_BELOW, OVER]),
    ("target_rmss", lambda x: solve(target_rmss=x), [0.0, 0.5], [JUST_BELOW]),
    ("decay", lambda x: solve(decay=x), [0.0, 0.5], [JUST_BELOW]),
    ("steepest", COURSE.settled, [0.0, 0.5], [JUST_BELOW]),
    ("n", lambda x: trajectories.random_extents(x, 0), [1, 2], [0, 1.0]),
    ("seed", lambda x: trajectories.random_extents(2, x), [0, 1], [-1, 1.0]),
    ("max_deg", lambda x: trajectories.random_extents(2, 0, x), [1e-6, 0.5], [0.0]),
    ("step", trajectories.time_grid, [0.01, 0.5], [0.0]),
    ("rest", lambda x: trajectories.time_grid(0.01, x), [0.0, 0.5], [JUST_BELOW]),
    ("margin", lambda x: hidden_units.saturated(SAMPLES, x), [0.0, 0.5], [JUST_BELOW, 0.5 * OVER]),
    (
        "margin",
        lambda x: hidden_units.transition_width(SAMPLES, x),
        [1e-6, 0.49],
        [0.0, 0.49 * OVER],
    ),
]  # fmt: skip


def identify(rows):
    return [f"{row[0]}-{k}" for k, row in enumerate(rows)]


@pytest.mark.parametrize("name, call, accepted, refused", ROWS, ids=identify(ROWS))
def test_limits(name, call, accepted, refused):
    for value in accepted:
        call(value)
    for value in refused:
        with pytest.raises((ValueError, TypeError), match=name):
            call(value)
    if not isinstance((accepted or refused)[0], str):
        for value in (np.nan, "three", None if name not in ("period", "rate") else np.inf):
            if value is None and name == "target_rmss":
                continue
            with pytest.raises((ValueError, TypeError), match=name):
                call(value)
