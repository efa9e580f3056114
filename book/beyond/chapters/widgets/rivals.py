"""All rivals on every trajectory of the square: torques of one, errors of all."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ddlib.figures import JOINTS
from ddlib.metrics import rmss
from ddlib.trajectories import MAX_EXTENT_DEG, MOTION_SECONDS
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from workshop.report import results

_MEASURED = "measured"

_NOTE = (
    "Each rival sees measured positions, learnt from the five training recordings, and has the "
    "size within the stored numbers of the network of 1988, or its smallest. RMSS: root mean "
    "square error over the standard deviation of all measured torques of the square."
)


class RivalPicker(CurveWidget):
    """Pick a trajectory and a rival; see its torque there, and the errors of all rivals.

    `path` holds what the study ``rivals`` kept: names, and torques ``(names, runs, samples, 2)``,
    the measured ones first.
    """

    def __init__(
        self,
        path: Path = results.FOLDER / "rivals-torques.npz",
        rival: str = "linear filter",
        **options,
    ):
        with np.load(path) as arrays:
            names, torque = arrays["names"].tolist(), arrays["torque"].astype(float)
        self._torque = dict(zip(names, torque))
        self._reference = results.read("rivals")["reference"]
        self._side = round(torque.shape[1] ** 0.5)  # trajectories in a row of the square
        rivals = [name for name in names if name != _MEASURED]
        measured = self._torque[_MEASURED]
        scale = measured.reshape(-1, len(JOINTS)).std(0)
        self._errors = np.stack([rmss(self._torque[n], measured, scale=scale) for n in rivals], -1)
        times = np.arange(torque.shape[2]) * MOTION_SECONDS / torque.shape[2]
        labels = {name: f"{k}: {name}" for k, name in enumerate(rivals, 1)}
        steps = range(1, self._side + 1)
        extents = {k: f"{MAX_EXTENT_DEG * k / self._side:g}°" for k in steps}
        lines = (_MEASURED, self._reference, "rival")
        panels = [
            *(
                Panel(
                    f"{joint.title()} torque, N m",
                    {f"{joint}, {line}": line for line in lines},
                    "time, s",
                    times,
                    y_fit=True,
                )
                for joint in JOINTS
            ),
            Panel(
                "RMSS of all rivals",
                {"errors": "RMSS"},
                "rival, number in the menu",
                np.arange(1, len(rivals) + 1),
                kind="bars",
                ticks=[(k, str(k)) for k in range(1, len(rivals) + 1, 2)],
                y_fit=True,
            ),
        ]
        super().__init__(
            self._curves,
            [
                Choice("shoulder", "Shoulder extent", extents, 7, "slider"),
                Choice("elbow", "Elbow extent", extents, 7, "slider"),
                Choice("rival", "Rival", labels, rival),
            ],
            panels,
            **{
                "alt": "Torques of both joints over time: measured, by the "
                f"{self._reference} and by "
                f"the {rival}; below, bars with the errors of {len(rivals)} rivals.",
                "title": "Picker of rivals",
                "note": _NOTE,
                **options,
            },
        )

    def _curves(self, shoulder, elbow, rival) -> dict:
        run = (shoulder - 1) * self._side + elbow - 1
        lines = {_MEASURED: _MEASURED, self._reference: self._reference, "rival": rival}
        curves = {
            f"{joint}, {line}": self._torque[name][run, :, j]
            for line, name in lines.items()
            for j, joint in enumerate(JOINTS)
        }
        return {**curves, "errors": self._errors[run]}
