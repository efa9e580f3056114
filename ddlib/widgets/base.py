"""A function of a few parameters that returns curves, as an interactive figure."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import anywidget
import matplotlib as mpl
import numpy as np
import traitlets as t

from ddlib._check import finite_array, integer, number, one_of
from ddlib.style import COLOURS, DASHES, illustrate
from ddlib.widgets.baked import Baked, Parameter, evaluate

HERE = Path(__file__).parent


def module(*names: str) -> str:
    """The named files of this folder as one text: a widget's script must stand alone."""
    return "\n".join((HERE / name).read_text(encoding="utf-8") for name in names)


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
        Where the curves are sampled.
    x_scale, y_scale : {"linear", "log"}
        Scales of the axes.
    """

    y_label: str
    curves: Sequence[str] | Mapping[str, str]
    x_label: str
    x: Sequence[float]
    x_scale: str = "linear"
    y_scale: str = "linear"

    def __post_init__(self):
        names = (self.curves,) if isinstance(self.curves, str) else self.curves
        legend = dict(names) if isinstance(names, Mapping) else {name: name for name in names}
        x = finite_array("x", self.x)
        if x.ndim != 1 or x.size < 2 or (np.diff(x) <= 0).any():
            raise ValueError(f"x of {self.y_label!r} must increase, got shape {x.shape}")
        one_of("x_scale", self.x_scale, ("linear", "log"))
        one_of("y_scale", self.y_scale, ("linear", "log"))
        if self.x_scale == "log":
            number(f"x of {self.y_label!r}", x[0], 0.0, open_low=True)
        object.__setattr__(self, "curves", legend)
        object.__setattr__(self, "x", x)


@dataclass(frozen=True)
class Scalar:
    """A number below the charts: its key in the function's result, label and unit."""

    name: str
    label: str
    unit: str = ""


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
    """

    x: str
    y: str
    marks: Sequence[Mark] = ()
    region: Sequence[tuple[float, float]] = ()
    region_label: str = ""


class _Bounded(t.Float):
    """The trait of a parameter: its errors name the parameter, the value and the range."""

    def __init__(self, parameter: Parameter):
        super().__init__(float(parameter.value))
        self.parameter = parameter

    def validate(self, obj, value):
        try:
            return self.parameter.check(value)
        except (TypeError, ValueError) as error:
            raise t.TraitError(str(error)) from None


class CurveWidget(anywidget.AnyWidget):
    """Curves of a function of a few parameters, with a slider for each.

    Every parameter is a trait of its own name, to set, observe and link. With a kernel the
    curves are the function's own; in a built page they are interpolated from values on a
    grid, which are computed here.

    Parameters
    ----------
    function : callable
        Called with one keyword per parameter; returns a dict of 1-D arrays and numbers. It
        should be quick (a few ms): it runs at every grid point and at every change.
    parameters : sequence of Parameter
        At least one.
    panels : sequence of Panel
        The charts.
    alt : str
        What the still picture shows, for those who cannot see it.
    title : str
        Name of the figure for screen readers; default the labels of the panels.
    scalars : sequence of Scalar
        Numbers to show below the charts.
    pad : Pad, optional
        Sets two parameters at once.
    interpolation : {"cubic", "linear"}
        Cubic for smooth functions.
    checks : int
        Number of random parameters at which the interpolation is compared with the function.
    tolerance : float
        Largest acceptable deviation, relative to the range of each curve.

    Raises
    ------
    ValueError
        If arguments do not fit together, if the grid needs more than 400 kB, or if it is too
        coarse for the tolerance.
    """

    _esm = module("baked.js", "curves.js")
    _css = module("curves.css")

    spec = t.Dict(help="everything that stays as it is").tag(sync=True)
    baked = t.Bytes(help="the table of `Baked`").tag(sync=True)
    request = t.Int(0, help="counts the page's requests for exact curves").tag(sync=True)
    exact = t.Bytes(b"", help="the function's curves as float32").tag(sync=True)
    answer = t.Dict(help="which request and parameters `exact` belongs to").tag(sync=True)
    still = t.Unicode(help="the starting state as a data URI").tag(sync=True)
    still_alt = t.Unicode().tag(sync=True)

    def __init__(
        self,
        function: Callable[..., dict],
        parameters: Sequence[Parameter],
        panels: Sequence[Panel],
        *,
        alt: str,
        title: str = "",
        scalars: Sequence[Scalar] = (),
        pad: Pad | None = None,
        interpolation: str = "cubic",
        checks: int = 200,
        tolerance: float = 0.01,
    ):
        if not callable(function):
            raise TypeError(f"function must be callable, got {function!r}")
        self._function, self._parameters = function, {p.name: p for p in parameters}
        self._panels, self._pad = tuple(panels), pad
        one_of("interpolation", interpolation, ("cubic", "linear"))
        integer("checks", checks, 1)
        number("tolerance", tolerance, 0.0, open_low=True)
        if len(self._parameters) != len(parameters) or not parameters:
            raise ValueError(f"parameters must have different names, got {len(parameters)}")
        for name in self._parameters:
            if hasattr(type(self), name):
                raise ValueError(f"name must not be an attribute of widgets, got {name!r}")
        self._baked = Baked(function, parameters, interpolation == "cubic")
        self._check_names(scalars)
        error = self._baked.error(checks)
        if error > tolerance:
            raise ValueError(
                f"grid must interpolate to {tolerance:g} of each curve's range, got {error:.2g}: "
                "take more grid points or a larger tolerance"
            )
        self.add_traits(**{p.name: _Bounded(p).tag(sync=True) for p in parameters})
        super().__init__(
            spec=self._spec(title, scalars, error, checks),
            baked=self._baked.tobytes(),
            still=self._still(alt),
            still_alt=alt,
        )
        self._compute()
        self.observe(self._on_change, [*self._parameters, "request"])

    @property
    def values(self) -> dict[str, float]:
        """The parameters as they stand."""
        return {name: getattr(self, name) for name in self._parameters}

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """The function's exact result at the parameters as they stand."""
        return evaluate(self._function, self.values)

    @property
    def baked_bytes(self) -> int:
        """Size of the baked values."""
        return len(self.baked)

    def interpolate(self, **values) -> dict[str, np.ndarray]:
        """What a built page shows; parameters that are not given stand as they are."""
        unknown = set(values) - set(self._parameters)
        if unknown:
            raise TypeError(f"values must be among {', '.join(self._parameters)}, got {unknown}")
        return self._baked.interpolate(**{**self.values, **values})

    def interpolation_error(self, n=200, seed=0) -> float:
        """Largest ``|interpolated - exact| / range`` of any curve at `n` random parameters."""
        return self._baked.error(n, seed)

    def _check_names(self, scalars):
        lengths, used = self._baked.lengths, {name for p in self._panels for name in p.curves}
        for name in [*used, *(s.name for s in scalars)]:
            one_of("curve", name, tuple(lengths))
        for panel in self._panels:
            for name in panel.curves:
                if lengths[name] != panel.x.size:
                    raise ValueError(
                        f"{name} must have {panel.x.size} samples like x of {panel.y_label!r}, "
                        f"got {lengths[name]}"
                    )
        for scalar in scalars:
            if lengths[scalar.name] != 1:
                raise ValueError(f"{scalar.name} must be one number, got {lengths[scalar.name]}")
        if self._pad:
            for name in (self._pad.x, self._pad.y):
                one_of("parameter of the pad", name, tuple(self._parameters))

    def _spec(self, title, scalars, error, checks) -> dict:
        baked = self._baked
        curves = [
            {"name": name, "length": n, "low": float(low), "high": float(high)}
            for (name, n), low, high in zip(baked.lengths.items(), baked.low, baked.high)
        ]
        fields = ("name", "label", "low", "high", "unit", "grid", "scale")
        pad = self._pad
        return {
            "title": title or "; ".join(p.y_label for p in self._panels),
            "parameters": [{f: getattr(p, f) for f in fields} for p in baked.parameters],
            "curves": curves,
            "panels": [{**vars(p), "x": np.round(p.x, 9).tolist()} for p in self._panels],
            "scalars": [vars(s) for s in scalars],
            "pad": pad
            and {
                **vars(pad),
                "marks": [vars(m) for m in pad.marks],
                "region": [list(map(float, corner)) for corner in pad.region],
            },
            "cubic": baked.cubic,
            "checksum": baked.checksum(),
            "error": error,
            "checks": checks,
        }

    def _on_change(self, change):
        state = {"request": self.request, "values": list(self.values.values())}
        if {k: self.answer.get(k) for k in state} != state:
            self._compute()

    def _compute(self):
        """Put the exact curves, or the reason why there are none, before the page."""
        answer = {"request": self.request, "values": list(self.values.values())}
        exact = b""
        try:
            exact = np.concatenate(list(self.curves.values())).astype("<f4").tobytes()
        except Exception as error:  # shown in the figure: a comm's handler has no other reader
            answer["error"] = f"{type(error).__name__}: {error}"
        with self.hold_sync():
            self.exact, self.answer = exact, answer

    def _still(self, alt: str) -> str:
        values = {name: p.value for name, p in self._parameters.items()}
        curves = evaluate(self._function, values)
        pad, count = self._pad, len(self._panels) + bool(self._pad)

        def draw(figure):
            mpl.rcParams.update({"svg.fonttype": "none", "font.family": "sans-serif"})
            axes = list(np.ravel(figure.subplots(1, count)))
            if pad:
                self._draw_pad(axes.pop(0), values)
            for ax, panel in zip(axes, self._panels):
                for k, (name, label) in enumerate(panel.curves.items()):
                    style = {"color": COLOURS[k % 6], "linestyle": DASHES[k % 6], "label": label}
                    ax.plot(panel.x, curves[name], **style)
                ax.set(xscale=panel.x_scale, yscale=panel.y_scale)
                ax.set(title=panel.y_label, xlabel=panel.x_label)
                if len(panel.curves) > 1:
                    ax.legend()

        svg = illustrate(draw, alt, width=2.9 * count, height=2.6).svg
        svg = svg.replace("currentColor", "#1a1a1a")
        svg = svg.replace('style="', 'style="background:#fff;', 1)
        return "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode()

    def _draw_pad(self, ax, values):
        pad = self._pad
        if pad.region:
            ax.fill(*zip(*pad.region), color=COLOURS[0], alpha=0.18, linewidth=0)
        groups = list(dict.fromkeys(mark.group for mark in pad.marks))
        for mark in pad.marks:
            k = groups.index(mark.group)
            ax.plot(mark.x, mark.y, "os^D"[k % 4], color=COLOURS[k], clip_on=False)
        ax.plot(values[pad.x], values[pad.y], "o", ms=11, mfc="none", mec="#1a1a1a", clip_on=False)
        x, y = self._parameters[pad.x], self._parameters[pad.y]
        ax.set(xlim=(x.low, x.high), ylim=(y.low, y.high), aspect="auto")
        ax.set(xlabel=f"{x.label}, {x.unit}", ylabel=f"{y.label}, {y.unit}")
