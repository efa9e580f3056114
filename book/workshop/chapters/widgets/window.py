"""A window that slides along a recording, and the torque in its middle (section 3)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.figures import JOINTS
from ddlib.learning import sliding_windows
from ddlib.simulation import Recording
from ddlib.widgets.base import CurveWidget, Panel
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_HERE = Path(__file__).parent


class HiddenTorque(CurveWidget):
    """Slide a window along a motion, and guess the torque in its middle before it is seen.

    The torque is covered from the window's first sample on.

    Parameters
    ----------
    recording : Recording
        One run, with rests long enough for the window.
    width : int
        Samples of the window, odd.
    """

    _esm = bundle(_HERE / "hidden.js")
    _css = styles(_HERE / "hidden.css")

    recorded = t.Bytes(help="positions with half a window on either side, torques", read_only=True)
    recorded.tag(sync=True)

    def __init__(self, recording: Recording, width: int = 21):
        self._step = recording.step
        self._half, self._time = width // 2, recording.t[recording.motion]
        self._windows = np.degrees(sliding_windows(recording.q, width, recording.motion))
        self._torque = recording.tau[recording.motion]
        start = {"joint": JOINTS[0], "sample": len(self._time) // 5, "shown": False}
        around = np.arange(-self._half, self._half + 1) * self._step * 1e3
        span = {"x_label": "time, s", "x": self._time, "cursor": ("from", "to")}
        inside = {"inside": "position", "chord": "straight across"}
        super().__init__(
            self._curves,
            [
                Choice("joint", "Joint", JOINTS, start["joint"]),
                Choice(
                    "sample",
                    "Middle of the window",
                    {k: f"{x:.2f} s" for k, x in enumerate(self._time)},
                    start["sample"],
                    display="slider",
                ),
                Choice("shown", "Uncover the torque", {False: "off", True: "on"}, False, "switch"),
            ],
            [
                Panel("Position, °", {"position": "position"}, **span, y_fit=True),
                Panel(
                    "In the window, °",
                    inside,
                    "time from its middle, ms",
                    around,
                    y_fit=True,
                    roles={"straight across": "before"},
                ),
                Panel("Torque, N m", {"torque": "torque"}, **span, y_range=("low", "high")),
            ],
            title="Hidden torque",
            alt=(
                "Position of a joint over the motion, with a window shaded; the positions in the "
                "window beside the straight line between its ends; the torque up to the window, "
                "covered from there on."
            ),
            live=Live(
                examples=[
                    {"joint": joint, "sample": k, "shown": True}
                    for joint in JOINTS
                    for k in (0, len(self._time) - 1)
                ]
            ),
        )
        motion, half = recording.motion, self._half
        parts = recording.q[motion.start - half : motion.stop + half].T.ravel(), self._torque.T
        self._keep(recorded=np.concatenate([x.ravel() for x in parts]).astype("<f8").tobytes())

    def _curves(self, joint, sample, shown) -> dict:
        j, time = JOINTS.index(joint), self._time
        inside = self._windows[sample, j]
        torque = self._torque[:, j].copy()
        most = 1.1 * np.abs(torque).max()
        if not shown:
            torque[max(1, sample - self._half + 1) :] = np.nan
        reach = (self._half + 0.5) * self._step
        ends = np.clip([time[sample] - reach, time[sample] + reach], time[0], time[-1])
        return {
            "position": self._windows[:, j, self._half],
            "inside": inside,
            "chord": np.linspace(inside[0], inside[-1], len(inside)),
            "torque": torque,
            **{"low": -most, "high": most, "from": ends[0], "to": ends[1]},
        }
