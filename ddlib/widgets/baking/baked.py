"""Curves that depend on a few parameters, evaluated on a grid and interpolated.

`baked.js` reads the same numbers and interpolates in the same way; a test compares the two.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Mapping, Sequence

import numpy as np

from ddlib._check import integer, one_of
from ddlib.widgets.baking.compress import TINY, Table
from ddlib.widgets.baking.sampled import Sampled

MAX_BYTES = 400_000
"""Largest size of the baked values of one widget."""

MAX_VALUES = 6_000_000
"""Most values, settings times samples, that are computed to be baked."""


class Baked:
    """Curves on grids of parameters, as small integers.

    Parameters
    ----------
    function : callable
        Called with one keyword per parameter; returns a dict of curves and numbers.
    parameters : sequence of Parameter or Choice
        The axes of the grid.
    cubic : bool
        Interpolate with cubic splines (smooth functions) or linearly.
    many : callable, optional
        The function for many settings at once, as in `Sampled`.
    tolerance : float
        Acceptable deviation relative to the range of each curve; a part of it may go into
        making tables small.
    depends : mapping, optional
        Curve -> names of the only parameters that it depends on; default: all. Curves of
        the same parameters have their own table, over those parameters alone.

    Attributes
    ----------
    lengths : dict
        Samples of each curve.
    low, high : ndarray, shape (curves,)
        Range of each curve over the grid.
    tables : list of ddlib.widgets.baking.compress.Table
        One per set of parameters; see `groups`.

    Raises
    ------
    TypeError, ValueError
        If the function's results are unfit, or the grid needs more than `MAX_BYTES`.
    """

    def __init__(self, function, parameters, cubic=True, many=None, tolerance=0.01, depends=None):
        self.parameters, self.cubic = tuple(parameters), bool(cubic)
        start = {p.name: p.value for p in self.parameters}
        self._sampled = Sampled(function, many, start)
        self.lengths = self._sampled.lengths
        self._groups = self._grouped(depends or {})
        grids = [self._settings(names, start) for names in self._groups]
        if (count := sum(map(len, grids)) * self._sampled.samples) > MAX_VALUES:
            raise ValueError(
                f"grid must give at most {MAX_VALUES} values, got {count}: "
                "take fewer grid points or fewer samples"
            )
        self.low = np.empty(len(self.lengths))
        self.high = np.empty(len(self.lengths))
        rows = [self._sampled.rows(settings) for settings in grids]
        for group, curves in zip(rows, self._groups.values()):
            for name, values in self._sampled.split(group).items():
                if name in curves:
                    k = list(self.lengths).index(name)
                    self.low[k], self.high[k] = values.min(), values.max()
        self._middle = self._sampled.spread((self.low + self.high) / 2)
        self._half = self._sampled.spread((self.high - self.low) / 2)
        self.tables = [
            self._table(names, group, tolerance) for names, group in zip(self._groups, rows)
        ]
        if (size := len(self.tobytes())) > MAX_BYTES:
            raise ValueError(
                f"grid must give at most {MAX_BYTES} baked bytes, got {size}: "
                "take fewer grid points or fewer samples"
            )

    def _grouped(self, depends: Mapping[str, Sequence[str]]) -> dict[tuple, list[str]]:
        """Curves by the parameters that they depend on."""
        for name, needed in depends.items():
            one_of("curve of depends", name, tuple(self.lengths))
            for parameter in needed:
                one_of(f"parameter of {name} in depends", parameter, tuple(self.names))
        groups = {}
        for name in self.lengths:
            needed = depends.get(name, self.names)
            groups.setdefault(tuple(n for n in self.names if n in needed), []).append(name)
        return groups

    def _settings(self, names, start) -> list[dict]:
        points = [p.points() for p in self.parameters if p.name in names]
        return [{**start, **dict(zip(names, values))} for values in itertools.product(*points)]

    def _table(self, names, rows, tolerance) -> Table:
        columns = self._columns(names)
        half = self._half[columns]
        values = (rows[:, columns] - self._middle[columns]) / np.where(half > 0, half, 1)
        axes = [p for p in self.parameters if p.name in names]
        lengths = [self.lengths[name] for name in self._groups[names]]
        values = values.reshape(*(p.grid for p in axes), -1)
        return Table(axes, values, lengths, self.cubic, tolerance)

    def _columns(self, names) -> np.ndarray:
        """Which samples of a row belong to the group of the parameters `names`."""
        return self._sampled.spread([name in self._groups[names] for name in self.lengths])

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [p.name for p in self.parameters]

    @property
    def groups(self) -> list[dict]:
        """What the page needs to know of each table: places of its parameters and curves."""
        curves = list(self.lengths)
        return [
            {
                "parameters": [self.names.index(name) for name in names],
                "curves": [curves.index(name) for name in group],
                "rank": table.rank,
                "wide": table.wide,
                "scale": table.scale.tolist(),
            }
            for (names, group), table in zip(self._groups.items(), self.tables)
        ]

    def tobytes(self) -> bytes:
        """All tables, one after the other."""
        return b"".join(table.tobytes() for table in self.tables)

    def checksum(self) -> int:
        """CRC-32 of `tobytes`."""
        return zlib.crc32(self.tobytes())

    def interpolate(self, **values) -> dict[str, np.ndarray]:
        """The curves at any parameters within the ranges, from the grid alone."""
        if set(values) != set(self.names):
            raise TypeError(
                f"values must name {', '.join(self.names)}, got {', '.join(values) or 'none'}"
            )
        return self._sampled.split(self._interpolated(values))

    def _interpolated(self, values) -> np.ndarray:
        scaled = np.empty(self._sampled.samples)
        for names, table in zip(self._groups, self.tables):
            scaled[self._columns(names)] = table.interpolate(values)
        return self._middle + self._half * scaled

    def error(self, n=200, seed=0) -> float:
        """Largest deviation from the function at `n` random settings.

        For each curve relative to its range over the grid (a constant curve: to its value).
        """
        integer("n", n, 1)
        fractions = np.random.default_rng(seed).uniform(size=(n, len(self.parameters)))
        settings = [{p.name: p.place(f) for p, f in zip(self.parameters, row)} for row in fractions]
        width = np.where(self._half > 0, 2 * self._half, np.abs(self._middle) + TINY)
        return max(
            float((np.abs(self._interpolated(values) - row) / width).max())
            for values, row in zip(settings, self._sampled.rows(settings))
        )
