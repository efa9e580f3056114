"""Curves that depend on a few parameters, evaluated on a grid and interpolated.

`baked.js` reads the same numbers and interpolates in the same way; a test compares the two.
"""

from __future__ import annotations

import itertools
import zlib
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ddlib._check import finite_array, integer, one_of
from ddlib.widgets._baking.compress import _TINY, _Table

_MAX_BYTES = 400_000  # of the baked values of one widget
_MAX_VALUES = 6_000_000  # settings times samples that are computed to be baked


def evaluate(function: Callable, values: Mapping) -> dict[str, np.ndarray]:
    """The function's curves and numbers as finite 1-D arrays, otherwise an error."""
    result = function(**values)
    if not isinstance(result, Mapping) or not result:
        raise TypeError(f"function must return a dict of curves, got {result!r}")
    curves = {name: np.atleast_1d(finite_array(name, x)) for name, x in result.items()}
    for name, curve in curves.items():
        if curve.ndim != 1 or not curve.size:
            raise ValueError(f"{name} must be one number or one-dimensional, got {curve.shape}")
    return curves


class Baked:
    """Curves of a function on a grid of its parameters, as small integers.

    `depends` maps a curve to the only parameters that it depends on; curves of the same parameters
    have a table of their own, over those parameters alone. A part of the tolerance (relative to
    the range of each curve) may go into making tables small.
    """

    def __init__(self, function, parameters, tolerance=0.01, depends=None):
        self.parameters, self._function = tuple(parameters), function
        self.names = [p.name for p in self.parameters]
        start = {p.name: p.value for p in self.parameters}
        self.lengths = {name: curve.size for name, curve in evaluate(function, start).items()}
        self._samples = sum(self.lengths.values())
        self._groups = self._grouped(depends or {})
        grids = [self._settings(names, start) for names in self._groups]
        if (count := sum(map(len, grids)) * self._samples) > _MAX_VALUES:
            raise ValueError(
                f"grid must give at most {_MAX_VALUES} values, got {count}: "
                "take fewer grid points or fewer samples"
            )
        self.low = np.empty(len(self.lengths))  # range of each curve over the grid
        self.high = np.empty(len(self.lengths))
        rows = [self._rows(settings) for settings in grids]
        for group, curves in zip(rows, self._groups.values()):
            for k, (name, values) in enumerate(self._split(group).items()):
                if name in curves:
                    self.low[k], self.high[k] = values.min(), values.max()
        self._middle = self._spread((self.low + self.high) / 2)
        self._half = self._spread((self.high - self.low) / 2)
        self.tables = [
            self._table(names, group, tolerance) for names, group in zip(self._groups, rows)
        ]
        if (size := len(self.tobytes())) > _MAX_BYTES:
            raise ValueError(
                f"grid must give at most {_MAX_BYTES} baked bytes, got {size}: "
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

    def _rows(self, settings) -> np.ndarray:
        """The curves at many settings, one after the other, shape ``(settings, samples)``."""
        return np.array([self._row(setting) for setting in settings])

    def _row(self, setting: Mapping) -> np.ndarray:
        curves = evaluate(self._function, setting)
        lengths = {name: curve.size for name, curve in curves.items()}
        if lengths != self.lengths:
            raise ValueError(
                f"function must return the same curves everywhere, got {lengths} "
                f"in place of {self.lengths}"
            )
        return np.concatenate([curves[name] for name in self.lengths])

    def _split(self, rows) -> dict[str, np.ndarray]:
        """Rows ``(..., samples)`` cut into curves by name."""
        ends = np.cumsum(list(self.lengths.values()))[:-1]
        return dict(zip(self.lengths, np.split(rows, ends, axis=-1)))

    def _spread(self, values) -> np.ndarray:
        """One value per curve repeated over its samples."""
        return np.repeat(values, list(self.lengths.values()))

    def _table(self, names, rows, tolerance) -> _Table:
        columns = self._columns(names)
        half = self._half[columns]
        values = (rows[:, columns] - self._middle[columns]) / np.where(half > 0, half, 1)
        axes = [p for p in self.parameters if p.name in names]
        lengths = [self.lengths[name] for name in self._groups[names]]
        values = values.reshape(*(p.grid for p in axes), -1)
        return _Table(axes, values, lengths, tolerance)

    def _columns(self, names) -> np.ndarray:
        """Which samples of a row belong to the group of the parameters `names`."""
        return self._spread([name in self._groups[names] for name in self.lengths])

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
        return self._split(self._interpolated(values))

    def _interpolated(self, values) -> np.ndarray:
        scaled = np.empty(self._samples)
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
        width = np.where(self._half > 0, 2 * self._half, np.abs(self._middle) + _TINY)
        return max(
            float((np.abs(self._interpolated(values) - row) / width).max())
            for values, row in zip(settings, self._rows(settings))
        )
