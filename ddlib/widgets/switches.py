"""Switches for what makes an arm real: each effect off, weak or strong, in every combination."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import traitlets as t

from ddlib._check import instance
from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import (
    CoulombFriction,
    DeadZone,
    Delay,
    Effects,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.figures import JOINTS
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP, Recording, follow
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.engine._plain import gains, plant
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live

_SHARE = np.array([1.0, 0.3])  # strength of an effect at shoulder and elbow, over the shoulder's

STRENGTHS = {
    "friction": {"off": 0.0, "assumed": 0.5, "strong": 2.0},  # Coulomb N m, viscous N m s/rad
    "dead_zone": {"off": 0.0, "weak": 0.1, "strong": 2.0},  # torque that the motor loses, N m
    "saturation": {"off": 1e9, "weak": 20.0, "strong": 15.0},  # largest torque of the motor, N m
    "quantisation": {"off": None, "assumed": 16, "strong": 14},  # bits of the encoders
    "delay": {"off": 0, "weak": 1, "strong": 10},  # control periods from a reading to its torque
}
"""Strengths of the effects by their names; at the shoulder."""

_STEPS = np.arange(round(3.5 / CONTROL_STEP) + 1)
_T = _STEPS * CONTROL_STEP
_WHOLE = _STEPS[::16]
_CLOSE = _STEPS[725:801]

_TIMES = _T[_WHOLE]  # of the whole motion, s: every 16th control period, not smoothed
_CLOSE_UP = _T[_CLOSE]  # of the close-up, s: every control period around the turn

# Axes of the charts: they stay, whatever is switched on. All combinations lie within.
_RANGES = {"error": (-10, 5), "torque": (-40, 20), "close-up": (-10, 15)}

_CODE = """\
from ddlib.widgets import RealArmSwitches

RealArmSwitches().curves_at(
    friction={friction}, dead_zone={dead_zone}, saturation={saturation},
    quantisation={quantisation}, delay={delay},
)"""


class RealArmSwitches(CurveWidget):
    """Switch friction, dead zone, saturation, quantisation and delay on and off.

    The arm follows trajectory 6 under the PD law of `STATE_FEEDBACK`, with the difference of two
    encoder readings as its velocity. The page computes every combination by the live engine. The
    charts show the shoulder; the elbow's effects have 0.3 times the strength
    of the shoulder's, as its gains have.

    Parameters
    ----------
    arm : Arm
        The arm that moves.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = bundle("switches.js")
    _css = styles("switches.css")

    loop = t.Dict(help="plant, gains, reference and strengths", read_only=True).tag(sync=True)

    def __init__(self, arm: Arm = CMU_DD_ARM_II, **options):
        instance("arm", arm, Arm)
        ideal = _shown(_ideal_recording(arm))
        super().__init__(
            lambda **levels: _curves(arm, **levels),
            _choices(),
            [
                _panel("Shoulder error, °", "error", _TIMES, ideal),
                _panel("Shoulder torque, N m", "torque", _TIMES, ideal),
                _panel("Torque around the turn, N m", "close-up", _CLOSE_UP, ideal),
            ],
            title="Real-arm switches",
            alt=(
                "Shoulder error and torque over trajectory 6, and the torque around the turn at "
                "1.5 s. The arm has friction and quantisation as assumed for the surrogate arm. "
                "Beside its curves are those of an ideal arm."
            ),
            scalars=[
                Scalar(f"{joint} {what}", f"{joint.title()} {what} deviation, RMS", unit, digits)
                for what, unit, digits in (("position", "°", 3), ("torque", "N m", 2))
                for joint in JOINTS
            ],
            code=_CODE,
            live=Live(),
            note=(
                "Strengths are those at the shoulder; at the elbow they are 0.3 times as large. "
                "Friction has a dry and a viscous part, which are equal at 1 rad/s."
            ),
            **options,
        )
        bits = STRENGTHS["quantisation"]
        steps = {key: Quantisation.encoder(n).step if n else 0 for key, n in bits.items()}
        loop = {
            "plant": plant(arm, Effects(friction=(CoulombFriction((0.0, 0.0)),))),
            "gains": gains(pd(KP, KD)),
            "share": _SHARE.tolist(),
            "levels": STRENGTHS | {"quantisation": steps},
            "extents": np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1]).tolist(),
            "motion": MOTION_SECONDS,
            "step": CONTROL_STEP,
            "periods": len(_T),
            "whole": 16,
            "close": [int(_CLOSE[0]), int(_CLOSE[-1]) + 1],
        }
        self._keep(loop=loop)


def _choices() -> list[Choice]:
    texts = {
        "friction": ("Friction", "{:g} N m"),
        "dead_zone": ("Dead zone", "{:g} N m"),
        "saturation": ("Torque limit", "±{:g} N m"),
        "quantisation": ("Encoder", "{} bits"),
        "delay": ("Delay", "{:g} ms"),
    }
    choices = []
    for name, (label, text) in texts.items():
        unit = 1e3 * CONTROL_STEP if name == "delay" else 1
        levels = {key: level and level * unit for key, level in STRENGTHS[name].items()}
        options = {key: text.format(level) for key, level in levels.items()}
        options |= {key: f"{options[key]}, as assumed" for key in options if key == "assumed"}
        start = "assumed" if "assumed" in options else "off"
        choices.append(Choice(name, label, options | {"off": "off"}, start))
    return choices


def _panel(title, what, times, ideal) -> Panel:
    lines = {"fixed": {"ideal": ideal[what]}, "y_range": _RANGES[what]}
    return Panel(title, {what: "real"}, "time, s", times, **lines)


def _effects(friction, dead_zone, saturation, quantisation, delay) -> Effects:
    """Effects of the named strengths."""
    lost, limit = STRENGTHS["dead_zone"][dead_zone], STRENGTHS["saturation"][saturation]
    slowing, bits = (
        STRENGTHS["friction"][friction] * _SHARE,
        STRENGTHS["quantisation"][quantisation],
    )
    late = STRENGTHS["delay"][delay]
    return Effects(
        friction=(ViscousFriction(slowing), CoulombFriction(slowing)),
        actuator=(Delay(late), DeadZone(lost * _SHARE), Saturation(limit * _SHARE)),
        encoder=(Quantisation.encoder(bits),) if bits else (),
    )


def _run(arm: Arm, effects: Effects) -> Recording:
    reference = Trajectory(*pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], _T))
    law = pd(KP, KD)
    return follow(arm, law, reference, _T, effects=effects, log_every=1, velocity="difference")


@lru_cache(maxsize=4)
def _ideal_recording(arm: Arm) -> Recording:
    return _run(arm, Effects())


def _shown(recording: Recording) -> dict[str, np.ndarray]:
    """The shoulder's curves."""
    error, torque = np.rad2deg(recording.tracking_error[:, 0]), recording.tau_true[:, 0]
    return {"error": error[_WHOLE], "torque": torque[_WHOLE], "close-up": torque[_CLOSE]}


@lru_cache(maxsize=64)
def _curves(arm: Arm, **levels) -> dict:
    """What the charts show, and how far position (degrees) and torque are from the ideal arm's."""
    real, ideal = _run(arm, _effects(**levels)), _ideal_recording(arm)
    curves = _shown(real)
    moving = _T < MOTION_SECONDS
    for what, gap in (
        ("position", np.rad2deg(real.q_true - ideal.q_true)),
        ("torque", real.tau_true - ideal.tau_true),
    ):
        rms = np.sqrt((gap[moving] ** 2).mean(0))
        curves |= {f"{joint} {what}": rms[j] for j, joint in enumerate(JOINTS)}
    return curves
