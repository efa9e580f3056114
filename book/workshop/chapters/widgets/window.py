"""A window that slides along a recording: what is in it, what a network does (section 3)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.learning import TorqueModel, sliding_windows
from ddlib.simulation import Recording
from ddlib.widgets.base import CurveWidget, Panel, Scalar
from ddlib.widgets.engine._plain import networks
from ddlib.widgets.hinton import JOINTS, _check_models, common_step, width_choice
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_HERE = Path(__file__).parent


class SlidingWindow(CurveWidget):
    """Slide the window along a motion: inputs, activities and torque at every sample.

    The page has the recording and the weights; the live engine computes what the networks make
    of it.

    Parameters
    ----------
    models : mapping
        Window size -> `TorqueModel` of one network; two sizes or more.
    recording : Recording
        One run, with rests long enough for the largest window.
    first : int, optional
        The window size that is shown first. Default: the middle one.
    """

    _esm = bundle(_HERE / "window.js")

    layouts = t.List(help="the networks' layouts and scalings", read_only=True).tag(sync=True)
    weights = t.Bytes(help="the networks' weights as float32", read_only=True).tag(sync=True)
    recorded = t.Bytes(help="positions with half a window on either side, torques", read_only=True)
    recorded.tag(sync=True)

    def __init__(
        self,
        models: Mapping[int, TorqueModel],
        recording: Recording,
        first: int | None = None,
    ):
        if recording.q.ndim != 2:
            raise ValueError(f"recording must be one run, got shape {recording.q.shape}")
        models = _check_models(models, 0)
        self._step = common_step(models.values(), recording.step)
        self._measured = recording.tau[recording.motion]
        reach = max(models) // 2
        self._time = recording.t[recording.motion]
        self._seen, self._activity, self._torque = {}, {}, {}
        around = sliding_windows(recording.q, 2 * reach + 1, recording.motion)
        for width, model in models.items():
            windows = sliding_windows(recording.q, width, recording.motion)
            self._seen[width] = model.inputs.scale(around, joint_axis=-2)
            self._activity[width] = np.hstack(model.weights.activity(model.scaled(windows)))
            self._torque[width] = model.torque(windows)
        hidden = self._activity[max(models)].shape[-1] - len(JOINTS)
        units = [*map(str, range(1, hidden + 1)), *(joint[0] for joint in JOINTS)]
        centre = np.arange(-reach, reach + 1) * self._step * 1e3
        super().__init__(
            self._curves,
            [
                width_choice(models, first),
                Choice(
                    "sample",
                    "Centre of the window",
                    {k: f"{x:.2f} s" for k, x in enumerate(self._time)},
                    len(self._time) // 4,
                    display="slider",
                ),
            ],
            [
                Panel(
                    "Positions, scaled",
                    {f"{joint} position": joint for joint in JOINTS},
                    "time from the window's centre, ms",
                    centre,
                    cursor=("first", "last"),
                ),
                Panel(
                    "Activities",
                    "activity",
                    "hidden units, outputs s and e",
                    np.arange(len(units)),
                    kind="bars",
                    ticks=list(enumerate(units)),
                    y_range=(0.0, 1.0),
                    roles={"activity": "network"},
                ),
                *(
                    Panel(
                        f"{joint.title()} torque, N m",
                        {f"{joint} torque": "network"},
                        "time, s",
                        self._time,
                        fixed={"measured": self._measured[:, j]},
                        cursor=("from", "to"),
                    )
                    for j, joint in enumerate(JOINTS)
                ),
            ],
            title="Sliding window",
            alt=(
                "Torques of a network and measured torques over the motion, with the window "
                "shaded; the scaled positions in the window, and the activities of the hidden "
                "and output units."
            ),
            scalars=[
                Scalar(f"{joint} {what}", f"{joint.title()} torque, {what}", "N m")
                for joint in JOINTS
                for what in ("network", "measured")
            ],
            live=Live(ranges=self._ranges()),
        )
        layouts, weights = networks(models.values())
        whole = slice(recording.motion.start - reach, recording.motion.stop + reach)
        parts = recording.q[whole].T.ravel(), self._measured.T.ravel()
        recorded = np.concatenate(parts).astype("<f8").tobytes()
        self._keep(layouts=layouts, weights=weights, recorded=recorded)

    def _ranges(self) -> dict:
        """Lowest and highest value of the curves over all widths and samples."""
        seen, torque = (np.concatenate(list(x.values())) for x in (self._seen, self._torque))
        ranges = {"activity": np.concatenate([x.ravel() for x in self._activity.values()])}
        for j, joint in enumerate(JOINTS):
            ranges |= {f"{joint} position": seen[:, j], f"{joint} measured": self._measured[:, j]}
            ranges |= dict.fromkeys((f"{joint} torque", f"{joint} network"), torque[:, j])
        return {name: (x.min(), x.max()) for name, x in ranges.items()}

    def _curves(self, width, sample) -> dict:
        half = (width // 2 + 0.5) * self._step
        torque, now = self._torque[width], self._time[sample]
        curves = {"activity": self._activity[width][sample]}
        for j, joint in enumerate(JOINTS):
            curves[f"{joint} torque"] = torque[:, j]
            curves[f"{joint} position"] = self._seen[width][sample, j]
            curves[f"{joint} network"] = torque[sample, j]
            curves[f"{joint} measured"] = self._measured[sample, j]
        ends = np.clip([now - half, now + half], self._time[0], self._time[-1])
        return {
            **curves,
            **dict(zip(("from", "to"), ends)),
            "first": -1e3 * half,
            "last": 1e3 * half,
        }


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
