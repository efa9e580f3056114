"""Whether two sets of states lie in the same parts of their space: distances, shared cells."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ddlib._check import integer, shaped
from ddlib.analysis.coverage import cells_reached


def nearest_distances(points, among) -> np.ndarray:
    """Distance of each point to the nearest one of another set, both ``(n, dimensions)``."""
    points = shaped("points", points, "(n, dimensions)")
    among = shaped("among", among, f"(n, {points.shape[1]})")
    for name, x in (("points", points), ("among", among)):
        integer(f"number of {name}", len(x), 1)
    return cKDTree(among).query(points)[0]


def shared_cells(points, among, cells: int) -> float:
    """Of the cells of the cube from -1 to 1 that `points` reach, the share that `among` reach."""
    points = shaped("points", points, "(n, dimensions)")
    among = shaped("among", among, f"(n, {points.shape[1]})")
    for name, x in (("points", points), ("among", among)):
        if not len(x) or np.abs(x).max() > 1:
            raise ValueError(f"{name} must hold points within -1 to 1, got {len(x)} of them")
    mine, others, either = (
        cells_reached(x, 1.0, cells) for x in (points, among, np.concatenate([points, among]))
    )
    return (mine + others - either) / mine
