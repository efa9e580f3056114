"""What a reader can change: quantities in a range, and choices among a few."""

from __future__ import annotations

import keyword
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

import numpy as np

from ddlib._check import integer, number, one_of


def _check_name(name):
    if not isinstance(name, str) or not name.isidentifier() or keyword.iskeyword(name):
        raise ValueError(f"name must be a Python identifier, got {name!r}")


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
        _check_name(name)
        number(f"low of {name}", self.low)
        number(f"high of {name}", self.high, self.low, open_low=True)
        self.check(self.value)
        integer(f"grid of {name}", self.grid, 2)
        one_of(f"scale of {name}", self.scale, ("linear", "log"))
        if self.scale == "log":
            number(f"low of {name}", self.low, 0.0, open_low=True)

    def check(self, value) -> float:
        """`value` as a float, otherwise an error that names parameter, value and range."""
        return number(self.name, value, self.low, self.high)

    def points(self) -> list[float]:
        """The baked points."""
        return [min(self.place(f), float(self.high)) for f in np.linspace(0, 1, self.grid)]

    def place(self, fraction) -> float:
        """The value at a `fraction` (0 to 1) of the range, as the slider divides it."""
        if self.scale == "log":
            return float(self.low * (self.high / self.low) ** fraction)
        return float(self.low + (self.high - self.low) * fraction)

    def weights(self, value) -> list[tuple[int, float]]:
        """Places of the interval's four B-splines among a spline's coefficients, and weights."""
        x = self.check(value)
        if self.scale == "log":
            position = np.log(x / self.low) / np.log(self.high / self.low)
        else:
            position = (x - self.low) / (self.high - self.low)
        position = position * (self.grid - 1)
        i = min(max(int(position), 0), self.grid - 2)
        f = position - i
        w = [
            (1 - f) ** 3 / 6,
            ((3 * f - 6) * f * f + 4) / 6,
            (((3 - 3 * f) * f + 3) * f + 1) / 6,
            f**3 / 6,
        ]
        return list(zip(range(i, i + 4), w))

    def coefficients(self) -> np.ndarray:
        """The matrix from values at the baked points to a spline's coefficients.

        Cubic, its third derivative continuous at the second point and at the last but one: cubic
        polynomials come out exactly ("not a knot", de Boor 1978, chapter IV).
        """
        n = self.grid
        system = np.zeros((n + 2, n + 2))
        for k in range(n):
            system[k + 1, k : k + 3] = 1 / 6, 4 / 6, 1 / 6
        if n == 2:  # a line
            system[0, :3] = system[-1, 1:] = 1, -2, 1
        elif n == 3:  # a parabola
            system[0, :4] = system[-1, 1:] = -1, 3, -3, 1
        else:
            system[0, :5] = system[-1, -5:] = 1, -4, 6, -4, 1
        return np.linalg.inv(system)[:, 1:-1]

    def description(self) -> dict:
        """What the page needs to know."""
        return dict(vars(self))


@dataclass(frozen=True)
class Choice:
    """One of a few options; baked at each of them, never interpolated.

    Parameters
    ----------
    name : str
        Keyword of the function, and name of the widget's trait, which holds the key.
    label : str
        What the page calls it.
    options : mapping or sequence
        Key -> label, or keys alone. Keys are texts, numbers or truth values.
    value : str, int, float or bool
        The key chosen at the start.
    display : {"menu", "switch", "slider"}
        A menu; a switch (options ``{False: ..., True: ...}`` only); or a slider that steps
        over the options, for those with an order.
    """

    name: str
    label: str
    options: Mapping | Sequence
    value: str | int | float | bool
    display: str = "menu"

    def __post_init__(self):
        _check_name(self.name)
        given = self.options
        if isinstance(given, str) or not isinstance(given, (Mapping, Sequence, np.ndarray)):
            raise TypeError(f"options of {self.name} must be a mapping or sequence, got {given!r}")
        pairs = given.items() if isinstance(given, Mapping) else [(key, str(key)) for key in given]
        options = [(self._key(key), str(label)) for key, label in pairs]
        if len(options) < 2:
            raise ValueError(f"options of {self.name} must be two or more, got {len(options)}")
        if len({repr(key) for key, _ in options}) < len(options):
            raise ValueError(f"options of {self.name} must differ, got {given!r}")
        one_of(f"display of {self.name}", self.display, ("menu", "switch", "slider"))
        object.__setattr__(self, "options", dict(options))
        if self.display == "switch" and [repr(k) for k in self.options] != ["False", "True"]:
            raise ValueError(f"options of the switch {self.name} must be False and True: {given!r}")
        object.__setattr__(self, "value", self.check(self.value))

    def _key(self, key):
        key = _plain(key)
        if not isinstance(key, str) and not (isinstance(key, (int, float)) and isfinite(key)):
            raise TypeError(f"options of {self.name} must be texts or finite numbers, got {key!r}")
        return key

    @property
    def grid(self) -> int:
        """Number of options."""
        return len(self.options)

    def check(self, value) -> str | int | float | bool:
        """The key that equals `value`, otherwise an error that names choice, value and options."""
        value = _plain(value)
        if isinstance(value, str | int | float):
            for key in self.options:
                if key == value and isinstance(key, bool) == isinstance(value, bool):
                    return key  # True is no 1
        known = ", ".join(map(repr, self.options))
        raise ValueError(f"{self.name} must be one of {known}, got {value!r}")

    def points(self) -> list:
        """The keys, in their order."""
        return list(self.options)

    def place(self, fraction):
        """The key at a `fraction` (0 to 1) of the list."""
        return self.points()[min(int(fraction * self.grid), self.grid - 1)]

    def weights(self, value) -> list[tuple[int, float]]:
        """The option alone, with weight 1."""
        return [(self.points().index(self.check(value)), 1.0)]

    def coefficients(self) -> np.ndarray:
        """The identity: options have nothing between them."""
        return np.eye(self.grid)

    def description(self) -> dict:
        """What the page needs to know."""
        options = [[key, label] for key, label in self.options.items()]
        fields = {f: getattr(self, f) for f in ("name", "label", "value", "display", "grid")}
        return {**fields, "options": options}


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value
