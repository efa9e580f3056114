"""Limits of single arguments as documented: what lies on them is taken, what lies beyond is not.

Every row names an argument, calls with a value of it, values that are accepted (the limits where
they belong to the range) and values just beyond that are refused by name.
"""

import warnings

import numpy as np
import pytest

from ddlib.analysis import coverage, filters, hidden_units, noise, sensitivity
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.learning import levenberg_marquardt, network, training, windows

OVER, UNDER = 1 + 1e-9, 1 - 1e-9
JUST_BELOW = -1e-12
RNG = np.random.default_rng(0)
SAMPLES = RNG.uniform(0.1, 0.9, (30, 4))
FILTERS = RNG.normal(size=(3, 11))
WEIGHTS = network.Weights.random(1, 5)
DATA = training.TrainingSet(
    RNG.uniform(size=(12, 2, 5)), RNG.uniform(0.2, 0.8, (12, 2)),
    windows.Scaler(np.zeros(2), np.ones(2)), windows.Scaler(np.zeros(2), np.ones(2)),
)  # fmt: skip


def solve(**options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", levenberg_marquardt.NotConverged)
        return levenberg_marquardt.solve(WEIGHTS, DATA, progress=False, **{"steps": 1, **options})


ROWS = [
    ("step", lambda x: coverage.log10_reachable_share(5, x), [1e-6, 0.5], [0.0, 0.5 * OVER]),
    ("name", lambda x: filters.purest(FILTERS, x), ["not analysable"], ["speed"]),
    ("width", filters.basis, [4, 5], [3, 4.0]),
    ("width", lambda x: filters.savitzky_golay(x, 1, 0.1, 2), [3, 5], [1, 2, 4]),
    ("degree", lambda x: filters.savitzky_golay(5, 0, 0.1, x), [0, 4], [-1, 5]),
    ("derivative", lambda x: filters.savitzky_golay(7, x, 0.1, 3), [0, 3], [-1, 4]),
    ("deviation", lambda x: noise.noise_floor(ARM, x, 5, 16, 0.1, 0.1),
     [(0.5, 0.1)], [(0.5, 0.0), (0.0, 1.0), (1.0,), ((1.0, 1.0),)]),
    ("bits", lambda x: noise.noise_floor(ARM, (1, 1), 5, x, 0.1, 0.1),
     [1, 40], [UNDER, 40 * OVER]),
    ("margin", lambda x: sensitivity.transition_range(WEIGHTS, x),
     [1e-6, 0.49], [0.0, 0.49 * OVER]),
    ("tolerance", lambda x: solve(tolerance=x), [0.0, 0.5, 1.0], [JUST_BELOW, OVER]),
    ("decay", lambda x: solve(decay=x), [0.0, 0.5], [JUST_BELOW]),
    ("margin", lambda x: hidden_units.saturated(SAMPLES, x), [0.0, 0.5], [JUST_BELOW, 0.5 * OVER]),
]  # fmt: skip


@pytest.mark.parametrize("name, call, accepted, refused", ROWS)
def test_limits(name, call, accepted, refused):
    for value in accepted:
        call(value)
    for value in (*refused, np.nan, "three", None):
        with pytest.raises((ValueError, TypeError), match=name):
            call(value)
