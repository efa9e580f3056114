"""A knob on a network's weights: turn up its parabolas, and ask whether its arm gets heavier."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ddlib.learning import TorqueModel
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter
from ddlib.widgets.scripts import bundle, styles
from workshop.chapters.widgets import CENTRE
from workshop.report.pencil import knobs, turned

_HERE = Path(__file__).parent
SCRIPT, STYLE = bundle(_HERE / "knob.js"), styles(_HERE / "knob.css")
_EVERY = 2  # samples of a torque: more are not seen
_JOINTS = ("shoulder", "elbow")


class TurnTheParabola(CurveWidget):
    """Multiply the parabola in every row of a network, and ask whether its arm gets heavier.

    Parameters
    ----------
    networks : mapping
        What was learnt -> one network.
    windows : array_like, shape (cases, joint, width)
        Positions of a motion, rad.
    inertial : array_like, shape (cases, joint)
        Torque that the arm's inertia takes along this motion, N m.
    """

    _esm, _css = SCRIPT, STYLE

    def __init__(self, networks: Mapping[str, TorqueModel], windows, inertial):
        self._networks, self._windows, self._inertial = networks, windows, inertial
        names, width = list(networks), windows.shape[-1]
        self._knob = [rows[2] for rows in knobs(width)["shape"]]
        t = LOG_STEP * np.arange(len(windows))[::_EVERY]
        lines = {"needed": "what a heavier arm needs", "extra": "what the network adds"}
        torques = [
            Panel(
                f"{joint.capitalize()} torque, N m",
                {f"{name}_{joint}": legend for name, legend in lines.items()},
                "time, s",
                t,
                roles={lines["needed"]: "wanted"},
            )
            for joint in _JOINTS
        ]
        super().__init__(
            self._curves,
            [
                Parameter("factor", "Parabola in every row, times", 0.5, 1.5, 1.0),
                Choice("learnt", "Learnt", names, names[0]),
            ],
            [
                Panel(
                    "A direct row",
                    "row",
                    CENTRE,
                    1e3 * LOG_STEP * (np.arange(width) - width // 2),
                    kind="stems",
                    y_range=("lowest", "highest"),
                    roles={"row": "network"},
                ),
                *torques,
            ],
            alt="Stems: a row of weights, its parabola turned up. Two panels with torques over "
            "time: what an arm of more inertia would need, and what the network adds.",
            title="Turn the parabola",
            scalars=[
                Scalar("share", "The network adds, of what a heavier arm needs", digits=2),
            ],
            note="With factor 1 the share is that of a very small turn.",
        )

    def _curves(self, factor, learnt) -> dict:
        model = self._networks[learnt]
        before, change = model.torque(self._windows)[0], factor - 1
        after = turned(model, self._knob, factor)
        extra = after.torque(self._windows)[0] - before
        small = turned(model, self._knob, 1 + (change or 1e-3)).torque(self._windows)[0] - before
        needed = (change or 1e-3) * self._inertial
        most = np.abs([turned(model, self._knob, x).weights.direct_weights[0, 0, 0]
                       for x in (0.5, 1.5)]).max()  # fmt: skip
        curves = {
            "lowest": -1.1 * most,
            "highest": 1.1 * most,
            "row": after.weights.direct_weights[0, 0, 0],
            "share": (small * needed).sum() / (needed**2).sum(),
        }
        for j, joint in enumerate(_JOINTS):
            curves[f"needed_{joint}"] = change * self._inertial[::_EVERY, j]
            curves[f"extra_{joint}"] = extra[::_EVERY, j]
        return curves
