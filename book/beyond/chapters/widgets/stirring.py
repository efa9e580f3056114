"""A widget for circles of the hand: place one in the workspace, see its torques and errors.

The study ``stirring`` has computed torques and errors on a grid of circles, `PLACES`; joint angles
are computed here.
"""

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
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live
from workshop.report import results

_HERE = Path(__file__).parent

_LINES = {
    "exact behind a window": "equations",
    "pick and place": "network of pick-and-place",
    "circles": "network of circles",
}  # by the study's name: whose torques are shown, and what the legend calls them

_BARS = {
    "none": "none",
    "exact behind a window": "exact",
    "pick and place": "pick",
    "circles": "circles",
    "both": "both",
}  # by the study's name: what gave the torques sent in advance, and what the bars call it
_DRAWN = (-0.35, -1.0, 0.95, 0.35)  # left, bottom, right, top of the pad, m from the shoulder
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
    sentence, and its curves are zero. `path` is the file that the study ``stirring`` writes.
    """

    _esm = bundle(_HERE / "stirring.js")
    _css = styles(_HERE / "stirring.css")

    workspace = t.Dict(help="lengths, reach, part that is drawn, m; times, s", read_only=True)
    workspace.tag(sync=True)

    def __init__(self, path: Path = results.FOLDER / "stirring-picker.npz", **options):
        with np.load(path) as arrays:
            names = arrays["names"].tolist()
            self._hand = dict(zip(names, arrays["hand"].astype(float)))
            # The first name, "none", has no torques; those of the last, "both", are not kept.
            self._torque = dict(zip(names[1:], arrays["torque"].astype(float)))
            self._reached = arrays["reached"]  # which circles the hand can follow
        # Every sample of the log whose number `SHOWN` divides
        times = np.arange(round(MOTION_SECONDS / LOG_STEP / SHOWN)) * LOG_STEP * SHOWN
        self._times = times
        seconds = "time, s"
        panels = [
            Panel("Joint angles, °", {f"{n} angle": n for n in JOINTS}, seconds, times, y_fit=True),
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
                _slider("distance", "Distance of the centre", " m"),
                _slider("bearing", "Direction of the centre", "°", 1),
                _slider("radius", "Radius", " m", 2),
                _slider("period", "Time of a turn", " s"),
                Choice("elbow", "Elbow angle", PLACES["elbow"], "negative"),
            ],
            panels,
            **{
                "alt": "Joint angles and torques of a circle of the hand over three seconds; "
                "below, bars with the error of the hand for five kinds of torques sent in advance.",
                "title": "A circle for the hand",
                "note": _NOTE,
                "live": Live([f"{joint} angle" for joint in JOINTS]),
                **options,
            },
        )
        workspace = {
            "lengths": list(map(float, _ARM.lengths)),
            "reach": list(reach(_ARM)),
            "box": list(_DRAWN),
            "times": times.tolist(),
        }
        self.set_trait("workspace", workspace)

    def _curves(self, **place) -> dict:
        """Curves of a circle, a value for each name in `PLACES`, by the panels' names for them."""
        index = tuple(PLACES[name].index(place[name]) for name in PLACES)
        angles = np.zeros((len(self._times), len(JOINTS)))
        if self._reached[index]:
            values = (place[name] for name in ("radius", "period", "distance", "bearing"))
            circle = Circles(*(np.array([x], float) for x in values), clockwise=np.array([False]))
            angles = np.rad2deg(stirred(_ARM, circle, self._times, place["elbow"]).q[0])
        return {
            **{f"{joint} angle": angles[:, j] for j, joint in enumerate(JOINTS)},
            **{
                f"{joint}, {line}": self._torque[line][index][:, j]
                for line in _LINES
                for j, joint in enumerate(JOINTS)
            },
            "hand": np.array([self._hand[name][index] for name in _BARS]),
        }


def _slider(name: str, label: str, unit: str, start: int = 2) -> Choice:
    """A slider over the values of `PLACES`; at first it has number `start` of them."""
    options = {value: f"{value}{unit}".replace("-", "−") for value in PLACES[name]}
    return Choice(name, label, options, PLACES[name][start], "slider")
