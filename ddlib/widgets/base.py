"""A function of a few parameters that returns curves, as an interactive figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import anywidget
import numpy as np
import traitlets as t

from ddlib._check import number, one_of
from ddlib.widgets._baking.baked import Baked, evaluate
from ddlib.widgets._baking.still import Still, still_picture
from ddlib.widgets.parts._common import checked_presets, default_code, filled, key_of
from ddlib.widgets.parts.panels import Pad, Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter

_STATIC = Path(__file__).with_name("static")

# Files of the folder `static`, in their order: what every widget has, what a `CurveWidget` has, and
# its style sheet. A class of its own kind adds its own after them.
_FRAME = ("elements.js", "frame.js")
SCRIPT = ("baked.js", *_FRAME, "reading.js", "charts.js", "dragging.js", "kernel.js")
SCRIPT += ("controls.js", "curves.js")
STYLE = ("curves.css",)
_CHECKS = 200  # random settings at which the interpolation is compared with the function


def module(*names: str | Path) -> str:
    """Files of the folder `static`, or by full paths, as one text: a script must stand alone."""
    return "\n".join((_STATIC / name).read_text(encoding="utf-8") for name in names)


class _Checked(t.TraitType):
    """The trait of a parameter: its errors name the parameter, the value and the range."""

    def __init__(self, parameter: Parameter | Choice):
        super().__init__(parameter.check(parameter.value))
        self.parameter = parameter

    def validate(self, obj, value):
        try:
            return self.parameter.check(value)
        except (TypeError, ValueError) as error:
            raise t.TraitError(str(error)) from None


class _PageWidget(anywidget.AnyWidget):
    """What every widget has: a description for the page, and a picture for pages without script."""

    spec = t.Dict(help="everything that stays as it is", read_only=True).tag(sync=True)
    still = Still(help="the starting state as a picture", read_only=True).tag(sync=True)
    still_alt = t.Unicode(read_only=True).tag(sync=True)

    def _keep(self, **values):
        """Set traits that are read-only for others."""
        for name, value in values.items():
            self.set_trait(name, value)


class CurveWidget(_PageWidget):
    """Curves of a function of a few parameters, with a control for each.

    Every parameter is a trait of its own name, to set, observe and link. With a kernel the
    curves are the function's own; in a built page they are interpolated from values on a
    grid, which are computed here.

    Parameters
    ----------
    function : callable
        Called with one keyword per parameter; returns a dict of 1-D arrays and numbers. It
        should be quick (a few ms): it runs at every grid point and at every change.
    parameters : sequence of Parameter or Choice
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
    note : str
        A sentence below the controls.
    code : str
        Python code with the same result as the widget's state, for readers to copy; names of
        parameters in braces stand for their values. Default: it makes the widget, if that
        needs no arguments.
    presets : mapping, optional
        Label -> value by name of a parameter: buttons that set several parameters at once.
    presets_title : str
        What stands before these buttons.
    depends : mapping, optional
        Key of the function's result -> names of the only parameters that it depends on;
        default: all. Saves space: such curves are baked over these parameters alone.
    tolerance : float
        Largest acceptable deviation of the interpolation (cubic splines), relative to the range
        of each curve.

    Raises
    ------
    ValueError
        If arguments do not fit together, if the grid needs more than 400 kB, or if it is too
        coarse for the tolerance.
    """

    _esm = module(*SCRIPT)
    _css = module(*STYLE)

    baked = t.Bytes(help="the table of `Baked`", read_only=True).tag(sync=True)
    request = t.Int(0, help="counts the page's requests for exact curves").tag(sync=True)
    exact = t.Bytes(b"", help="the function's curves as float32", read_only=True).tag(sync=True)
    answer = t.Dict(help="request and values that `exact` belongs to", read_only=True)
    answer.tag(sync=True)

    def __init__(
        self,
        function: Callable[..., dict],
        parameters: Sequence[Parameter | Choice],
        panels: Sequence[Panel],
        *,
        alt: str,
        title: str = "",
        scalars: Sequence[Scalar] = (),
        pad: Pad | None = None,
        note: str = "",
        code: str = "",
        presets: Mapping[str, Mapping] | None = None,
        presets_title: str = "Go to",
        depends: Mapping[str, Sequence[str]] | None = None,
        tolerance: float = 0.01,
    ):
        if not callable(function):
            raise TypeError(f"function must be callable, got {function!r}")
        self._function, self._parameters = function, {p.name: p for p in parameters}
        self._panels, self._pad = tuple(panels), pad
        number("tolerance", tolerance, 0.0, open_low=True)
        if len(self._parameters) != len(parameters) or not parameters:
            raise ValueError(f"parameters must have different names, got {len(parameters)}")
        for name in self._parameters:
            if hasattr(type(self), name):
                raise ValueError(f"name must not be an attribute of widgets, got {name!r}")
        self._baked = self._bake(function, parameters, tolerance, depends)
        self._check_names(scalars)
        error = self._baked.error(_CHECKS)
        if error > tolerance:
            raise ValueError(
                f"grid must interpolate to {tolerance:g} of each curve's range, got {error:.2g}: "
                "take more grid points or a larger tolerance"
            )
        self._code = code or default_code(type(self), self._parameters)
        self._presets = checked_presets(presets, self._parameters)
        start = self._first({p.name: p.value for p in parameters})
        self.add_traits(**{p.name: _Checked(p).tag(sync=True) for p in parameters})
        told = {"title": title, "note": note, "presets_title": presets_title}
        self._keep(
            spec=self._spec(told, scalars, error),
            baked=self._baked.tobytes(),
            still=still_picture(start, panels, self._parameters, pad, alt),
            still_alt=alt,
        )
        super().__init__()
        self._compute()
        self.observe(self._on_change, [*self._parameters, "request"])

    def _first(self, values) -> dict:
        """The curves of the still picture."""
        return evaluate(self._function, values)

    def _bake(self, *given):
        """What the page takes its curves from."""
        return Baked(*given)

    @property
    def values(self) -> dict:
        """The parameters as they stand."""
        return {name: getattr(self, name) for name in self._parameters}

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """The function's exact result at the parameters as they stand."""
        return evaluate(self._function, self.values)

    @property
    def code(self) -> str:
        """Python code with the same result as the present state."""
        return filled(self._code, self.values)

    @property
    def baked_bytes(self) -> int:
        """Size of the baked values."""
        return len(self.baked)

    def interpolate(self, **values) -> dict[str, np.ndarray]:
        """What a built page shows; parameters that are not given stand as they are."""
        unknown = ", ".join(name for name in values if name not in self._parameters)
        if unknown:
            raise TypeError(f"values must be among {', '.join(self._parameters)}, got {unknown}")
        return self._baked.interpolate(**{**self.values, **values})

    def interpolation_error(self, n=200, seed=0) -> float:
        """Largest ``|interpolated - exact| / range`` of any curve at `n` random settings."""
        return self._baked.error(n, seed)

    def _check_names(self, scalars):
        lengths, used = self._baked.lengths, {name for p in self._panels for name in p.curves}
        single = [s.name for s in scalars] + [name for p in self._panels for name in p.numbers]
        for name in [*used, *single]:
            one_of("curve", name, tuple(lengths))
        for panel in self._panels:
            for name in panel.curves:
                if lengths[name] != panel.x.size:
                    raise ValueError(
                        f"{name} must have {panel.x.size} samples like x of {panel.y_label!r}, "
                        f"got {lengths[name]}"
                    )
        for name in single:
            if lengths[name] != 1:
                raise ValueError(f"{name} must be one number, got {lengths[name]}")
        if self._pad:
            ranged = [n for n, p in self._parameters.items() if isinstance(p, Parameter)]
            for name in (self._pad.x, self._pad.y):
                one_of("parameter of the pad", name, tuple(ranged))

    def _spec(self, told, scalars, error) -> dict:
        baked = self._baked
        curves = [
            {"name": name, "length": n, "low": float(low), "high": float(high)}
            for (name, n), low, high in zip(baked.lengths.items(), baked.low, baked.high)
        ]
        presets = {"title": told["presets_title"], "options": self._presets}
        return {
            "key": key_of(type(self)),
            "title": told["title"] or "; ".join(p.y_label for p in self._panels),
            "note": told["note"],
            "code": self._code,
            "presets": presets if self._presets else None,
            "parameters": [p.description() for p in baked.parameters],
            "curves": curves,
            "panels": [p.description() for p in self._panels],
            "scalars": [vars(s) for s in scalars],
            "pad": self._pad and self._pad.description(),
            "groups": baked.groups,
            "checksum": baked.checksum(),
            "error": error,
            "checks": _CHECKS,
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
            self._keep(exact=exact, answer=answer)
