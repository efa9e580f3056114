"""Switches for what makes an arm real: each effect off, weak or strong, in every combination."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import traitlets as t

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
    started,
)
from ddlib.experiments import KD, KP
from ddlib.paper import TEST_TRAJECTORY
from ddlib.simulation import CONTROL_STEP, Recording, follow
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.widgets.base import SCRIPT, STYLE, module
from ddlib.widgets.engine.live import LiveWidget
from ddlib.widgets.engine.loops import LOOPS
from ddlib.widgets.engine.plain import ENGINE, gains, lean, plant
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice

JOINTS = ("shoulder", "elbow")

SHARE = np.array([1.0, 0.3])
"""Strength of an effect at the shoulder and at the elbow, relative to the shoulder."""

FRICTION = {"off": 0.0, "assumed": 0.5, "strong": 2.0}
"""Coulomb friction, N m, and viscous friction, N m s/rad, of the shoulder."""

DEAD_ZONE = {"off": 0.0, "weak": 0.1, "strong": 2.0}
"""Torque that the shoulder's motor loses, N m."""

SATURATION = {"off": 1e9, "weak": 20.0, "strong": 15.0}
"""Largest torque of the shoulder's motor, N m."""

QUANTISATION = {"off": None, "assumed": 16, "strong": 14}
"""Bits of the encoders."""

DELAY = {"off": 0, "weak": 1, "strong": 10}
"""Control periods between a reading and its torque."""

_STEPS = np.arange(round(3.5 / CONTROL_STEP) + 1)
_T = _STEPS * CONTROL_STEP
_WHOLE = _STEPS[::16]
_CLOSE = _STEPS[725:801]

TIMES = _T[_WHOLE]
"""Where the whole motion is shown, s: every 16th control period, not smoothed."""

CLOSE_UP = _T[_CLOSE]
"""Times of the close-up, s: every control period around the turn."""


RANGES = {"error": (-10, 5), "torque": (-40, 20), "close-up": (-10, 15)}
"""Axes of the charts: they stay, whatever is switched on. All combinations lie within."""

CODE = """\
from ddlib.widgets import RealArmSwitches

RealArmSwitches().interpolate(
    friction={friction}, dead_zone={dead_zone}, saturation={saturation},
    quantisation={quantisation}, delay={delay},
)"""
"""What the page copies as code."""


class RealArmSwitches(LiveWidget):
    """Switch friction, dead zone, saturation, quantisation and delay on and off.

    The arm follows trajectory 6 under the PD law of `ddlib.experiments.setups.STATE_FEEDBACK`, with
    the difference of two encoder readings as its velocity. The page computes every combination by
    the live engine. The charts show the shoulder; the elbow's effects have 0.3 times the strength
    of the shoulder's, as its gains have.

    Parameters
    ----------
    arm : Arm
        The arm that moves.
    **options
        Passed on to `LiveWidget`.
    """

    _esm = module(*SCRIPT) + lean(module(*ENGINE, LOOPS, "switches.js"))
    _css = module(*STYLE, "switches.css")

    loop = t.Dict(help="plant, gains, reference and strengths", read_only=True).tag(sync=True)

    def __init__(self, arm: Arm = CMU_DD_ARM_II, **options):
        ideal = _ideal(arm)
        super().__init__(
            lambda **levels: _curves(arm, **levels),
            _choices(),
            [
                _panel("Shoulder error, °", "error", TIMES, ideal),
                _panel("Shoulder torque, N m", "torque", TIMES, ideal),
                _panel("Torque around the turn, N m", "close-up", CLOSE_UP, ideal),
            ],
            title="Real-arm switches",
            alt=(
                "Shoulder error and torque over trajectory 6, and the torque around the turn at "
                "1.5 s, with friction and quantisation as assumed for the surrogate arm, over the "
                "ideal arm's."
            ),
            scalars=[
                Scalar(f"{joint} {what}", f"{joint.title()} {what} deviation, RMS", unit, digits)
                for what, unit, digits in (("position", "°", 3), ("torque", "N m", 2))
                for joint in JOINTS
            ],
            code=CODE,
            note=(
                "Strengths are the shoulder's; the elbow's are 0.3 times as large. Friction is dry "
                "friction and, at 1 rad/s, as much viscous friction."
            ),
            **options,
        )
        steps = {key: Quantisation.encoder(n).step if n else 0 for key, n in QUANTISATION.items()}
        self.set_trait(
            "loop",
            {
                "plant": plant(arm, Effects(friction=(CoulombFriction((0.0, 0.0)),))),
                "gains": gains(pd(KP, KD)),
                "share": SHARE.tolist(),
                "levels": {
                    "friction": FRICTION,
                    "dead_zone": DEAD_ZONE,
                    "saturation": SATURATION,
                    "quantisation": steps,
                    "delay": DELAY,
                },
                "extents": np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1]).tolist(),
                "motion": MOTION_SECONDS,
                "step": CONTROL_STEP,
                "periods": len(_T),
                "whole": 16,
                "close": [int(_CLOSE[0]), int(_CLOSE[-1]) + 1],
            },
        )


