"""Widgets whose curves the page computes itself: no table, no grid, no interpolation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.parameters import Choice, Parameter


class _Computed:
    """What `ddlib.widgets._baking.baked.Baked` is for a widget without a table."""

    groups = ()

    def __init__(self, function, parameters, examples, ranges):
        self.function, self.parameters = function, tuple(parameters)
        start = {p.name: p.value for p in self.parameters}
        known = [self.interpolate(**{**start, **setting}) for setting in ({}, *examples)]
        self.lengths = {name: curve.size for name, curve in known[0].items()}
        ends = [[(np.nanmin(x), np.nanmax(x)) for x in curves.values()] for curves in known]
        self.low, self.high = np.nanmin(ends, 0)[:, 0], np.nanmax(ends, 0)[:, 1]
        for name, (low, high) in (ranges or {}).items():
            k = list(self.lengths).index(name)
            self.low[k], self.high[k] = low, high

    def interpolate(self, **values) -> dict[str, np.ndarray]:
        """The function's curves; nothing is interpolated."""
        return {name: np.atleast_1d(x) for name, x in self.function(**values).items()}

    def error(self, n=200, seed=0) -> float:
        """0: the page computes; how well, its tests say."""
        return 0.0

    def tobytes(self) -> bytes:
        """No table."""
        return b""

    def checksum(self) -> int:
        """Checksum of no table."""
        return 0


class LiveWidget(CurveWidget):
    """A `CurveWidget` whose script computes the curves: it sets ``live`` (static/curves.js).

    The kernel is not asked for curves; it sees the parameters, and Python code may set them.

    Parameters
    ----------
    function : callable
        The same in Python, for `curves`, for tests and for the still picture; its curves may end
        in NaN.
    parameters : sequence of Parameter or Choice
    panels : sequence of Panel
    examples : sequence of mappings
        Settings, each with the parameters that differ from the start. The ranges of the curves
        over them decide with how many decimals numbers are written.
    ranges : mapping, optional
        Curve -> its lowest and highest value, where they are known without examples.
    **options
        Passed on to `CurveWidget`.
    """

    def __init__(
        self,
        function,
        parameters: Sequence[Parameter | Choice],
        panels,
        *,
        examples: Sequence[Mapping] = (),
        ranges: Mapping | None = None,
        **options,
    ):
        self._known = examples, ranges
        super().__init__(function, parameters, panels, **options)

    @property
    def curves(self) -> dict[str, np.ndarray]:
        """The function's result at the parameters as they stand; NaN where a run was over."""
        return self._baked.interpolate(**self.values)

    def _first(self, values) -> dict:
        return self._baked.interpolate(**values)

    def _bake(self, function, parameters, *_):
        return _Computed(function, parameters, *self._known)

    def _spec(self, *given) -> dict:
        return {**super()._spec(*given), "live": True}

    def _compute(self):
        """The page does."""
