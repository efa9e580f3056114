"""What lies behind the claims on recordings: accelerations and chances by other ways."""

from math import comb

import numpy as np
import pytest

from ddlib.paper import APPENDIX_I_EXTENTS_DEG, SAMPLES_PER_TRAJECTORY
from ddlib.setups import SETUPS
from workshop.report.measures import trajectories


@pytest.mark.parametrize("name", SETUPS)
def test_states_hold_the_derivatives_of_the_motion(name):
    states = trajectories._states(name)
    assert states.shape == (5, SAMPLES_PER_TRAJECTORY, 2, 3)
    q, qd, qdd = np.moveaxis(states, -1, 0)
    late = slice(30, -2)  # away from the jump at the start, where differences fail
    for lower, upper in ((q, qd), (qd, qdd)):
        slope = np.gradient(lower, 0.01, axis=1)
        miss = np.sqrt(np.mean((slope - upper)[:, late] ** 2))
        assert miss < 0.1 * np.sqrt(np.mean(upper[:, late] ** 2))


def test_the_chance_of_extents_on_a_limit():
    """Five or more of twelve within half a printed step of a limit, summed by hand."""
    on_limit = sum(x in (0.0, 45.0) for pair in APPENDIX_I_EXTENTS_DEG for x in pair)
    p = 0.1 / 45
    chance = sum(comb(12, k) * p**k * (1 - p) ** (12 - k) for k in range(on_limit, 13))
    found = trajectories.random_draws()
    assert on_limit == 5
    assert found.value == pytest.approx(chance, rel=1e-6)
    # a coarser print makes it likelier
    assert trajectories.random_draws(resolution=9.0).value > 1e4 * found.value


def test_windows_within_the_motions_are_fewer():
    counts = [5 * (SAMPLES_PER_TRAJECTORY - w + 1) for w in (11, 21, 41)]
    assert all(f"{count:,}" in trajectories.cases().text for count in counts)
