"""The report's Figure 2-1 as a thing to switch: a model of the arm in front of its feedback."""

from __future__ import annotations

from functools import cache, lru_cache
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.control import Feedforward, proportional
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.figures import JOINTS
from ddlib.setups import (
    JOINT_DAMPING,
    JOINT_DAMPING_COULOMB,
    JOINT_DAMPING_KP as KP,
    JOINT_DAMPING_VISCOUS,
)
from ddlib.simulation import CONTROL_STEP, LOG_STEP, Recording, follow
from ddlib.trajectories import (
    APPENDIX_I,
    MOTION_SECONDS,
    Trajectory,
    pick_and_place,
    smooth_pick_and_place,
)
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.engine._plain import gains, plant
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_HERE = Path(__file__).parent

_ARM = JOINT_DAMPING.arm
_EXTENTS = APPENDIX_I[0]  # degrees: 45 and 45
_FRICTION = Effects(
    friction=(ViscousFriction(JOINT_DAMPING_VISCOUS), CoulombFriction(JOINT_DAMPING_COULOMB))
)
_EVERY = round(LOG_STEP / CONTROL_STEP)
_T = np.arange(round(MOTION_SECONDS / CONTROL_STEP)) * CONTROL_STEP
_TIMES = _T[::_EVERY]  # when the curves are sampled, s

_SWITCH = {False: "off", True: "on"}

_CODE = """\
from workshop.chapters.widgets.feedforward import FeedforwardSwitches

FeedforwardSwitches().curves_at(
    model={model}, masses={masses}, known={known}, feedback={feedback},
    friction={friction}, jump={jump},
)"""


class FeedforwardSwitches(CurveWidget):
    """Switch the model, its errors, the feedback and the friction of Figure 2-1 on and off.

    The arm goes out and back as far as trajectory 1, from rest to rest or with the jump of velocity
    of the report's motions, under the springs of `ddlib.setups.JOINT_DAMPING`; sensors are exact.
    The page computes every setting by the live engine.
    """

    _esm = bundle(_HERE / "feedforward.js")
    _css = styles(_HERE / "feedforward.css")

    loop = t.Dict(help="plant, gains and references", read_only=True).tag(sync=True)

    def __init__(self):
        super().__init__(
            _switched,
            [
                Choice("model", "Model of the arm", _SWITCH, False, "switch"),
                Parameter("masses", "Masses of the model", 0, 200, 100, "% of the arm's"),
                Choice("known", "The model knows friction", _SWITCH, False, "switch"),
                Choice("feedback", "Feedback", _SWITCH, True, "switch"),
                Choice("friction", "Friction in the joints", _SWITCH, True, "switch"),
                Choice("jump", "Start with a jump of velocity", _SWITCH, False, "switch"),
            ],
            [
                Panel(
                    "Shoulder error, °",
                    {"shoulder alone": "feedback alone", "shoulder error": "your setting"},
                    "time, s",
                    _TIMES,
                    y_fit=True,
                    roles={"feedback alone": "before", "your setting": "shoulder"},
                ),
                Panel(
                    "Shoulder torque, N m",
                    {"shoulder ahead": "by the model", "shoulder back": "by feedback"},
                    "time, s",
                    _TIMES,
                    y_fit=True,
                    roles={"by the model": "wanted", "by feedback": "measured"},
                ),
            ],
            live=Live(examples=[{"model": True}, {"feedback": False}]),
            title="Switch Figure 2-1 of the report",
            alt=(
                "Error and torque of the shoulder on a smooth motion with feedback alone. The "
                "error follows the motion, and all torque comes from feedback."
            ),
            scalars=[
                *(Scalar(f"{j} RMS", f"{j.title()} error, RMS", "°", 3) for j in JOINTS),
                Scalar("share", "Error of both joints, over feedback alone", "%", 1),
            ],
            code=_CODE,
            note="A thick arrow carries much of the shoulder's torque (root mean square).",
        )
        loop = {
            "plant": plant(_ARM, _FRICTION),
            "gains": gains(proportional(KP)),
            "extents": np.deg2rad(_EXTENTS).tolist(),
            "motion": MOTION_SECONDS,
            "step": CONTROL_STEP,
            "periods": len(_T),
            "every": _EVERY,
        }
        self._keep(loop=loop)


def _reference(jump: bool) -> Trajectory:
    shape = pick_and_place if jump else smooth_pick_and_place
    return Trajectory(*shape(_EXTENTS, _T))


def _driven(ahead, gain, friction: bool, reference: Trajectory) -> Recording:
    """The arm under the torques of a table, and springs."""
    law = Feedforward(lambda *motion: ahead, proportional(gain))
    effects = _FRICTION if friction else Effects()
    return follow(_ARM, law, reference, _T, effects=effects, log_every=_EVERY)


@cache
def _error_alone(friction: bool, jump: bool) -> np.ndarray:
    """Error with feedback alone, degrees."""
    reference = _reference(jump)
    return np.rad2deg(_driven(np.zeros_like(reference.q), KP, friction, reference).tracking_error)


@lru_cache(maxsize=32)
def _switched(model, masses, known, feedback, friction, jump) -> dict:
    """Curves and numbers of one setting, by ddlib's simulator: degrees, N m."""
    reference = _reference(jump)
    ahead = np.zeros_like(reference.q)
    if model:
        q, qd, qdd = reference
        ahead = (masses / 100) * _ARM.inverse_dynamics(q, qd, qdd)
        if known:
            ahead = ahead + _FRICTION.friction_torque(qd)
    run = _driven(ahead, KP if feedback else (0.0, 0.0), friction, reference)
    alone = _error_alone(friction, jump)
    error, ahead = np.rad2deg(run.tracking_error), ahead[::_EVERY]
    both = [np.sqrt((x**2).mean()) for x in (error, alone)]
    rows = {"share": 100 * both[0] / both[1]}
    for j, joint in enumerate(JOINTS):
        rows[f"{joint} RMS"] = np.sqrt((error[:, j] ** 2).mean())
    return {
        **rows,
        "shoulder error": error[:, 0],
        "shoulder alone": alone[:, 0],
        "shoulder ahead": ahead[:, 0],
        "shoulder back": run.tau_true[:, 0] - ahead[:, 0],
    }
