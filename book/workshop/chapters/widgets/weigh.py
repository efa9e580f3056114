"""The arm on the scales: the second moment of a gradient, added up sample by sample."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle
from workshop.chapters.widgets import CENTRE
from workshop.chapters.widgets.pencil import STYLE

_HERE = Path(__file__).parent

_ENTRIES = {
    "shoulder": (0, 0),
    "coupling": (0, 1),
    "elbow": (1, 1),
}  # of the mass matrix: torque, joint


class WeighTheArm(CurveWidget):
    """Widen the part of a window that counts, and watch its weighted area grow to an inertia.

    Parameters
    ----------
    gradients : mapping
        What was learnt -> mean gradient of the torques by the window, N m/rad, shape
        ``(torque, joint, samples)``.
    inertia : mapping
        The same names -> mean mass matrix that belongs to it, kg m², shape (2, 2).
    """

    _esm, _css = bundle(_HERE / "pencil.js", _HERE / "weigh.js"), STYLE

    def __init__(self, gradients: Mapping[str, np.ndarray], inertia: Mapping[str, np.ndarray]):
        names = list(gradients)
        width = np.shape(gradients[names[0]])[-1]
        self._gradients, self._inertia = gradients, inertia
        self._x = (np.arange(width) - width // 2) * LOG_STEP
        reaches = range(width // 2 + 1)
        time = 1e3 * self._x
        shade = {"cursor": ("first", "last")}
        super().__init__(
            self._curves,
            [
                Choice(
                    "reach", "Count samples up to",
                    {k: f"±{10 * k} ms" if k else "0 ms" for k in reaches}, 0, "slider",
                ),
                Choice("learnt", "Learnt", names, names[0]),
                Choice("entry", "Inertia of the", list(_ENTRIES), "shoulder"),
            ],
            [
                Panel(
                    "Gradient g, N m/rad", "gradient", CENTRE, time, kind="stems", y_fit=True,
                    **shade,
                ),
                Panel(
                    "½ x² g, kg m²", "parts", CENTRE, time, kind="bars",
                    y_fit=True, roles={"parts": "network"}, **shade,
                ),
                Panel(
                    "Sum so far, kg m²",
                    {"sum": "in the weights", "arm": "the arm itself"},
                    "samples up to ± ms", 10.0 * np.arange(width // 2 + 1),
                    cursor=("none", "place"), y_fit=True,
                ),
            ],
            alt="Stems: the gradient of the shoulder's torque by its window. Bars: how much "
            "each sample adds to its second moment. A line: the sum over more and more "
            "samples, beside the arm's own inertia.",
            title="Weigh the arm",
            scalars=[
                Scalar("now", "Sum", "kg m²", 2),
                Scalar("true", "The arm's own", "kg m²", 2),
            ],
            note="Each sample adds ½ x² g, and takes it away where g is negative. Shaded: the "
            "samples that are added up so far.",
        )  # fmt: skip

    def _curves(self, reach, learnt, entry) -> dict:
        at, half = _ENTRIES[entry], len(self._x) // 2
        g = self._gradients[learnt][at]
        parts = self._x**2 / 2 * g
        counted = (min(k, reach) for k in range(half + 1))  # none beyond the slider
        sums = np.array([parts[half - k : half + k + 1].sum() for k in counted])
        true, edge = self._inertia[learnt][at], (reach + 0.5) * LOG_STEP * 1e3
        return {
            "gradient": g, "parts": parts, "sum": sums, "arm": np.full(half + 1, true),
            "now": sums[reach], "true": true, "first": -edge, "last": edge,
            "none": 0.0, "place": 10.0 * reach,
        }  # fmt: skip
