"""How much of a space samples reach: counts by hand, volumes by chance, ranks by construction."""

import numpy as np
import pytest

from ddlib.analysis import (
    cells_reached,
    inside_hull,
    log10_reachable_share,
    principal_deviations,
    used_dimensions,
)
from ddlib.trajectories import APPENDIX_I


def test_cells_are_counted_once_and_only_inside():
    samples = [[-0.9, -0.9], [-0.8, -0.6], [0.1, 0.1], [1.0, 1.0], [-1.0, 1.0], [1.1, 0.0]]
    # four cells an axis: two share a corner, one lies out, the upper faces belong to the cube
    assert cells_reached(samples, 1.0, 4) == 4
    assert cells_reached(samples, 1.0, 1) == 1
    assert cells_reached(np.zeros((0, 3)), 1.0, 4) == 0


@pytest.mark.parametrize("width, step", [(2, 0.1), (3, 0.2), (4, 0.3)])
def test_the_bound_holds_for_random_windows_and_is_not_far_off(width, step):
    windows = np.random.default_rng(1).uniform(0, 1, (400_000, width))
    share = (np.abs(np.diff(windows)) <= step).all(-1).mean()
    bound = 10 ** log10_reachable_share(width, step)
    assert 0.4 * bound < share < bound


def test_deviations_are_those_of_a_known_distribution():
    rng = np.random.default_rng(2)
    turn = np.linalg.qr(rng.normal(size=(5, 5)))[0]
    samples = rng.normal(size=(200_000, 5)) * [3, 2, 1, 0.1, 0] @ turn.T + 7
    np.testing.assert_allclose(principal_deviations(samples), [3, 2, 1, 0.1, 0], atol=0.02)
    assert [used_dimensions(samples, x) for x in (0.05, 0.5, 2.5, 10)] == [4, 3, 1, 0]


def test_the_hull_of_the_training_trajectories():
    assert inside_hull(APPENDIX_I[:5]).all()
    assert not inside_hull(APPENDIX_I[5])
    assert inside_hull(APPENDIX_I[:5].mean(0))
    assert not inside_hull([0.0, 0.0])
