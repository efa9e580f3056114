"""Curves of a function at every setting of its parameters, as small integers.

`static/table.js` reads them. Nothing stands between two settings: the page snaps to the nearest.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array
from ddlib.widgets.parts.parameters import Choice, Parameter

_MAX_BYTES = 500_000  # of the table of one widget; it is plain, and whoever serves it packs it
_MAX_VALUES = 6_000_000  # settings times samples that are computed for it
_LAST = 2**16 - 1  # largest integer: the upper end of a curve's range


@dataclass(frozen=True)
class Live:
    """Says that the page's script computes curves: it sets ``live`` (static/curves.js).

    Parameters
    ----------
    curves : sequence of str, optional
        Which ones; default all, so that there is no table.
    examples : sequence of mappings
        Settings, each with the parameters that differ from the start. The ranges of the curves
        over them decide with how many decimals numbers are written.
    ranges : mapping, optional
        Curve -> its lowest and highest value, where they are known without examples.
    """

    curves: Sequence[str] | None = None
    examples: Sequence[Mapping] = ()
    ranges: Mapping = field(default_factory=dict)


class Curve(NamedTuple):
    """A curve of a widget: its range, and its samples at every setting if they are in the table."""

    name: str
    length: int
    low: float
    high: float
    steps: np.ndarray | None = None  #: parts of the range, (grid of each parameter or 1, samples)

    def description(self) -> dict:
        """What the page needs to know: `axes` are the parameters on which a curve depends."""
        shape = () if self.steps is None else self.steps.shape[:-1]
        axes = [axis for axis, points in enumerate(shape) if points > 1]
        return {
            **{"name": self.name, "length": self.length, "low": self.low, "high": self.high},
            "axes": None if self.steps is None else axes,
        }

    def at(self, places: Sequence[int]) -> np.ndarray:
        """The samples at a setting: places in the grids of all parameters."""
        at = tuple(k if points > 1 else 0 for k, points in zip(places, self.steps.shape))
        return self.low + self.steps[at] / _LAST * (self.high - self.low)


def evaluate(function: Callable, values: Mapping, unended: bool = False) -> dict[str, np.ndarray]:
    """The function's curves and numbers as 1-D arrays; finite, or `unended` ones may hold NaN."""
    result = function(**values)
    if not isinstance(result, Mapping) or not result:
        raise TypeError(f"function must return a dict of curves, got {result!r}")
    checked = np.asarray if unended else finite_array
    curves = {n: np.atleast_1d(x if unended else checked(n, x)) for n, x in result.items()}
    for name, curve in curves.items():
        if curve.ndim != 1 or not curve.size:
            raise ValueError(f"{name} must be one number or one-dimensional, got {curve.shape}")
    return curves


def tabled(function: Callable, parameters: Sequence[Parameter | Choice], computed=()) -> list:
    """The function's curves at every setting; of the `computed` ones the range alone."""
    start = evaluate(function, {p.name: p.value for p in parameters})
    lengths = {name: curve.size for name, curve in start.items()}
    grid = [p.grid for p in parameters]
    if (count := math.prod(grid) * sum(lengths.values())) > _MAX_VALUES:
        raise ValueError(
            f"grid must give at most {_MAX_VALUES} values, got {count}: "
            "take fewer grid points or fewer samples"
        )
    rows = []
    for values in itertools.product(*(p.points() for p in parameters)):
        row = evaluate(function, dict(zip((p.name for p in parameters), values)))
        if {name: curve.size for name, curve in row.items()} != lengths:
            raise ValueError(
                f"function must return the same curves everywhere, got {list(row)} in place of "
                f"{lengths}"
            )
        rows.append(row)
    curves = [
        _tabled(name, np.stack([row[name] for row in rows]).reshape(*grid, -1), name in computed)
        for name in lengths
    ]
    if (size := len(tobytes(curves))) > _MAX_BYTES:
        raise ValueError(
            f"grid must give at most {_MAX_BYTES} baked bytes, got {size}: "
            "take fewer grid points or fewer samples"
        )
    return curves


def _tabled(name: str, values: np.ndarray, computed: bool) -> Curve:
    low, high, length = float(values.min()), float(values.max()), values.shape[-1]
    if computed:
        return Curve(name, length, low, high)
    steps = np.rint((values - low) / ((high - low) or 1.0) * _LAST).astype("<u2")
    for axis in range(steps.ndim - 1):  # a parameter that changes nothing needs no place
        first = steps.take([0], axis)
        steps = first if (steps == first).all() else steps
    return Curve(name, length, low, high, steps)


def ranged(function: Callable, parameters: Sequence[Parameter | Choice], live: Live) -> list[Curve]:
    """Curves that the page computes: their lengths at the start, ranges from `live`."""
    start = {p.name: p.value for p in parameters}
    known = [
        evaluate(function, {**start, **setting}, unended=True) for setting in ({}, *live.examples)
    ]
    curves = []
    for name, first in known[0].items():
        ends = live.ranges.get(name) or [
            end([end(row[name]) for row in known]) for end in (np.nanmin, np.nanmax)
        ]
        curves.append(Curve(name, first.size, *map(float, ends)))
    return curves


def tobytes(curves: Sequence[Curve]) -> bytes:
    """The table: all samples of each curve, one curve after the other."""
    return b"".join(curve.steps.tobytes() for curve in curves if curve.steps is not None)
