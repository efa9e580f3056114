"""How much two families of motions share: distances of all pairs, cells counted by hand."""

import numpy as np
from hypothesis import given, strategies as st

from beyond.studies.loop.motions import _nearest_distances, _shared_cells

GRID = np.stack(np.meshgrid([-0.75, -0.25, 0.25, 0.75], [-0.5, 0.5]), -1).reshape(-1, 2)


@given(st.integers(1, 4), st.integers(0, 99))
def test_distances_are_those_of_all_pairs(dimensions, seed):
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(7, dimensions)), rng.normal(size=(5, dimensions))
    wanted = np.sqrt(((a[:, None] - b) ** 2).sum(-1)).min(1)
    np.testing.assert_allclose(_nearest_distances(a, b), wanted)


def test_shares_are_counted_in_cells_of_the_first():
    assert _shared_cells(GRID, GRID[::-1], 4) == 1.0
    right = GRID[GRID[:, 0] > 0]
    assert _shared_cells(GRID, right, 4) == 0.5  # half of all cells
    assert _shared_cells(right, GRID, 4) == 1.0  # the other way round
    assert _shared_cells(GRID, -right, 4) == 0.5
    assert _shared_cells(right, -right, 4) == 0.0
    assert _shared_cells(right, -right, 1) == 1.0  # one cell holds all
    assert _shared_cells(np.repeat(right, 9, 0), right[:1], 4) == 0.25  # points do not count
