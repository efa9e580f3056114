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

    A slider steps over the points of its grid, at which the curves were computed, and a built page
    has nothing between; with a kernel, code may set any value. Where the page itself computes, the
    slider goes anywhere.

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
        Number of points from `low` to `high`, 2 or more.
    scale : {"linear", "log"}
        Spacing of these points and of the slider.
    """

    name: str
    label: str
    low: float
    high: float
    value: float
    unit: str = ""
    grid: int = 21
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
        """The points of the grid."""
        return [min(self.place(f), float(self.high)) for f in np.linspace(0, 1, self.grid)]

    def place(self, fraction) -> float:
        """The value at a `fraction` (0 to 1) of the range, as the slider divides it."""
        if self.scale == "log":
            return float(self.low * (self.high / self.low) ** fraction)
        return float(self.low + (self.high - self.low) * fraction)

    def nearest(self, value) -> int:
        """Place of the grid point that is nearest to a value."""
        x = self.check(value)
        if self.scale == "log":
            fraction = np.log(x / self.low) / np.log(self.high / self.low)
        else:
            fraction = (x - self.low) / (self.high - self.low)
        return round(fraction * (self.grid - 1))

    def description(self) -> dict:
        """What the page needs to know."""
        return dict(vars(self))


@dataclass(frozen=True)
class Choice:
    """One of a few options.

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

    def nearest(self, value) -> int:
        """Place of a key among the options."""
        return self.points().index(self.check(value))

    def description(self) -> dict:
        """What the page needs to know."""
        options = [[key, label] for key, label in self.options.items()]
        fields = {f: getattr(self, f) for f in ("name", "label", "value", "display", "grid")}
        return {**fields, "options": options}


@dataclass(frozen=True)
class Presets:
    """Buttons that set several parameters at once.

    Parameters
    ----------
    options : mapping
        Label of each button -> value by name of a parameter.
    title : str
        What stands before the buttons.
    """

    options: Mapping[str, Mapping]
    title: str = "Go to"

    def description(self, parameters: Mapping[str, Parameter | Choice]) -> dict | None:
        """What the page needs to know, each value checked by its parameter; None for no button."""
        checked = []
        for label, values in self.options.items():
            for name in values:
                if name not in parameters:
                    known = ", ".join(parameters)
                    raise ValueError(f"preset {label!r} must set some of {known}, got {name}")
            checked.append([str(label), {n: parameters[n].check(v) for n, v in values.items()}])
        return {"title": self.title, "options": checked} if checked else None


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value
