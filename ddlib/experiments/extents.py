"""The whole square of extents: which trajectories lie in the hull of the training ones, and all."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from ddlib._check import finite_array, integer
from ddlib.experiments.setups import Setup
from ddlib.simulation import Recording
from ddlib.trajectories import APPENDIX_I, MAX_EXTENT_DEG

HULL = ConvexHull(APPENDIX_I[:5])
"""Of the extents of the training trajectories."""


def inside_hull(extents_deg) -> np.ndarray:
    """Whether extents lie in the hull of the training trajectories.

    Parameters
    ----------
    extents_deg : array_like, shape (..., 2)
        Extents of shoulder and elbow, degrees.

    Returns
    -------
    ndarray of bool, shape (...)
    """
    extents_deg = finite_array("extents_deg", extents_deg, 2)
    distances = extents_deg @ HULL.equations[:, :2].T + HULL.equations[:, 2]
    return (distances <= 1e-9).all(-1)


class Square(NamedTuple):
    """Recordings of a grid of trajectories.

    Attributes
    ----------
    extents_deg : ndarray, shape (runs, 2)
        Shoulder and elbow, degrees; the elbow's changes fastest.
    inside : ndarray of bool, shape (runs,)
        Whether they lie in the hull of the training trajectories.
    recording : Recording
        All runs.
    """

    extents_deg: np.ndarray
    inside: np.ndarray
    recording: Recording


def square(setup: Setup, points: int = 9) -> Square:
    """Record trajectories on a grid of extents, equally spaced, the largest 45 degrees.

    Parameters
    ----------
    setup : Setup
        Which arm, controller and sensors.
    points : int
        Extents of each joint, 2 or more; the smallest is ``45 / points`` degrees, so that each
        joint moves in all.
    """
    integer("points", points, 2)
    edge = MAX_EXTENT_DEG * np.arange(1, points + 1) / points
    extents = np.stack(np.meshgrid(edge, edge, indexing="ij"), -1).reshape(-1, 2)
    return Square(extents, inside_hull(extents), setup.record(extents))
