"""A row of weights that folds into its parts, and a motion that tells what each of them answers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ddlib._check import integer, number, shaped, told
from ddlib.analysis import decompose
from ddlib.widgets.base import CurveWidget, Panel
from ddlib.widgets.hinton import CENTRE
from ddlib.widgets.parts.parameters import Choice, Parameter

_ANGLE, _SPEED, _ACCELERATION = 5.0, 50.0, 1000.0  # ends of the motion's sliders, degrees and s
_PARTS = ("constant", "even", "odd")


class FilterFold(CurveWidget):
    """Fold a row of weights into its constant, even and odd part; move a joint under each of them.

    All curves are linear in the sliders, so that a built page shows them exactly.

    Parameters
    ----------
    rows : mapping
        Label -> weight function ``(width,)`` per radian, oldest sample first; two or more, of one
        odd width.
    step : float
        Sampling period of the rows, s; `ddlib.simulation.LOG_STEP` of the book's recordings.
    **options
        Passed on to `CurveWidget`.
    """

    def __init__(self, rows: Mapping[str, np.ndarray], step: float, **options):
        number("step", step, 0.0, open_low=True)
        if not isinstance(rows, Mapping) or len(rows) < 2:
            raise TypeError(f"rows must map two labels or more to weights, got {told(rows)}")
        some = shaped("rows", next(iter(rows.values())), "(width,)")
        integer("samples of rows", some.size, 3)
        self._rows = {str(label): shaped(f"rows[{label!r}]", f, some.shape)
                      for label, f in rows.items()}  # fmt: skip
        half = some.size // 2
        self._time = time = np.arange(-half, half + 1) * step
        self._parts = {label: self._taken_apart(f) for label, f in self._rows.items()}
        labels = list(self._rows)
        whole = {"y_range": ("least weight", "most weight")}
        names, ends = [*_PARTS, "all"], ("least answer", "most answer")
        ms = 1e3 * time
        motion = ("angle", "speed", "acceleration")
        super().__init__(
            self._curves,
            [
                Choice("row", "Row", labels, labels[0]),
                Parameter("fold", "Fold", 0, 100, 50, "%", 2),
                Parameter("angle", "Angle", -_ANGLE, _ANGLE, _ANGLE, "°", 2),
                Parameter("speed", "Speed", -_SPEED, _SPEED, 0, "°/s", 2),
                Parameter("acceleration", "Acceleration", -_ACCELERATION, _ACCELERATION, 0,
                          "°/s²", 2),
            ],
            [
                Panel("What remains of the row", {"left": "weights"}, CENTRE, ms, kind="stems",
                      **whole),
                Panel("Parts, folded out", ["even", "odd", "constant"], CENTRE, ms,
                      **whole),
                Panel("Angle in the window, °", {"window": "angle"}, CENTRE, ms,
                      y_range=(-20.0, 20.0)),
                Panel("What the unit gets from each part", {"answers": "answer"}, "part of the row",
                      np.arange(4), kind="bars", ticks=list(enumerate(names)), y_range=ends),
            ],
            title="Fold a row of weights",
            alt=(
                "The weights of one row as stems over the window, half folded out into a constant, "
                "an even and an odd part. Below, a joint at rest in the window. Bars: how much "
                "each part of the row adds to what the unit gets."
            ),
            depends={
                **dict.fromkeys(("left", *_PARTS), ("row", "fold")),
                **dict.fromkeys(("least weight", "most weight", *ends), ("row",)),
                "window": motion,
            },
            presets={
                "Stand still": {"angle": _ANGLE, "speed": 0, "acceleration": 0},
                "Steady speed": {"angle": 0, "speed": _SPEED, "acceleration": 0},
                "Speed up": {"angle": 0, "speed": 0, "acceleration": _ACCELERATION},
            },
            presets_title="Let the joint",
            **options,
        )  # fmt: skip

    @staticmethod
    def _taken_apart(f) -> np.ndarray:
        """Constant, even and odd part of a row, ``(3, width)``."""
        parts = decompose(f)
        return np.stack([np.broadcast_to(parts.constant, f.shape), parts.even, parts.odd])

    def _window(self, angle, speed, acceleration) -> np.ndarray:
        """Angles in the window, degrees."""
        return angle + speed * self._time + acceleration * self._time**2 / 2

    def _curves(self, row, fold, angle, speed, acceleration) -> dict:
        parts = self._parts[row]
        f = parts.sum(0)
        folded = fold / 100 * parts
        window = self._window(angle, speed, acceleration)
        answers = parts @ np.deg2rad(window)
        drawn = np.concatenate([f, parts.ravel()])
        room = 0.08 * np.ptp(drawn)
        ends = [self._window(*(s * top for s, top in zip(signs, (_ANGLE, _SPEED, _ACCELERATION))))
                for signs in np.eye(3)]  # fmt: skip
        most = 1.1 * np.abs([[*(parts @ np.deg2rad(q)), f @ np.deg2rad(q)] for q in ends]).max()
        return {
            "left": f - folded.sum(0),
            **dict(zip(_PARTS, folded)),
            "window": window,
            "answers": np.append(answers, answers.sum()),
            "least weight": drawn.min() - room,
            "most weight": drawn.max() + room,
            "least answer": -1.5 * most,
            "most answer": 1.5 * most,
        }
