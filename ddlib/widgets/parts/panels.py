"""What a widget shows: charts, numbers and a pad, as plain descriptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, integer, number, one_of
from ddlib.figures import looks
from ddlib.figures.style import Look


@dataclass(frozen=True)
class Panel:
    """A chart: curves that share their axes.

    Parameters
    ----------
    y_label : str
        Quantity and unit, the chart's title.
    curves : sequence of str or mapping
        Keys of the function's result; a mapping gives each its name in the legend.
    x_label : str
        Quantity and unit.
    x : array_like
        Where the curves are sampled; increases.
    x_scale, y_scale : {"linear", "log"}
        Scales of the axes. Stems and bars stand on zero, so their `y_scale` is linear; bars
        are equally wide, so their `x_scale` is, too.
    kind : {"line", "stems", "bars"}
        Lines; dots on stalks from zero; bars from zero, side by side where there are several
        curves.
    fixed : mapping, optional
        Legend name -> values on `x` of curves that do not change.
    cursor : str or pair of str, optional
        Number in the function's result at which a vertical line stands; or two of them, the
        ends of a shaded interval.
    ticks : sequence of (float, str), optional
        Places and texts in place of numbers on the x axis.
    y_range : pair of float or str, optional
        Lowest and highest y, or names of numbers in the function's result; default: all
        that the curves reach on the grid.
    y_fit : bool
        The y axis follows the curves as they stand.
    roles : mapping, optional
        Legend name -> role, of names that do not say theirs (`ddlib.figures.looks`).
    limits : pair of float or None, optional
        Values at which curves were cut off, lowest and highest: where a curve lies there, a
        triangle says that it goes on beyond. Lines only.
    """

    y_label: str
    curves: Sequence[str] | Mapping[str, str]
    x_label: str
    x: Sequence[float]
    x_scale: str = "linear"
    y_scale: str = "linear"
    kind: str = "line"
    fixed: Mapping[str, Sequence[float]] | None = None
    cursor: str | tuple[str, str] | None = None
    ticks: Sequence[tuple[float, str]] | None = None
    y_range: tuple[float | str, float | str] | None = None
    y_fit: bool = False
    roles: Mapping[str, str] | None = None
    limits: tuple[float | None, float | None] = (None, None)

    def __post_init__(self):
        names = (self.curves,) if isinstance(self.curves, str) else self.curves
        legend = dict(names) if isinstance(names, Mapping) else {name: name for name in names}
        what = f"of {self.y_label!r}"
        x = finite_array(f"x {what}", self.x)
        if x.ndim != 1 or x.size < 2 or (np.diff(x) <= 0).any():
            raise ValueError(f"x {what} must increase, got shape {x.shape}")
        one_of(f"kind {what}", self.kind, ("line", "stems", "bars"))
        both = ("linear", "log")
        one_of(f"x_scale {what}", self.x_scale, ("linear",) if self.kind == "bars" else both)
        one_of(f"y_scale {what}", self.y_scale, both if self.kind == "line" else ("linear",))
        if self.x_scale == "log":
            number(f"x {what}", x[0], 0.0, open_low=True)
        fixed = {
            str(name): finite_array(f"{name} {what}", values)
            for name, values in (self.fixed or {}).items()
        }
        for name, values in fixed.items():
            if values.shape != x.shape:
                raise ValueError(f"{name} {what} must have shape {x.shape}, got {values.shape}")
        cursor = (self.cursor,) if isinstance(self.cursor, str) else tuple(self.cursor or ())
        if len(cursor) > 2:
            raise ValueError(f"cursor {what} must be one or two names, got {cursor}")
        ticks = [(number(f"ticks {what}", place), str(text)) for place, text in self.ticks or ()]
        if legend or fixed:
            looks([*legend.values(), *fixed], self.roles)  # refuses what is no role
        checked = {"curves": legend, "x": x, "fixed": fixed, "cursor": cursor, "ticks": ticks}
        checked["y_range"] = self._checked_range(what)
        checked["limits"] = self._checked_limits(what)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def _checked_range(self, what):
        if self.y_range is None:
            return None
        ends = tuple(x if isinstance(x, str) else number("y_range", x) for x in self.y_range)
        if len(ends) != 2:
            raise ValueError(f"y_range {what} must be a pair, got {self.y_range}")
        numbers = [x for x in ends if not isinstance(x, str)]
        if len(numbers) == 2 and numbers[0] >= numbers[1]:
            raise ValueError(f"y_range {what} must increase, got {self.y_range}")
        if self.y_scale == "log" and min(numbers, default=1) <= 0:
            raise ValueError(f"y_range {what} must be positive, got {self.y_range}")
        return ends

    def _checked_limits(self, what):
        ends = tuple(x if x is None else number(f"limits {what}", x) for x in self.limits)
        if len(ends) != 2 or (None not in ends and ends[0] >= ends[1]):
            raise ValueError(f"limits {what} must be a pair that increases, got {self.limits}")
        if ends != (None, None) and self.kind != "line":
            raise ValueError(f"limits {what} must be of lines, got kind {self.kind!r}")
        return ends

    @property
    def numbers(self) -> list[str]:
        """Keys of the function's result that must be single numbers."""
        return [*self.cursor, *(x for x in self.y_range or () if isinstance(x, str))]

    @property
    def looks(self) -> dict[str, Look]:
        """How each curve is drawn, by its legend name."""
        return looks([*self.curves.values(), *self.fixed], self.roles)

    def description(self) -> dict:
        """What the page needs to know."""
        classes = {name: look.classes for name, look in self.looks.items()}
        plain = {name: value for name, value in vars(self).items() if name != "roles"}
        return {
            **plain,
            "x": np.round(self.x, 9).tolist(),
            "curves": [[name, legend, classes[legend]] for name, legend in self.curves.items()],
            "fixed": [
                [name, [float(f"{v:.6g}") for v in values], classes[name]]
                for name, values in self.fixed.items()
            ],
            "cursor": list(self.cursor),
            "ticks": [list(tick) for tick in self.ticks],
            "y_range": self.y_range and list(self.y_range),
            "y_fit": bool(self.y_fit),
            "limits": list(self.limits),
        }


