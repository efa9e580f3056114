"""Curves that depend on a few parameters, evaluated on a grid and interpolated.

`curves.js` reads the same numbers and interpolates in the same way; a test compares the two.
"""

from __future__ import annotations

import itertools
import keyword
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, integer, number, one_of

MAX_BYTES = 400_000
"""Largest size of the baked values of one widget."""

STEPS = 65_534
"""Quantisation steps over the range of a curve: int16 from -32767 to 32767."""


@dataclass(frozen=True)
class Parameter:
    """A quantity that the reader can change.

    Parameters
    ----------
    name : str
        Keyword of the function, and name of the widget's trait.
    label : str
        What the page calls it.
    low, high : float
        Range, in `unit`.
    value : float
        Where it starts.
    unit : str
        Shown after the value.
    grid : int
        Number of baked points, 2 or more.
    scale : {"linear", "log"}
        Spacing of the baked points and of the slider.
    """

    name: str
    label: str
    low: float
    high: float
    value: float
    unit: str = ""
    grid: int = 7
    scale: str = "linear"

    def __post_init__(self):
        name = self.name
        if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
            raise ValueError(f"name must be a Python identifier, got {name!r}")
        number(f"low of {name}", self.low)
        number(f"high of {name}", self.high, self.low, open_low=True)
        self.check(self.value)
        integer(f"grid of {name}", self.grid, 2)
        one_of(f"scale of {name}", self.scale, ("linear", "log"))
        if self.scale == "log":
            number(f"low of {name}", self.low, 0.0, open_low=True)

    def check(self, value) -> float:
        """`value` as a float; an error that names parameter, value and range otherwise."""
        return number(self.name, value, self.low, self.high)

    def points(self) -> np.ndarray:
        """The baked points, shape ``(grid,)``."""
        space = np.geomspace if self.scale == "log" else np.linspace
        return space(self.low, self.high, self.grid)

    def place(self, fraction):
        """The value at a `fraction` (0 to 1) of the range, as the slider divides it."""
        if self.scale == "log":
            return self.low * (self.high / self.low) ** fraction
        return self.low + (self.high - self.low) * fraction

    def weights(self, value, cubic=True) -> list[tuple[int, float]]:
        """Baked points and their weights that interpolate at `value`.

        With ``cubic`` four of them (Catmull-Rom; beyond the ends the parabola through the
        last three points goes on), otherwise two.
        """
        x = self.check(value)
        if self.scale == "log":
            position = np.log(x / self.low) / np.log(self.high / self.low)
        else:
            position = (x - self.low) / (self.high - self.low)
        position *= self.grid - 1
        i = min(max(int(position), 0), self.grid - 2)
        f = position - i
        if not cubic or self.grid == 2:
            return [(i, 1 - f), (i + 1, f)]
        w = [
            ((2 - f) * f - 1) * f / 2,
            ((3 * f - 5) * f * f + 2) / 2,
            ((4 - 3 * f) * f + 1) * f / 2,
            (f - 1) * f * f / 2,
        ]
        if i == 0:
            return [(0, w[1] + 3 * w[0]), (1, w[2] - 3 * w[0]), (2, w[3] + w[0])]
        if i == self.grid - 2:
            return [(i - 1, w[0] + w[3]), (i, w[1] - 3 * w[3]), (i + 1, w[2] + 3 * w[3])]
        return list(zip(range(i - 1, i + 3), w))


def evaluate(function: Callable, values: Mapping[str, float]) -> dict[str, np.ndarray]:
    """The function's curves and scalars as finite 1-D arrays, otherwise an error.

    Parameters
    ----------
    function : callable
        Called with the values as keywords; returns a dict of arrays and numbers.
    values : mapping
        One value per parameter.
    """
    result = function(**values)
    if not isinstance(result, Mapping) or not result:
        raise TypeError(f"function must return a dict of curves, got {result!r}")
    curves = {name: np.atleast_1d(finite_array(name, x)) for name, x in result.items()}
    for name, curve in curves.items():
        if curve.ndim != 1 or not curve.size:
            raise ValueError(f"{name} must be one number or one-dimensional, got {curve.shape}")
    return curves


