"""Circles of the hand: place one in the workspace, see motion, torques and errors of the hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import traitlets as t

from beyond.studies.loop.motions import Circles, stirred
from beyond.studies.loop.stirring import PLACES, SHOWN
from ddlib.dynamics import reach
from ddlib.figures import JOINTS
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import MOTION_SECONDS
from ddlib.widgets.base import SCRIPT, STYLE, CurveWidget, module
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from workshop.report import results

_HERE = Path(__file__).parent

_LINES = {
    "exact behind a window": "equations",
    "pick and place": "network of pick-and-place",
    "circles": "network of circles",
}  # whose torques are shown, and what the legend calls them

_BARS = {
    "none": "none",
    "exact behind a window": "exact",
    "pick and place": "pick",
    "circles": "circles",
    "both": "both",
}  # what stood in the box "inverse arm", and what the bars call it
_BOX = (-0.35, -1.0, 0.95, 0.35)  # what is drawn: left, bottom, right, top, m from the shoulder
_ARM = JOINT_DAMPING.arm

_NOTE = (
    "The bars show how far off the hand is (RMS over three seconds, mm). Each bar is for other "
    "torques sent in advance: none, those of the arm's exact equations, or those of a network that "
    "learnt pick-and-place, circles or both (the median of ten, trained by the book's solver). The "
    "hand starts at the far point and goes round counter-clockwise; a controller corrects it."
)


class StirringPicker(CurveWidget):
    """Drag a circle through the workspace; see joint angles, torques, and the hand's errors.

    A circle that the hand cannot follow, or only with the arm stretched, is refused with a
    sentence. Its curves are zero. `path` holds what the study ``stirring`` kept.
    """

    _esm = module(*SCRIPT, _HERE / "stirring.js")
    _css = module(*STYLE, _HERE / "stirring.css")

    workspace = t.Dict(help="lengths, reach and part that is drawn, m", read_only=True)
    workspace.tag(sync=True)

    def __init__(self, path: Path = results.FOLDER / "stirring-picker.npz", **options):
        with np.load(path) as arrays:
            names = arrays["names"].tolist()
            self._hand = dict(zip(names, arrays["hand"].astype(float)))
            self._torque = dict(zip(names[1:], arrays["torque"].astype(float)))
            self._reached = arrays["reached"]
        times = np.arange(round(MOTION_SECONDS / LOG_STEP / SHOWN)) * LOG_STEP * SHOWN
        self._times = times
        seconds = "time, s"
        panels = [
            Panel("Joint angles, °", {f"{j} angle": j for j in JOINTS}, seconds, times, y_fit=True),
            *(
                Panel(
                    f"{joint.title()} torque, N m",
                    {f"{joint}, {line}": label for line, label in _LINES.items()},
                    seconds,
                    times,
                    y_fit=True,
                )
                for joint in JOINTS
            ),
            Panel(
                "Error of the hand, mm",
                {"hand": "RMS over the motion"},
                "torques sent in advance",
                np.arange(len(_BARS)),
                kind="bars",
                ticks=list(enumerate(_BARS.values())),
                y_fit=True,
            ),
        ]
        super().__init__(
            self._curves,
            [
                _steps("distance", "Distance of the centre", " m"),
                _steps("bearing", "Direction of the centre", "°", 1),
                _steps("radius", "Radius", " m", 2),
                _steps("period", "Time of a turn", " s"),
                Choice("elbow", "Elbow angle", PLACES["elbow"], "negative"),
            ],
            panels,
            **{
                "alt": "Joint angles and torques of a circle of the hand over three seconds; "
                "below, bars with the error of the hand for five kinds of torques sent in advance.",
                "title": "A circle for the hand",
                "note": _NOTE,
                **options,
            },
        )
        lengths, limits = map(float, _ARM.lengths), list(reach(_ARM))
        space = {"lengths": list(lengths), "reach": limits, "box": list(_BOX)}
        self.set_trait("workspace", space)

    def _curves(self, **place) -> dict:
        at = tuple(PLACES[name].index(place[name]) for name in PLACES)
        angles = np.zeros((len(self._times), len(JOINTS)))
        if self._reached[at]:
            values = (place[n] for n in ("radius", "period", "distance", "bearing"))
            circle = Circles(*(np.array([v], float) for v in values), np.array([False]))
            angles = np.rad2deg(stirred(_ARM, circle, self._times, place["elbow"]).q[0])
        return {
            **{f"{joint} angle": angles[:, j] for j, joint in enumerate(JOINTS)},
            **{
                f"{joint}, {line}": self._torque[line][at][:, j]
                for line in _LINES
                for j, joint in enumerate(JOINTS)
            },
            "hand": np.array([self._hand[name][at] for name in _BARS]),
        }


def _steps(name: str, label: str, unit: str, start: int = 2) -> Choice:
    options = {value: f"{value}{unit}".replace("-", "−") for value in PLACES[name]}
    return Choice(name, label, options, PLACES[name][start], "slider")
