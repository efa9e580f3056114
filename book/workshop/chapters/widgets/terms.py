"""An arm along a motion, its torque by origin: guess the largest term, then double the speed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.dynamics import with_load
from ddlib.effects import Effects
from ddlib.figures import JOINTS
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, pick_and_place
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.engine._plain import plant
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_HERE = Path(__file__).parent

_TERMS = ("centrifugal", "coupling", "Coriolis", "inertial")  # in no order that gives one away
_SUM = "actuation"
_FRICTION = "friction"
_BEFORE = "at single speed"  # the actuation torque, for comparison
_DONE = np.arange(100) + 0.5  # parts of the motion at which the curves are sampled, %
_LOADS = (0, 5, 10)  # kg in the hand

_CODE = """\
import numpy as np

from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.trajectories import APPENDIX_I, pick_and_place

seconds = 1.5 if {doubled} else 3.0
time = seconds * (np.arange(100) + 0.5) / 100
motion = pick_and_place(APPENDIX_I[{motion} - 1], time, seconds)
terms = with_load(CMU_DD_ARM_II, {load}).torque_terms(*motion)
{name: np.sqrt((term**2).mean(0)) for name, term in terms.items()}"""


class TorqueTerms(CurveWidget):
    """The arm along a motion of Appendix I, and the torque of each joint by its origin.

    The curves have letters until the reader has guessed which term is the elbow's largest. The
    page computes all of it by the live engine. The motion is the reference itself: no controller.
    """

    _esm = bundle(_HERE / "terms.js")
    _css = styles(_HERE / "stage.css", _HERE / "terms.css")

    moving = t.Dict(help="arms by load, friction, extents in rad", read_only=True).tag(sync=True)

    def __init__(self):
        self._arms = {load: with_load(JOINT_DAMPING.arm, load) for load in _LOADS}
        self._effects = Effects(friction=JOINT_DAMPING.effects.friction)
        motions = {
            k: f"{k}: {first:g}°, {second:g}°"
            for k, (first, second) in enumerate(APPENDIX_I.tolist(), 1)
        }
        fast, slow = (f"{MOTION_SECONDS / speed:g} s" for speed in (2, 1))
        names = [_SUM, *_TERMS, _FRICTION]
        super().__init__(
            self._curves,
            [
                Choice("motion", "Motion: shoulder, elbow", motions, 1),
                Choice("load", "Load", {x: f"{x} kg" for x in _LOADS}, 0),
                Choice("doubled", "Double the speed", {False: slow, True: fast}, False, "switch"),
                Choice("friction", "Friction", {False: "off", True: "on"}, False, "switch"),
            ],
            [
                Panel(
                    f"Torque at the {joint}, N m",
                    {f"{joint} {name}": name for name in (*names, _BEFORE)},
                    "part of the motion, %",
                    _DONE,
                    y_fit=True,
                    roles={_FRICTION: "odd", _BEFORE: "before"},
                )
                for joint in JOINTS
            ],
            title="The arm and its torque",
            alt=(
                "Torque of shoulder and elbow along trajectory 1 by origin: inertial, coupling, "
                "centrifugal and Coriolis torque, and their sum. At the shoulder the inertial "
                "torque is the largest, at the elbow the coupling torque."
            ),
            scalars=[
                Scalar(f"{joint} ratio", f"Speed over acceleration terms, {joint}", "%", 1)
                for joint in JOINTS
            ],
            live=Live(
                examples=[
                    {"doubled": True, "load": max(_LOADS)},
                    {"doubled": True, "friction": True},
                ]
            ),
            code=_CODE,
        )
        given = plant(JOINT_DAMPING.arm, self._effects)
        self._keep(
            moving={
                "arms": {x: plant(arm, Effects())["arm"] for x, arm in self._arms.items()},
                **{name: given[name] for name in ("viscous", "coulomb", "smoothing", "lengths")},
                "extents": np.deg2rad(APPENDIX_I).tolist(),
                "seconds": MOTION_SECONDS,
                "terms": names,
            }
        )

    def _parts(self, motion, load, doubled, friction) -> dict[str, np.ndarray]:
        """The terms and their sum along a motion, each ``(samples, 2)`` in N m."""
        seconds = MOTION_SECONDS / (2 if doubled else 1)
        state = pick_and_place(APPENDIX_I[motion - 1], seconds * _DONE / 100, seconds)
        parts = self._arms[load].torque_terms(*state)
        parts["Coriolis"] = parts.pop("coriolis")
        rubbing = self._effects.friction_torque(state.qd) if friction else 0 * state.qd
        return {_SUM: sum(parts.values()) + rubbing, **parts, _FRICTION: rubbing}

    def _curves(self, motion, load, doubled, friction) -> dict:
        parts = self._parts(motion, load, doubled, friction)
        del parts["gravity"]
        speed = parts["centrifugal"] + parts["Coriolis"]
        acceleration = parts["inertial"] + parts["coupling"]
        ratio = 100 * np.linalg.norm(speed, axis=0) / np.linalg.norm(acceleration, axis=0)
        parts[_BEFORE] = self._parts(motion, load, False, friction)[_SUM]
        curves = {}
        for j, joint in enumerate(JOINTS):
            curves |= {f"{joint} {name}": part[:, j] for name, part in parts.items()}
            curves[f"{joint} ratio"] = ratio[j]
        return curves