class Baked:
    """Curves on a grid of parameters, as int16.

    Parameters
    ----------
    function : callable
        Called with one keyword per parameter; returns a dict of curves and numbers.
    parameters : sequence of Parameter
        The axes of the grid.
    cubic : bool
        Interpolate with cubic polynomials (smooth functions) or linearly.

    Attributes
    ----------
    lengths : dict
        Samples of each curve.
    low, high : ndarray, shape (curves,)
        Range of each curve over the grid.
    table : ndarray of int16, shape (points, ..., samples)
        All curves one after the other.
    """

    def __init__(self, function, parameters, cubic=True):
        self.function, self.parameters, self.cubic = function, tuple(parameters), bool(cubic)
        points = [p.points() for p in self.parameters]
        rows = []
        for values in itertools.product(*points):
            curves = evaluate(function, dict(zip(self.names, map(float, values))))
            lengths = {name: curve.size for name, curve in curves.items()}
            if not rows:
                self.lengths = lengths
                size = 2 * sum(lengths.values()) * int(np.prod([len(p) for p in points]))
                if size > MAX_BYTES:
                    raise ValueError(
                        f"grid must give at most {MAX_BYTES} baked bytes, got {size}: "
                        "take fewer grid points or fewer samples"
                    )
            elif lengths != self.lengths:
                raise ValueError(
                    f"function must return the same curves everywhere, got {lengths} "
                    f"in place of {self.lengths}"
                )
            rows.append(np.concatenate(list(curves.values())))
        rows = np.array(rows)
        parts = self._split(rows)
        self.low = np.array([x.min() for x in parts.values()])
        self.high = np.array([x.max() for x in parts.values()])
        counts = list(self.lengths.values())
        self._middle = np.repeat((self.low + self.high) / 2, counts)
        self._step = np.repeat((self.high - self.low) / STEPS, counts)
        ints = np.rint((rows - self._middle) / np.where(self._step > 0, self._step, 1))
        self.table = ints.astype("<i2").reshape(*map(len, points), -1)

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [p.name for p in self.parameters]

    def _split(self, rows) -> dict[str, np.ndarray]:
        ends = np.cumsum(list(self.lengths.values()))[:-1]
        return dict(zip(self.lengths, np.split(rows, ends, axis=-1)))

    def tobytes(self) -> bytes:
        """The table as little-endian int16, the last axis fastest."""
        return self.table.tobytes()

    def checksum(self) -> int:
        """CRC-32 of `tobytes`."""
        return zlib.crc32(self.tobytes())

    def interpolate(self, **values) -> dict[str, np.ndarray]:
        """The curves at any parameters within the ranges, from the grid alone."""
        if set(values) != set(self.names):
            raise TypeError(
                f"values must name {', '.join(self.names)}, got {', '.join(values) or 'none'}"
            )
        per_axis = [p.weights(values[p.name], self.cubic) for p in self.parameters]
        total = np.zeros(self.table.shape[-1])
        for corner in itertools.product(*per_axis):
            index = tuple(i for i, _ in corner)
            total += np.prod([w for _, w in corner]) * self.table[index]
        return self._split(self._middle + self._step * total)

    def error(self, n=200, seed=0) -> float:
        """Largest deviation from the function at `n` random parameters.

        For each curve relative to its range over the grid (a constant curve: to its value).
        """
        integer("n", n, 1)
        rng = np.random.default_rng(seed)
        width = self.high - self.low
        width = np.where(width > 0, width, np.maximum(np.abs(self.high), 1e-12))
        worst = 0.0
        for fractions in rng.uniform(size=(n, len(self.parameters))):
            values = {p.name: float(p.place(f)) for p, f in zip(self.parameters, fractions)}
            exact = evaluate(self.function, values)
            for w, (name, curve) in zip(width, self.interpolate(**values).items()):
                worst = max(worst, float(np.abs(curve - exact[name]).max() / w))
        return worst
