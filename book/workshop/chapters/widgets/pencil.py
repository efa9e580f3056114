"""Knob and pencil on a network's weights: turn up its parabolas, or write a load into its hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from ddlib.learning import TorqueModel
from ddlib.metrics import rmss
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter
from ddlib.widgets.scripts import bundle, styles
from workshop.chapters.widgets import CENTRE
from workshop.report.pencil import knobs, moment_filters, turned, written

_HERE = Path(__file__).parent
SCRIPT, STYLE = bundle(_HERE / "pencil.js"), styles(_HERE / "pencil.css")

_EVERY = 2  # samples of a torque: more are not seen
_JOINTS = ("shoulder", "elbow")


def _time(width: int) -> np.ndarray:
    """Times of a window's samples from its centre, ms."""
    return 1e3 * LOG_STEP * (np.arange(width) - width // 2)


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
                    _time(width),
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


class WriteTheLoad(CurveWidget):
    """Write a load into a network's direct weights, and compare its torque with the loaded arm's.

    Parameters
    ----------
    model : TorqueModel
        One network, trained without a load.
    training : array_like, shape (cases, joint, width)
        The windows that it was trained on, rad.
    motion : callable
        Of a load in kg: windows (cases, joint, width) of the loaded arm, and its torques
        (cases, joint).
    inertia : callable
        Of a load in kg: what it adds to the mean mass matrix along the motion, kg m², (2, 2).
    """

    _esm, _css = SCRIPT, STYLE

    def __init__(self, model: TorqueModel, training, motion: Callable, inertia: Callable):
        self._model, self._training = model, training
        self._motion, self._inertia = motion, inertia
        width, cases = training.shape[-1], len(motion(0.0)[0])
        t, lines = LOG_STEP * np.arange(cases)[::_EVERY], ("loaded", "trained", "written")
        legends = dict(zip(lines, ("the loaded arm", "as trained", "written")))
        pairs = [(a, b) for b in range(2) for a in range(2)]  # joint, torque
        trained = model.weights.direct_weights[0]
        rows = [
            Panel(
                f"{_JOINTS[a]} to {_JOINTS[b]}", {f"row_{a}_{b}": "written"}, CENTRE,
                _time(width), kind="stems", fixed={"as trained": trained[b, a]},
                roles={"written": "network", "as trained": "before"},
            )
            for a, b in pairs
        ]  # fmt: skip
        torque = Panel(
            "Shoulder torque, N m",
            legends,
            "time, s",
            t,
            roles=dict(zip(legends.values(), ("measured", "before", "network"))),
        )
        super().__init__(
            self._curves,
            [Parameter("load", "Kilograms in the hand", 0, 5, 3.0, "kg", grid=11)],
            [*rows, torque],
            alt="Four rows of direct weights, into which parabolas grow. Beside them the "
            "shoulder's torque over time: of the loaded arm, of the network as trained, and as "
            "written.",
            title="Write the load",
            scalars=[
                Scalar("as_trained", "RMSS as trained", digits=3),
                Scalar("as_written", "RMSS as written", digits=3),
                *(
                    Scalar(f"more_{a}_{b}", f"Written, {_JOINTS[a]} to {_JOINTS[b]}", "kg m²", 1)
                    for a, b in pairs
                ),
            ],
            note="Stems: direct weights as written. Line: as trained.",
        )

    def _curves(self, load) -> dict:
        windows, torque = self._motion(load)
        extra = self._inertia(load)
        change = np.zeros((2, 2, 3))
        change[..., 2] = extra
        filters = moment_filters(windows.shape[-1], LOG_STEP)
        model = written(self._model, self._training, change, filters)
        told = {"trained": self._model, "written": model}
        told = {name: of.torque(windows)[0] for name, of in told.items()} | {"loaded": torque}
        curves = {
            "as_trained": rmss(told["trained"], torque),
            "as_written": rmss(told["written"], torque),
        }
        curves |= {name: values[::_EVERY, 0] for name, values in told.items()}
        for j, i in np.ndindex(2, 2):
            curves[f"row_{i}_{j}"] = model.weights.direct_weights[0, j, i]
            curves[f"more_{i}_{j}"] = extra[j, i]
        return curves
