"""The pieces of which a `CurveWidget` is put together: plain, checked descriptions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import traitlets

from ddlib._check import finite_array, integer, number, one_of


class ParameterError(traitlets.TraitError, ValueError):
    """A value that a widget refuses; both a `TraitError` and a `ValueError`."""


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Round numbers within `low` to `high`, about `count` of them."""
    raw = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in (1, 2, 2.5, 5, 10) if m * power >= raw * (1 - 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [float(f"{i * step:.10g}") for i in range(first, last + 1)]


def log_ticks(low: float, high: float) -> list[float]:
    """1, 2, 5 times powers of ten within `low` to `high`; only the powers if they suffice."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for digits in ((1,), (1, 3), (1, 2, 5)):
        found = [d * 10.0**p for p in powers for d in digits]
        found = [x for x in found if low * (1 - 1e-9) <= x <= high * (1 + 1e-9)]
        if len(found) >= 3:
            break
    return [float(f"{x:.6g}") for x in found]


@dataclass(frozen=True)
class Parameter:
    """A number that the reader moves.

    Parameters
    ----------
    name : str
        Argument of the function and name of the widget's trait.
    label : str
        What the reader sees beside the slider.
    low, high, default : float
        Range (both ends included) and initial value, in `unit`.
    unit : str
        Unit, as printed after the value.
    grid : int
        Baked values along this axis, 2 to 65.
    scale : {"linear", "log"}
        Spacing of the slider and of the baked values.
    step : float, optional
        Smallest change on a linear slider; by default about a hundredth of the range.
    interpolation : {"cubic", "linear"}
        Between baked values; linear for curves with kinks.
    tick_step : float, optional
        Distance of the ticks when the parameter is an axis of a pad.

    Raises
    ------
    TypeError, ValueError
        If a value is not finite, out of range or unknown.
    """

    name: str
    label: str
    low: float
    high: float
    default: float
    unit: str = ""
    grid: int = 9
    scale: str = "linear"
    step: float | None = None
    interpolation: str = "cubic"
    tick_step: float | None = None

    def __post_init__(self):
        number("low", self.low)
        number("high", self.high, self.low, open_low=True)
        one_of("scale", self.scale, ("linear", "log"))
        if self.scale == "log":
            number("low", self.low, 0.0, open_low=True)
        number("default", self.default, self.low, self.high)
        integer("grid", self.grid, 2, 65)
        one_of("interpolation", self.interpolation, ("linear", "cubic"))
        width = self.high - self.low
        if self.step is None:
            object.__setattr__(self, "step", 10.0 ** math.floor(math.log10(width / 50)))
        number("step", self.step, 0.0, width, open_low=True)
        if self.tick_step is not None:
            number("tick_step", self.tick_step, 0.0, width, open_low=True)

    @property
    def nodes(self) -> np.ndarray:
        """The baked values, shape ``(grid,)``."""
        spaced = np.geomspace if self.scale == "log" else np.linspace
        return spaced(self.low, self.high, self.grid)

    def at(self, fraction):
        """The value at a `fraction` (0 to 1) of the slider's length."""
        if self.scale == "log":
            value = self.low * (self.high / self.low) ** np.asarray(fraction)
        else:
            value = self.low + (self.high - self.low) * np.asarray(fraction)
        return np.clip(value, self.low, self.high)

    def fraction(self, value: float) -> float:
        """Where `value` lies on the slider, 0 to 1."""
        if self.scale == "log":
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def stencil(self, value: float) -> tuple[int, np.ndarray]:
        """First of the baked values that decide at `value`, and their weights.

        Lagrange interpolation through two (linear) or four (cubic) neighbours.
        """
        count = min(self.grid, 4 if self.interpolation == "cubic" else 2)
        u = self.fraction(value) * (self.grid - 1)
        first = min(max(math.floor(u) - (count // 2 - 1), 0), self.grid - count)
        weights = np.ones(count)
        for i in range(count):
            for j in range(count):
                if i != j:
                    weights[i] *= (u - first - j) / (i - j)
        return first, weights

    def checked(self, value) -> float:
        """`value` as a float; `ParameterError` names parameter, value and range."""
        try:
            return number(self.name, value, self.low, self.high)
        except (TypeError, ValueError) as error:
            unit = f" {self.unit}" if self.unit else ""
            raise ParameterError(
                f"{error} (parameter {self.name!r}: {self.low:g} to {self.high:g}{unit})"
            ) from None

    def random(self, n: int, rng) -> np.ndarray:
        """`n` values spread evenly over the slider's length."""
        return self.at(rng.uniform(size=n))

    def spec(self) -> dict:
        """What the browser needs to know."""
        axis = {
            name: getattr(self, name)
            for name in ("name", "label", "low", "high", "unit", "grid", "scale", "step")
        }
        if self.tick_step:
            first = math.ceil(self.low / self.tick_step - 1e-9)
            last = math.floor(self.high / self.tick_step + 1e-9)
            marks = [i * self.tick_step for i in range(first, last + 1)]
        else:
            marks = (log_ticks if self.scale == "log" else ticks)(self.low, self.high)
        decimals = max(0, -math.floor(math.log10(self.step) + 1e-9))
        return axis | {
            "order": 4 if self.interpolation == "cubic" else 2,
            "decimals": decimals,
            "ticks": marks,
        }

    def text(self, value: float) -> str:
        """`value` with its unit, as the browser prints it."""
        digits = f"{value:.3g}" if self.scale == "log" else f"{value:.{self.spec()['decimals']}f}"
        return with_unit(digits, self.unit)


@dataclass(frozen=True)
class Choice:
    """One of a few values: a menu, or a tick box when the options are False and True.

    Parameters
    ----------
    name, label : str
        As for a `Parameter`.
    options : sequence, or mapping of label to value
        Strings, numbers or booleans; each is baked.
    default
        The initial value, one of the options.

    Raises
    ------
    ValueError
        If there are no options, two are equal, or the default is not among them.
    """

    name: str
    label: str
    options: Sequence | Mapping
    default: object

    def __post_init__(self):
        options = self.options
        if not isinstance(options, Mapping):
            options = {str(value): value for value in options}
        object.__setattr__(self, "options", dict(options))
        if not options or len(set(map(repr, options.values()))) != len(self.options):
            raise ValueError(f"options of {self.name!r} must be one or more different values")
        self.checked(self.default)

    unit = ""
    interpolation = "none"

    @property
    def grid(self) -> int:
        """Number of options."""
        return len(self.options)

    @property
    def nodes(self) -> list:
        """The options' values."""
        return list(self.options.values())

    def stencil(self, value) -> tuple[int, np.ndarray]:
        """Index of `value` and the weight one."""
        return self._index(value), np.ones(1)

    def _index(self, value) -> int:
        for index, option in enumerate(self.options.values()):
            if type(option) is type(value) and option == value:
                return index
        return -1

    def checked(self, value):
        """`value` if it is an option; otherwise a `ParameterError` lists them."""
        if isinstance(value, np.generic):
            value = value.item()
        if self._index(value) < 0:
            known = ", ".join(map(repr, self.options.values()))
            raise ParameterError(f"{self.name} must be one of {known}, got {value!r}")
        return value

    def random(self, n: int, rng) -> list:
        """`n` of the options."""
        return [self.nodes[i] for i in rng.integers(self.grid, size=n)]

    def spec(self) -> dict:
        """What the browser needs to know."""
        options = [{"label": label, "value": value} for label, value in self.options.items()]
        return {"name": self.name, "label": self.label, "grid": self.grid, "options": options}

    def text(self, value) -> str:
        """The label of `value`."""
        return next(label for label, v in self.options.items() if v == value)


def with_unit(digits: str, unit: str) -> str:
    """A number and its unit; a degree sign follows without a space."""
    return f"{digits}{'' if unit in ('', '°', '%') else ' '}{unit}"


@dataclass(frozen=True)
class Curve:
    """One curve of a panel.

    Parameters
    ----------
    name : str
        Key of the array that the function returns.
    label : str
        Name in the legend.
    color : int, optional
        Which of the eight colours and dash patterns; by default the place in the panel.
    x : str, optional
        Key of the array with the curve's abscissae, instead of the panel's `x`.
    points : bool
        Draw the samples as dots rather than a line.
    """

    name: str
    label: str
    color: int | None = None
    x: str | None = None
    points: bool = False


@dataclass(frozen=True)
class Panel:
    """A pair of axes with curves.

    Parameters
    ----------
    title, x_label, y_label : str
        Labels carry the unit: ``"time, s"``.
    x : array_like, shape (samples,)
        Abscissae that the curves share, increasing.
    curves : sequence of Curve
    x_scale, y_scale : {"linear", "log"}
    y_range : pair of float, "fixed" or "follow"
        Fixed to what all baked curves need, or following the curves that are shown.

    Raises
    ------
    ValueError
        If an array or option does not fit.
    """

    title: str
    x_label: str
    y_label: str
    x: Sequence[float]
    curves: Sequence[Curve]
    x_scale: str = "linear"
    y_scale: str = "linear"
    y_range: tuple[float, float] | str = "fixed"

    def __post_init__(self):
        x = finite_array(f"x of panel {self.title!r}", self.x)
        if x.ndim != 1 or x.size < 2 or not (np.diff(x) > 0).all():
            raise ValueError(f"x of panel {self.title!r} must be an increasing series of numbers")
        object.__setattr__(self, "x", x)
        object.__setattr__(self, "curves", tuple(self.curves))
        if not self.curves:
            raise ValueError(f"curves of panel {self.title!r} must hold a Curve or more")
        one_of("x_scale", self.x_scale, ("linear", "log"))
        one_of("y_scale", self.y_scale, ("linear", "log"))
        if isinstance(self.y_range, str):
            one_of("y_range", self.y_range, ("fixed", "follow"))
        else:
            low, high = finite_array("y_range", self.y_range, 2)
            number("y_range[1]", high, low, open_low=True)


@dataclass(frozen=True)
class Readout:
    """A single number below the controls: key of the function's result, label, unit, digits."""

    name: str
    label: str
    unit: str = ""
    digits: int = 3


@dataclass(frozen=True)
class Mark:
    """A marked point on a pad; `role` is "training" (a disc) or "test" (a diamond)."""

    x: float
    y: float
    label: str
    role: str = "training"

    def __post_init__(self):
        one_of("role", self.role, ("training", "test"))


@dataclass(frozen=True)
class Pad:
    """A plane in which two parameters are chosen at once.

    Parameters
    ----------
    x, y : str
        Names of the two parameters.
    label : str
        What the pad is called.
    marks : sequence of Mark
        Points of interest; a click near one selects it exactly.
    marks_label : str
        Name of the row of buttons that select the marks.
    region : array_like, shape (corners, 2), optional
        A polygon; what lies outside is hatched.
    inside, outside : str
        Sentences that say where the chosen point lies.
    """

    x: str
    y: str
    label: str
    marks: Sequence[Mark] = ()
    marks_label: str = "Marked points"
    region: Sequence | None = None
    inside: str = "inside the region"
    outside: str = "outside the region"

    def spec(self) -> dict:
        """What the browser needs to know."""
        region = [] if self.region is None else finite_array("region", self.region, 2).tolist()
        marks = [vars(mark) for mark in self.marks]
        names = ("x", "y", "label", "marks_label", "inside", "outside")
        return {n: getattr(self, n) for n in names} | {"marks": marks, "region": region}


@dataclass(frozen=True)
class ArmPose:
    """Curves with the joint angles (degrees) of one drawn arm, elbow relative to the upper link."""

    label: str
    shoulder: str
    elbow: str
    ghost: bool = False


@dataclass(frozen=True)
class Stage:
    """A drawing of one or more two-link arms that moves through time.

    Parameters
    ----------
    t : array_like, shape (time,)
        Times of the samples, s. Panels with the same `x` show a cursor.
    arms : sequence of ArmPose
        An arm with ``ghost=True`` is an outline (the reference, say).
    lengths : pair of float
        Link lengths, m.
    view : tuple of float, optional
        ``(x_low, x_high, y_low, y_high)`` in m; by default all that the arm reaches.
    trace : pair of str, optional
        Curves with the hand's x and y in m, drawn as a faint path.
    title : str
    start : float
        Time shown at first, s.

    Raises
    ------
    ValueError
        If an array does not fit.
    """

    t: Sequence[float]
    arms: Sequence[ArmPose]
    lengths: tuple[float, float]
    view: tuple[float, float, float, float] | None = None
    trace: tuple[str, str] | None = None
    title: str = "The arm from above"
    start: float = field(default=0.0)

    def __post_init__(self):
        t = finite_array("t", self.t)
        if t.ndim != 1 or t.size < 2 or not (np.diff(t) > 0).all():
            raise ValueError("t must be an increasing series of two times or more")
        object.__setattr__(self, "t", t)
        lengths = finite_array("lengths", self.lengths, 2)
        if (lengths <= 0).any():
            raise ValueError(f"lengths must be positive, got {self.lengths}")
        reach = float(lengths.sum())
        view = (-reach, reach, -reach, reach) if self.view is None else self.view
        object.__setattr__(self, "view", tuple(finite_array("view", view, 4).tolist()))
        number("start", self.start, t[0], t[-1])

    def spec(self) -> dict:
        """What the browser needs to know."""
        return {
            "t": compact(self.t),
            "arms": [vars(arm) for arm in self.arms],
            "lengths": list(self.lengths),
            "view": list(self.view),
            "trace": list(self.trace or ()),
            "title": self.title,
            "start": self.start,
        }


def compact(x) -> list[float]:
    """`x` as numbers of seven digits, for JSON."""
    return [float(f"{value:.7g}") for value in x]
