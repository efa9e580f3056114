"""Baked values: a function on a grid of parameters, quantised, and interpolation in it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from ddlib.widgets.parts import Choice, Parameter

LEVELS = 65534
"""Steps of a 16-bit number between the smallest and the largest value of a curve."""


@dataclass(frozen=True)
class Baked:
    """A table of curves over the parameters' grid.

    A *row* holds all curves of one grid point one after the other.

    Attributes
    ----------
    data : ndarray of int16, shape (points, row)
        The last parameter varies fastest.
    scale, offset : ndarray, shape (row,)
        ``value = data * scale + offset``, equal for all samples of a curve.
    """

    parameters: tuple[Parameter | Choice, ...]
    data: np.ndarray
    scale: np.ndarray
    offset: np.ndarray

    @classmethod
    def quantise(cls, parameters, table, slices) -> "Baked":
        """Table of floats, shape ``(points, row)``, with one scale for every slice of a row."""
        scale, offset = np.empty(table.shape[1]), np.empty(table.shape[1])
        for part in slices:
            low, high = table[:, part].min(), table[:, part].max()
            scale[part], offset[part] = (high - low) / LEVELS, (high + low) / 2
        steps = np.divide(table - offset, scale, out=np.zeros_like(table), where=scale > 0)
        return cls(tuple(parameters), np.round(steps).astype("<i2"), scale, offset)

    @property
    def table(self) -> np.ndarray:
        """The values at the grid points, shape ``(points, row)``."""
        return self.data * self.scale + self.offset

    @property
    def range(self) -> np.ndarray:
        """Largest minus smallest value of the curve that a sample belongs to, shape (row,)."""
        return self.scale * LEVELS

    def row(self, values: dict) -> np.ndarray:
        """Interpolated row at the parameter `values`, shape (row,). `curves.js` does the same."""
        indices, weights = np.zeros(1, dtype=int), np.ones(1)
        for parameter in self.parameters:
            first, w = parameter.stencil(values[parameter.name])
            along = first + np.arange(len(w))
            indices = (indices[:, None] * parameter.grid + along).ravel()
            weights = (weights[:, None] * w).ravel()
        return weights @ self.data[indices].astype(float) * self.scale + self.offset


def grid_points(parameters) -> dict[str, list]:
    """Values of every parameter at every point of the grid, the last varying fastest."""
    points = list(itertools.product(*(parameter.nodes for parameter in parameters)))
    return {p.name: [point[i] for point in points] for i, p in enumerate(parameters)}
