"""Overlap of sets of states, on sets that are laid out by hand."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from ddlib.analysis.overlap import nearest_distances, shared_cells

GRID = np.stack(np.meshgrid([-0.75, -0.25, 0.25, 0.75], [-0.5, 0.5]), -1).reshape(-1, 2)


def test_distances_are_to_the_nearest():
    found = nearest_distances([[0.0, 0.0], [3.0, 4.0], [0.0, 1.0]], [[0.0, 0.0], [0.0, 3.0]])
    np.testing.assert_allclose(found, [0.0, np.sqrt(10.0), 1.0])


@given(st.integers(1, 4), st.integers(0, 99))
def test_distances_are_those_of_all_pairs(dimensions, seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(7, dimensions)), rng.normal(size=(5, dimensions))
    wanted = np.sqrt(((a[:, None] - b) ** 2).sum(-1)).min(1)
    np.testing.assert_allclose(nearest_distances(a, b), wanted)


def test_shares_are_counted_in_cells_of_the_first():
    assert shared_cells(GRID, GRID[::-1], 4) == 1.0
    right = GRID[GRID[:, 0] > 0]
    assert shared_cells(GRID, right, 4) == 0.5  # half of all cells
    assert shared_cells(right, GRID, 4) == 1.0  # the other way round
    assert shared_cells(GRID, -right, 4) == 0.5
    assert shared_cells(right, -right, 4) == 0.0
    assert shared_cells(right, -right, 1) == 1.0  # one cell holds all
    assert shared_cells(np.repeat(right, 9, 0), right[:1], 4) == 0.25  # points do not count


def test_what_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="points must hold points within -1 to 1"):
        shared_cells(2 * GRID, GRID, 4)
    with pytest.raises(ValueError, match="among must hold"):
        shared_cells(GRID, GRID[:0], 4)
    with pytest.raises(ValueError, match="among must have shape"):
        nearest_distances(GRID, [[0.0]])
    with pytest.raises(ValueError, match="number of points"):
        nearest_distances(GRID[:0], GRID)
