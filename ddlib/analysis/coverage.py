"""How much of a space a set of samples reaches: cells, bounds, effective dimensions."""

from __future__ import annotations

import numpy as np

from ddlib._check import integer, number, shaped


def cells_reached(samples, radius: float, cells: int) -> int:
    """Number of cells of a hypercube that hold at least one sample.

    Parameters
    ----------
    samples : array_like, shape (n, dimensions)
        Points; those outside the cube count for no cell.
    radius : float
        Half the edge of the cube, which is centred at zero.
    cells : int
        Cells along each axis.
    """
    samples = shaped("samples", samples, "(n, dimensions)")
    number("radius", radius, 0.0, open_low=True)
    integer("cells", cells, 1)
    inside = samples[(np.abs(samples) <= radius).all(-1)]
    places = np.minimum((inside / radius + 1) / 2 * cells, cells - 1).astype(int)
    return len(np.unique(places, axis=0))


def log10_reachable_share(width: int, step: float) -> float:
    """Upper bound on the share of windows in a cube whose neighbours differ by at most `step`.

    The first sample is free; each further one lies within `step` of its neighbour, an interval
    of length ``2 step`` at most.

    Parameters
    ----------
    width : int
        Samples of the window.
    step : float
        Largest difference between neighbours, as a share of the cube's edge.

    Returns
    -------
    float
        Decimal logarithm of the bound.
    """
    integer("width", width, 1)
    number("step", step, 0.0, 0.5, open_low=True)
    return (width - 1) * float(np.log10(2 * step))


def used_dimensions(samples, resolution: float) -> int:
    """Number of orthogonal directions in which samples vary by more than a resolution.

    Parameters
    ----------
    samples : array_like, shape (n, dimensions)
        Points.
    resolution : float
        Smallest standard deviation that counts, in the unit of the samples.
    """
    number("resolution", resolution, 0.0)
    return int((principal_deviations(samples) > resolution).sum())


def principal_deviations(samples) -> np.ndarray:
    """Standard deviations along the principal directions of samples, largest first.

    Parameters
    ----------
    samples : array_like, shape (n, dimensions)
        Points, two or more.
    """
    samples = shaped("samples", samples, "(n, dimensions)")
    integer("samples", len(samples), 2)
    values = np.linalg.svd(samples - samples.mean(0), compute_uv=False)
    return values / np.sqrt(len(samples))
