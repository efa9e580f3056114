"""The curves of a function of a few parameters, called one setting at a time or many."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ddlib._check import finite_array

BLOCK = 1024
"""Most settings that a vectorised function gets at once."""

AGREEMENT = 1e-3
"""How far a vectorised function may differ from the plain one, relative to a curve's range:
sums in another order can move a quantised sensor by one step."""


def evaluate(function: Callable, values: Mapping) -> dict[str, np.ndarray]:
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


class Sampled:
    """A function whose curves come as rows, one row per setting.

    Parameters
    ----------
    function : callable
        Called with one keyword per parameter; returns a dict of curves and numbers.
    many : callable or None
        The function for many settings at once: called with one array of equal length n
        per parameter, returns arrays of shape ``(n, samples)`` or ``(n,)``.
    first : mapping
        A setting, at which the function is called to learn what it returns.

    Attributes
    ----------
    lengths : dict
        Samples of each curve.
    """

    def __init__(self, function: Callable, many: Callable | None, first: Mapping):
        self.function, self.many = function, many
        self._agrees = False
        self.lengths = {name: c.size for name, c in evaluate(function, first).items()}

    @property
    def samples(self) -> int:
        """Length of a row: samples of all curves."""
        return sum(self.lengths.values())

    def split(self, rows) -> dict[str, np.ndarray]:
        """Rows ``(..., samples)`` cut into curves by name."""
        ends = np.cumsum(list(self.lengths.values()))[:-1]
        return dict(zip(self.lengths, np.split(rows, ends, axis=-1)))

    def spread(self, values) -> np.ndarray:
        """One value per curve repeated over its samples, shape ``(samples,)``."""
        return np.repeat(values, list(self.lengths.values()))

    def row(self, setting: Mapping) -> np.ndarray:
        """The function's curves at a setting, one after the other."""
        curves = evaluate(self.function, setting)
        lengths = {name: curve.size for name, curve in curves.items()}
        if lengths != self.lengths:
            raise ValueError(
                f"function must return the same curves everywhere, got {lengths} "
                f"in place of {self.lengths}"
            )
        return np.concatenate([curves[name] for name in self.lengths])

    def rows(self, settings: Sequence[Mapping]) -> np.ndarray:
        """The curves at many settings, shape ``(settings, samples)``.

        Raises
        ------
        ValueError
            If `many` does not return what `function` returns, as seen at a few of the first
            settings.
        """
        if self.many is None:
            return np.array([self.row(setting) for setting in settings])
        blocks = [settings[k : k + BLOCK] for k in range(0, len(settings), BLOCK)]
        rows = np.concatenate([self._block(block) for block in blocks])
        if not self._agrees:
            self._compare(settings, rows)
        return rows

    def _compare(self, settings, rows):
        parts = self.split(rows)
        width = self.spread([max(np.ptp(x), 1e-9 * np.abs(x).max(), 1e-12) for x in parts.values()])
        for k in sorted({0, len(settings) // 3, len(settings) - 1}):
            off = self.split(np.abs(rows[k] - self.row(settings[k])) / width)
            worst = max(off, key=lambda name: off[name].max())
            if off[worst].max() > AGREEMENT:
                raise ValueError(
                    f"many must return what function returns, got {worst} off by "
                    f"{off[worst].max():.2g} of its range at {dict(settings[k])}"
                )
        self._agrees = True

    def _block(self, settings: Sequence[Mapping]) -> np.ndarray:
        n = len(settings)
        result = self.many(**{name: _array([s[name] for s in settings]) for name in settings[0]})
        if not isinstance(result, Mapping) or set(result) != set(self.lengths):
            got = list(result) if isinstance(result, Mapping) else result
            raise ValueError(f"many must return curves named {list(self.lengths)}, got {got!r}")
        parts = []
        for name, length in self.lengths.items():
            part = finite_array(name, result[name])
            if part.shape != (n, length) and not (length == 1 and part.shape == (n,)):
                raise ValueError(f"{name} of many must have shape {(n, length)}, got {part.shape}")
            parts.append(part.reshape(n, length))
        return np.concatenate(parts, axis=1)


def _array(values: list) -> np.ndarray:
    """One array of plain values; of objects where their types differ."""
    return np.array(values, dtype=object if len({type(v) for v in values}) > 1 else None)
