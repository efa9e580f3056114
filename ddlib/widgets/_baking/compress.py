"""The coefficients of splines as int16, where possible as a product of two narrow tables."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from ddlib.widgets.parts.parameters import Choice, Parameter

_STEPS = {2: 32_767, 1: 127}  # largest integer of two bytes, and of one: numbers are scaled to it
_FAINT = 10  # components that never reach so many tolerances are stored in one byte a number
_TINY = 1e-12  # keeps divisions by a size finite where all is zero
_SHARE = 0.3  # of the tolerance that leaving components out may cost


class _Table:
    """Curves on a grid (`values`: points, ..., samples; within 1), as a spline's coefficients.

    The coefficients are a matrix with a row per grid point and a column per sample. Where
    that is smaller, it is stored as a product of two narrow ones (its largest singular
    components): the spline then runs through a few numbers, which mix a few `shapes`.

    A unit of `table` times a unit of `shapes` is worth `scale`; the first `wide` columns of
    `table` and rows of `shapes` need two bytes a number, the others are faint and fit into one.
    """

    def __init__(
        self,
        parameters: Sequence[Parameter | Choice],
        values: np.ndarray,
        lengths: Sequence[int],
        tolerance: float,
    ):
        self.parameters = tuple(parameters)
        samples = values.shape[-1]
        coefficients = _each_axis([p.coefficients() for p in parameters], values)
        size, rows = coefficients.shape[:-1], coefficients.reshape(-1, samples)
        weight = np.repeat(1 / np.sqrt(lengths), lengths)  # a number counts as much as a curve
        left, shapes = _components(rows * weight)
        shapes = shapes / weight
        rank = _least_rank(left, shapes, _SHARE * tolerance)
        if rank:
            table, shapes = left[:, :rank], shapes[:rank]
            most = np.abs(table).max(0) + _TINY, np.abs(shapes).max(1) + _TINY
            strong = most[0] * most[1] / 2 > _FAINT * tolerance
            self.wide = int(np.flatnonzero(strong).max(initial=-1)) + 1
            steps = np.where(np.arange(rank) < self.wide, _STEPS[2], _STEPS[1])
            self.scale = most[0] * most[1] / steps**2
            table, shapes = steps * table / most[0], (steps / most[1])[:, None] * shapes
        else:
            self.wide = samples
            self.scale = np.array([np.abs(rows).max() / _STEPS[2] or 1.0])
            table, shapes = rows / self.scale, np.empty((0, samples))
        self.table = np.rint(table).astype("<i2").reshape(*size, -1)
        self.shapes = np.rint(shapes).astype("<i2")

    @property
    def rank(self) -> int:
        """Number of shapes; 0 if the coefficients are the curves' own."""
        return len(self.shapes)

    def tobytes(self) -> bytes:
        """`table`, then `shapes`: of each first what needs two bytes a number, then the rest."""
        table, shapes, wide = self.table, self.shapes, self.wide
        parts = [table[..., :wide], table[..., wide:].astype("i1")]
        parts += [shapes[:wide], shapes[wide:].astype("i1")]
        return b"".join(part.tobytes() for part in parts)

    def interpolate(self, values: Mapping) -> np.ndarray:
        """The scaled curves at one value per parameter, shape ``(samples,)``."""
        per_axis = [p.weights(values[p.name]) for p in self.parameters]
        total = np.zeros(self.table.shape[-1])
        for corner in itertools.product(*per_axis):
            index = tuple(i for i, _ in corner)
            total += np.prod([w for _, w in corner]) * self.table[index]
        return (self.scale * total) @ self.shapes if self.rank else self.scale * total


def _each_axis(matrices, values) -> np.ndarray:
    """`values` with the k-th matrix applied along the k-th axis."""
    for axis, matrix in enumerate(matrices):
        values = np.moveaxis(np.tensordot(matrix, values, (1, axis)), 0, axis)
    return values


def _components(rows) -> tuple[np.ndarray, np.ndarray]:
    """Two matrices whose product is `rows`, largest singular components first."""
    tall = rows.shape[0] > rows.shape[1]
    # an eigenproblem of the smaller side is quicker than a singular value decomposition
    sizes, vectors = np.linalg.eigh(rows.T @ rows if tall else rows @ rows.T)
    vectors = vectors[:, ::-1][:, : max(1, int((sizes > 1e-14 * sizes[-1]).sum()))]
    return (rows @ vectors, vectors.T) if tall else (vectors, vectors.T @ rows)


def _least_rank(left, shapes, allowed: float) -> int:
    """How many components to keep; 0 if that saves nothing.

    A spline's values lie between its coefficients, so that it is off by no more than they are.
    """
    points, samples = len(left), shapes.shape[1]
    exact = left @ shapes
    ranks = range(1, int(0.9 * points * samples / (points + samples)) + 1)[: len(shapes)]

    def fits(rank):
        return np.abs(left[:, :rank] @ shapes[:rank] - exact).max() / 2 <= allowed

    place = bisect.bisect_left(ranks, True, key=fits)
    return ranks[place] if place < len(ranks) else 0
