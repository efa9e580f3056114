"""How much of a space samples reach, and whether two sets of them reach the same parts."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull

from ddlib._check import finite_array, integer, number, shaped
from ddlib.trajectories import APPENDIX_I


def cells_reached(samples, radius: float, cells: int) -> int:
    """Number of cells that hold a sample, in a hypercube from -radius to radius.

    There are `cells` along each axis; samples ``(n, dimensions)`` outside count for none.
    """
    samples = shaped("samples", samples, "(n, dimensions)")
    number("radius", radius, 0.0, open_low=True)
    integer("cells", cells, 1)
    inside = samples[(np.abs(samples) <= radius).all(-1)]
    places = np.minimum((inside / radius + 1) / 2 * cells, cells - 1).astype(int)
    return len(np.unique(places, axis=0))


def log10_reachable_share(width: int, step: float) -> float:
    """Upper bound on the share of windows in a cube whose neighbours differ by at most `step`.

    Each of `width` samples but the first lies in an interval of ``2 step``, a share of the edge.
    """
    integer("width", width, 1)
    number("step", step, 0.0, 0.5, open_low=True)
    return (width - 1) * float(np.log10(2 * step))


def used_dimensions(samples, resolution: float) -> int:
    """Number of orthogonal directions in which samples deviate by more than a resolution."""
    number("resolution", resolution, 0.0)
    return int((principal_deviations(samples) > resolution).sum())


def principal_deviations(samples) -> np.ndarray:
    """Standard deviations along the principal directions of samples, largest first."""
    samples = shaped("samples", samples, "(n, dimensions)")
    integer("samples", len(samples), 2)
    values = np.linalg.svd(samples - samples.mean(0), compute_uv=False)
    return values / np.sqrt(len(samples))


_HULL = ConvexHull(APPENDIX_I[:5])  # of the extents of the training trajectories


def inside_hull(extents_deg) -> np.ndarray:
    """Whether extents (degrees, shape (..., 2)) lie in the hull of the training trajectories."""
    extents_deg = finite_array("extents_deg", extents_deg, 2)
    distances = extents_deg @ _HULL.equations[:, :2].T + _HULL.equations[:, 2]
    return (distances <= 1e-9).all(-1)
