"""The arm and the scales: a network's inertia, added up sample by sample, against the arm's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.analysis import mean_gradient
from ddlib.learning import TorqueModel
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from workshop.chapters.widgets import CENTRE
from workshop.report.pencil import moment_filters, written

_HERE = Path(__file__).parent


class WeighTheArm(CurveWidget):
    """Lay a network's gradient on the scales, sample by sample; then load the arm, and write.

    Of the network it is the inertia at the shoulder: half the second moment of the gradient of the
    shoulder's torque by the shoulder's window.

    Parameters
    ----------
    networks : mapping
        What was learnt -> one network.
    windows : array_like, shape (cases, joint, width)
        Positions over which the gradient is the mean, rad.
    own : float
        The arm's own inertia at the shoulder, kg m².
    inertia : callable
        Of a load in kg: what it adds to the mean mass matrix along the motion, kg m², (2, 2).
    """

    _esm = bundle(_HERE / "weigh.js")
    _css = styles(_HERE / "stage.css", _HERE / "balance.css", _HERE / "weigh.css")

    lengths = t.List(help="of the arm's links, m", read_only=True).tag(sync=True)

    def __init__(
        self,
        networks: Mapping[str, TorqueModel],
        windows,
        own: float,
        inertia: Callable[[float], np.ndarray],
    ):
        names, width = list(networks), windows.shape[-1]
        self._x = (np.arange(width) - width // 2) * LOG_STEP
        filters = moment_filters(width, LOG_STEP)

        @cache
        def extra(load: int) -> np.ndarray:
            change = np.zeros((2, 2, 3))
            change[..., 2] = inertia(load)
            return change

        @cache
        def gradient(learnt: str, load: int) -> np.ndarray:
            model = networks[learnt]
            if load:
                model = written(model, windows, extra(load), filters, rounds=2)
            return mean_gradient(model, windows)[0, 0]

        def curves(reach, load, pencil, learnt) -> dict:
            g = gradient(learnt, load if pencil else 0)
            parts = self._x**2 / 2 * g
            edge = (reach + 0.5) * LOG_STEP * 1e3
            counted = np.abs(np.arange(width) - width // 2) <= reach
            return {
                "gradient": g, "parts": parts, "sum": parts[counted].sum(),
                "own": own + extra(load)[0, 0, 2], "first": -edge, "last": edge,
            }  # fmt: skip

        shade = {"cursor": ("first", "last"), "roles": {"gradient": "network", "parts": "network"}}
        time = 1e3 * self._x
        super().__init__(
            curves,
            [
                Choice(
                    "reach", "Count samples up to",
                    {k: f"±{10 * k} ms" if k else "0 ms" for k in range(width // 2 + 1)},
                    0, "slider",
                ),
                Choice("load", "Load in the hand", {k: f"{k} kg" for k in range(6)}, 0, "slider"),
                Choice(
                    "pencil", "Write it into the weights",
                    {False: "no", True: "yes"}, False, "switch",
                ),
                Choice("learnt", "Learnt torques", names, names[0]),
            ],
            [
                Panel("Gradient g, N m/rad", "gradient", CENTRE, time, kind="stems", **shade),
                Panel("½ x² g, kg m²", "parts", CENTRE, time, kind="bars", **shade),
            ],
            alt="Stems: the gradient of the shoulder's torque by its window. Bars: how much each "
            "sample adds to the network's inertia. In the page, a balance holds their sum against "
            "the arm's own inertia.",
            title="Weigh the arm",
        )  # fmt: skip
        self._keep(lengths=list(JOINT_DAMPING.arm.lengths))