def _choices() -> list[Choice]:
    milliseconds = {key: 1e3 * CONTROL_STEP * periods for key, periods in DELAY.items()}
    switches = {
        "friction": ("Friction", "{:g} N m", FRICTION),
        "dead_zone": ("Dead zone", "{:g} N m", DEAD_ZONE),
        "saturation": ("Torque limit", "±{:g} N m", SATURATION),
        "quantisation": ("Encoder", "{} bits", QUANTISATION),
        "delay": ("Delay", "{:g} ms", milliseconds),
    }
    choices = []
    for name, (label, text, levels) in switches.items():
        options = {key: text.format(level) for key, level in levels.items()}
        options |= {key: f"{options[key]}, as assumed" for key in options if key == "assumed"}
        start = "assumed" if "assumed" in options else "off"
        choices.append(Choice(name, label, options | {"off": "off"}, start))
    return choices


def _panel(title, what, times, ideal) -> Panel:
    lines = {"fixed": {"ideal": ideal[what]}, "y_range": RANGES[what]}
    return Panel(title, {what: "real"}, "time, s", times, **lines)


@dataclass(frozen=True)
class _ByRun:
    """Different effects for different runs of a batch: (rows, effects) for each kind."""

    kinds: tuple

    def start(self, initial):
        paths = [(rows, started(effects, initial[rows])) for rows, effects in self.kinds]

        def path(x, rng):
            out = np.empty_like(x)
            for rows, effect in paths:
                out[rows] = effect(x[rows], rng)
            return out

        return path


def _kinds(chosen, levels, effects_of) -> _ByRun:
    """One kind per level: `effects_of` turns a level into a tuple of effects."""
    chosen = np.asarray(chosen)
    kinds = [(np.flatnonzero(chosen == key), effects_of(level)) for key, level in levels.items()]
    return _ByRun(tuple(kind for kind in kinds if kind[0].size))


def _effects(levels: Mapping) -> Effects:
    """Effects of n runs; `levels` has an array of n keys for every switch."""

    def strength(table, name):
        return np.outer([table[key] for key in levels[name]], SHARE)

    friction = strength(FRICTION, "friction")
    return Effects(
        friction=(ViscousFriction(friction), CoulombFriction(friction)),
        actuator=(
            _kinds(levels["delay"], DELAY, lambda periods: (Delay(periods),)),
            DeadZone(strength(DEAD_ZONE, "dead_zone")),
            Saturation(strength(SATURATION, "saturation")),
        ),
        encoder=(
            _kinds(
                levels["quantisation"],
                QUANTISATION,
                lambda bits: (Quantisation.encoder(bits),) if bits else (),
            ),
        ),
    )


def _run(arm: Arm, effects: Effects, runs: int) -> Recording:
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], _T)
    reference = Trajectory(*(np.broadcast_to(x, (runs, *x.shape)) for x in reference))
    law = pd(KP, KD)
    return follow(arm, law, reference, _T, effects=effects, log_every=1, velocity="difference")


@lru_cache(maxsize=4)
def _ideal_recording(arm: Arm) -> Recording:
    return _run(arm, Effects(), 1)


def _shown(recording: Recording) -> dict[str, np.ndarray]:
    """The shoulder's curves, shape (runs, samples)."""
    error, torque = np.rad2deg(recording.tracking_error[..., 0]), recording.tau_true[..., 0]
    return {
        "error": error[:, _WHOLE],
        "torque": torque[:, _WHOLE],
        "close-up": torque[:, _CLOSE],
    }


def _ideal(arm) -> dict[str, np.ndarray]:
    return {name: rows[0] for name, rows in _shown(_ideal_recording(arm)).items()}


@lru_cache(maxsize=64)
def _curves(arm, **levels) -> dict:
    rows = _many(arm, {name: [key] for name, key in levels.items()})
    return {name: row[0] for name, row in rows.items()}


def _many(arm, levels) -> dict[str, np.ndarray]:
    real, ideal = _run(arm, _effects(levels), len(levels["delay"])), _ideal_recording(arm)
    rows = _shown(real)
    moving = _T < MOTION_SECONDS
    for what, gap in (
        ("position", np.rad2deg(real.q_true - ideal.q_true)),
        ("torque", real.tau_true - ideal.tau_true),
    ):
        rms = np.sqrt((gap[:, moving] ** 2).mean(1))
        rows |= {f"{joint} {what}": rms[:, j] for j, joint in enumerate(JOINTS)}
    return rows
