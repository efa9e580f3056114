"""A row of weights that folds into its parts, and a motion that tells what each of them answers."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.analysis import decompose
from ddlib.widgets.base import CurveWidget, Panel
from ddlib.widgets.hinton import CENTRE
from ddlib.widgets.parts.parameters import Choice, Parameter, Presets
from ddlib.widgets.scripts import bundle
from ddlib.widgets.table import Live

_HERE = Path(__file__).parent

_ANGLE, _SPEED, _ACCELERATION = 5.0, 50.0, 1000.0  # ends of the motion's sliders, degrees and s
_PARTS = ("constant", "even", "odd")


class FilterFold(CurveWidget):
    """Fold a row of weights into its constant, even and odd part; move a joint under each of them.

    Parameters
    ----------
    rows : mapping
        Label -> weight function ``(width,)`` per radian, oldest sample first; two or more, of one
        odd width.
    step : float
        Sampling period of the rows, s; `ddlib.simulation.LOG_STEP` of the book's recordings.
    """

    _esm = bundle(_HERE / "fold.js")

    folding = t.Dict(help="time of the samples, parts and axes of rows", read_only=True)
    folding.tag(sync=True)

    def __init__(self, rows: Mapping[str, np.ndarray], step: float):
        self._parts = {label: self._taken_apart(f) for label, f in rows.items()}
        labels = list(rows)
        half = len(rows[labels[0]]) // 2
        self._time = time = np.arange(-half, half + 1) * step
        whole = {"y_range": ("least weight", "most weight")}
        names, ends = [*_PARTS, "all"], ("least answer", "most answer")
        ms = 1e3 * time
        motion = ("angle", "speed", "acceleration")
        super().__init__(
            self._curves,
            [
                Choice("row", "Row", labels, labels[0]),
                Parameter("fold", "Fold", 0, 100, 50, "%"),
                Parameter("angle", "Angle", -_ANGLE, _ANGLE, _ANGLE, "°"),
                Parameter("speed", "Speed", -_SPEED, _SPEED, 0, "°/s"),
                Parameter("acceleration", "Acceleration", -_ACCELERATION, _ACCELERATION, 0,
                          "°/s²"),
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
            presets=Presets(
                {
                    "Stand still": {"angle": _ANGLE, "speed": 0, "acceleration": 0},
                    "Steady speed": {"angle": 0, "speed": _SPEED, "acceleration": 0},
                    "Speed up": {"angle": 0, "speed": 0, "acceleration": _ACCELERATION},
                },
                "Let the joint",
            ),
            live=Live(examples=[dict(zip(("row", "fold", *motion), x)) for x in product(
                labels, (0, 100), *((-x, x) for x in (_ANGLE, _SPEED, _ACCELERATION))
            )]),
        )  # fmt: skip
        folding = {
            label: {"parts": parts.tolist(), "ends": self._ends(parts)}
            for label, parts in self._parts.items()
        }
        self._keep(folding={"time": time.tolist(), "rows": folding})

    @staticmethod
    def _taken_apart(f) -> np.ndarray:
        """Constant, even and odd part of a row, ``(3, width)``."""
        parts = decompose(f)
        return np.stack([np.broadcast_to(parts.constant, f.shape), parts.even, parts.odd])

    def _window(self, angle, speed, acceleration) -> np.ndarray:
        """Angles in the window, degrees."""
        return angle + speed * self._time + acceleration * self._time**2 / 2

    def _ends(self, parts) -> dict[str, list[float]]:
        """Ends of the axes for a row's parts."""
        drawn = np.concatenate([parts.sum(0), parts.ravel()])
        room = 0.08 * np.ptp(drawn)
        most = 0.0
        for signs in np.eye(3):
            window = self._window(*(signs * (_ANGLE, _SPEED, _ACCELERATION)))
            answers = parts @ np.deg2rad(window)
            most = max(most, *np.abs(answers), abs(answers.sum()))
        return {
            "least weight": [float(drawn.min() - room)],
            "most weight": [float(drawn.max() + room)],
            "least answer": [float(-1.5 * 1.1 * most)],
            "most answer": [float(1.5 * 1.1 * most)],
        }

    def _curves(self, row, fold, angle, speed, acceleration) -> dict:
        parts = self._parts[row]
        window = self._window(angle, speed, acceleration)
        answers = parts @ np.deg2rad(window)
        return {
            "left": (1 - fold / 100) * parts.sum(0),
            **dict(zip(_PARTS, fold / 100 * parts)),
            "window": window,
            "answers": np.append(answers, answers.sum()),
            **self._ends(parts),
        }