@dataclass(frozen=True)
class Scalar:
    """A number below the charts.

    Parameters
    ----------
    name : str
        Key of the function's result.
    label, unit : str
        What the page calls it, and what follows the number.
    digits : int, optional
        Decimals; default: as many as the range on the grid deserves.
    """

    name: str
    label: str
    unit: str = ""
    digits: int | None = None

    def __post_init__(self):
        if self.digits is not None:
            integer(f"digits of {self.name}", self.digits, 0, 10)


@dataclass(frozen=True)
class Mark:
    """A marked point of a pad.

    Parameters
    ----------
    x, y : float
        Where, in the units of the two parameters.
    label : str
        Short text beside the mark.
    group : str
        Marks of one group share a shape, which the legend explains.
    """

    x: float
    y: float
    label: str
    group: str


@dataclass(frozen=True)
class Pad:
    """A square on which two parameters are set at once.

    Parameters
    ----------
    x, y : str
        Names of the two parameters.
    marks : sequence of Mark
        Points of interest.
    region : sequence of pairs
        Corners of a shaded convex polygon; empty for none.
    region_label : str
        What the legend calls it.
    snap : float
        How near to a mark, as a part of the pad's side, a drag is drawn to it.
    """

    x: str
    y: str
    marks: Sequence[Mark] = ()
    region: Sequence[tuple[float, float]] = ()
    region_label: str = ""
    snap: float = 0.0

    def __post_init__(self):
        number("snap of the pad", self.snap, 0.0, 0.5)

    @property
    def looks(self) -> dict[str, Look]:
        """How the marks of each group are drawn."""
        return looks(mark.group for mark in self.marks)

    def description(self) -> dict:
        """What the page needs to know."""
        return {
            **vars(self),
            "marks": [
                {**vars(mark), "look": self.looks[mark.group].classes} for mark in self.marks
            ],
            "region": [list(map(float, corner)) for corner in self.region],
        }
