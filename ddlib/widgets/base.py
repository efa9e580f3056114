"""A function of a few parameters that returns curves, as an interactive figure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape

import anywidget
import numpy as np
import traitlets as t

from ddlib._check import one_of
from ddlib.widgets.parts._common import default_code, filled, key_of
from ddlib.widgets.parts.panels import Pad, Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter, Presets
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import Still, still_picture
from ddlib.widgets.table import Live, evaluate, ranged, tabled, tobytes


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


class PageWidget(anywidget.AnyWidget):
    """What every widget has: a description for the page, and a picture for pages without script."""

    spec = t.Dict(help="everything that stays as it is", read_only=True).tag(sync=True)
    still = Still(help="the starting state as a picture", read_only=True).tag(sync=True)
    still_alt = t.Unicode(read_only=True).tag(sync=True)

    _parameters = ()  # traits that a reader sets

    def __repr__(self):
        values = (f"{name}={getattr(self, name)!r}" for name in self._parameters)
        return f"{type(self).__name__}({', '.join(values)})"

    def _keep(self, **values):
        """Set traits that are read-only for others."""
        for name, value in values.items():
            self.set_trait(name, value)

    def _repr_html_(self) -> str | None:
        """The still picture, for viewers that show no widget."""
        if self.still:
            return f'<img src="{self.still}" alt="{escape(self.still_alt)}">'
        return None


class CurveWidget(PageWidget):
    """Curves of a function of a few parameters, with a control for each.

    Every parameter is a trait of its own name, to set, observe and link. With a kernel the curves
    are the function's own. A built page has a table of them at every setting of the parameters'
    grids, over which the sliders step; or its script computes them, see `Live`.

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
    presets : Presets, optional
        Buttons that set several parameters at once.
    live : Live, optional
        Which curves the page's script computes. The kernel is then not asked for curves; it sees
        the parameters, and Python code may set them. The function's curves may end in NaN.

    Raises
    ------
    ValueError
        If arguments do not fit together, or if the table needs more than 500 kB.
    """

    _esm = bundle("curves.js")
    _css = styles()

    baked = t.Bytes(help="the curves at every setting", read_only=True).tag(sync=True)
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
        presets: Presets | None = None,
        live: Live | None = None,
    ):
        if not callable(function):
            raise TypeError(f"function must be callable, got {function!r}")
        self._function, self._parameters = function, {p.name: p for p in parameters}
        self._panels, self._live = tuple(panels), live
        if len(self._parameters) != len(parameters) or not parameters:
            raise ValueError(f"parameters must have different names, got {len(parameters)}")
        for name in self._parameters:
            if hasattr(type(self), name):
                raise ValueError(f"name must not be an attribute of widgets, got {name!r}")
        if live and live.curves is None:
            self._table = ranged(function, parameters, live)
        else:
            self._table = tabled(function, parameters, live.curves if live else ())
        self._check_names(scalars, pad)
        self._code = code or default_code(type(self), self._parameters)
        start = evaluate(function, {p.name: p.value for p in parameters}, bool(live))
        self.add_traits(**{p.name: _Checked(p).tag(sync=True) for p in parameters})
        spec = {
            "key": key_of(type(self)),
            "title": title or "; ".join(p.y_label for p in self._panels),
            "note": note,
            "code": self._code,
            "presets": presets and presets.description(self._parameters),
            "parameters": [p.description() for p in parameters],
            "curves": [curve.description() for curve in self._table],
            "panels": [p.description() for p in self._panels],
            "scalars": [vars(s) for s in scalars],
            "pad": pad and pad.description(),
            "live": bool(live),
        }
        still = still_picture(start, self._panels, self._parameters, pad, alt)
        self._keep(spec=spec, baked=tobytes(self._table), still=still, still_alt=alt)
        super().__init__()
        self._compute()
        self.observe(self._on_change, [*self._parameters, "request"])

    @property
    def values(self) -> dict:
        """The parameters as they stand."""
        return {name: getattr(self, name) for name in self._parameters}

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """The function's exact result at the parameters as they stand."""
        return self.curves_at()

    @property
    def code(self) -> str:
        """Python code with the same result as the present state."""
        return filled(self._code, self.values)

    @property
    def baked_bytes(self) -> int:
        """Size of the table."""
        return len(self.baked)

    def curves_at(self, **values) -> dict[str, np.ndarray]:
        """The function's exact result; parameters that are not given stand as they are."""
        return evaluate(self._function, self._checked(values), bool(self._live))

    def at_grid(self, **values) -> dict[str, np.ndarray]:
        """What the table of a built page has at the nearest setting of the parameters' grids.

        Parameters that are not given stand as they are; curves that the page computes are left out.
        """
        checked = self._checked(values)
        places = [p.nearest(checked[name]) for name, p in self._parameters.items()]
        return {c.name: c.at(places) for c in self._table if c.steps is not None}

    def _checked(self, values) -> dict:
        """All parameters: those given, and the others as they stand."""
        unknown = ", ".join(name for name in values if name not in self._parameters)
        if unknown:
            raise TypeError(f"values must be among {', '.join(self._parameters)}, got {unknown}")
        given = {name: self._parameters[name].check(x) for name, x in values.items()}
        return {**self.values, **given}

    def _check_names(self, scalars, pad):
        lengths = {curve.name: curve.length for curve in self._table}
        used = {name for p in self._panels for name in p.curves}
        single = [s.name for s in scalars] + [name for p in self._panels for name in p.numbers]
        for name in [*used, *single, *(self._live.curves or () if self._live else ())]:
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
        if pad:
            in_range = [n for n, p in self._parameters.items() if isinstance(p, Parameter)]
            for name in (pad.x, pad.y):
                one_of("parameter of the pad", name, tuple(in_range))

    def _on_change(self, change):
        state = {"request": self.request, "values": list(self.values.values())}
        if {k: self.answer.get(k) for k in state} != state:
            self._compute()

    def _compute(self):
        """Put the exact curves, or the reason why there are none, before the page."""
        if self._live:  # the page computes
            return
        answer = {"request": self.request, "values": list(self.values.values())}
        exact = b""
        try:
            exact = np.concatenate(list(self.curves.values())).astype("<f4").tobytes()
        except Exception as error:  # shown in the figure: a comm's handler has no other reader
            answer["error"] = f"{type(error).__name__}: {error}"
        with self.hold_sync():
            self._keep(exact=exact, answer=answer)
