"""Three gains, a delay, a model and what disturbs: tracking error, torque and stability."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import (
    CoulombFriction,
    Delay,
    Effects,
    Load,
    Quantisation,
    Saturation,
    ViscousFriction,
)
from ddlib.figures import JOINTS
from ddlib.paper import TEST_TRAJECTORY
from ddlib.setups import (
    JOINT_DAMPING_BITS,
    JOINT_DAMPING_COULOMB,
    JOINT_DAMPING_KP as KP,
    JOINT_DAMPING_VISCOUS,
)
from ddlib.simulation import CONTROL_STEP, LOG_STEP
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.engine._plain import plant
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.table import Live
from workshop.chapters.widgets.loops import controller, linear, modes, run

_HERE = Path(__file__).parent

_VISCOUS = JOINT_DAMPING_VISCOUS  # friction of the joints, N m s/rad, the only effect at first
_LOAD, _LIMIT = (10.0, 0.0), (20.0, 6.0)  # N m: a motor that can just carry the load and move
_COUNT = 2 * np.pi / 2**JOINT_DAMPING_BITS  # of the encoder, rad
_MOST_DEG = 30.0  # error at which a run is stopped: larger than any of a stable loop here
_LATE = (0, 1, 5, 10, 20)  # control periods between a reading and its torque

_T = np.arange(round(3.5 / CONTROL_STEP) + 1) * CONTROL_STEP

_TIMES = _T[:: round(LOG_STEP / CONTROL_STEP)]  # when the curves are sampled, s

# Gains of the elbow over the shoulder's; those of the damper give both the same damping ratio.
_ELBOW = {"kp": KP[1] / KP[0], "ki": KP[1] / KP[0], "kd": 0.2}

_CALM = {"load": False, "dry": False, "limit": "none", "noise": False}  # nothing disturbs
_START = {"kp": KP[0], "ki": 0.0, "kd": 0.0, "late": 0, "feedforward": False, **_CALM}

_CODE = """\
from ddlib.dynamics import CMU_DD_ARM_II
from workshop.chapters.widgets.tuner import tuned

run = tuned(
    CMU_DD_ARM_II, kp={kp}, ki={ki}, kd={kd}, late={late}, feedforward={feedforward},
    load={load}, dry={dry}, limit={limit}, noise={noise},
)
run["shoulder error"], run["growth"], run["stopped"]"""


def _question(text, change, choices, right, why, first=None) -> dict:
    """What happens if `text`: asked before it is shown.

    `first` and `change` are parameters that differ from `_START` before and afterwards, `right` is
    the place among the choices of what does happen; a test measures it.
    """
    settings = [{**_START, **(first or {})}, {**_START, **change}]
    return {"text": text, "choices": list(choices), "right": right, "why": why,
            "settings": settings}  # fmt: skip


_KINDS = (
    "It settles as before.",
    "It swings through the whole motion.",
    "The swing grows until the run stops.",
)

_QUESTIONS = (
    _question(
        "you make the springs twelve times as stiff (proportional gain 9000 N m/rad)",
        {"kp": 9000.0},
        ("It swings for a shorter time.", _KINDS[1], _KINDS[2]),
        2,
        "Beyond a limit, a stiffer spring feeds the swing. The page below finds out why.",
    ),
    _question(
        "you keep these stiff springs and add a damper of 60 N m s/rad",
        {"kp": 9000.0, "kd": 60.0},
        _KINDS,
        0,
        "The damper takes more energy out of each swing than the stiff springs put in.",
        {"kp": 9000.0},
    ),
    _question(
        "every torque comes 10 ms late",
        {"late": 5},
        _KINDS,
        2,
        "A late spring pushes along the velocity, so it acts as negative friction. Here it is "
        "stronger than the joint's own friction.",
    ),
    _question(
        "every torque comes 10 ms late, and you add a damper of 60 N m s/rad",
        {"kd": 60.0, "late": 5},
        _KINDS,
        0,
        "The damper leads in phase by more than the delay lags. So some phase margin is left.",
        {"late": 5},
    ),
    _question(
        "you add a damper of 100 N m s/rad, and every torque comes 40 ms late",
        {"kd": 100.0, "late": 20},
        _KINDS,
        2,
        "With a stronger damper the crossover lies at a higher frequency. There the same delay "
        "costs a larger angle.",
    ),
    _question(
        "you add an integral gain of 3000 N m/(rad s)",
        {"ki": 3000.0},
        ("The integral ends the swing.", "The swing goes on as it was.", _KINDS[2]),
        2,
        "An integral adds up past errors. So it pushes late, and a late push feeds the swing.",
    ),
    _question(
        "the motor gives 20 N m at most, under a damper of 60 N m s/rad and an integral gain of "
        "3000 N m/(rad s)",
        {"ki": 3000.0, "kd": 60.0, "limit": "yes"},
        (
            "The arm starts a little slower.",
            "The arm is thrown far off, although the linear loop is stable.",
            "The linear loop becomes unstable.",
        ),
        1,
        "The integral winds up while the motor is at its limit. Then choose the limit with "
        "anti-windup.",
        {"ki": 3000.0, "kd": 60.0},
    ),
    _question(
        "you make a damper of 60 N m s/rad twice as strong",
        {"kd": 120.0},
        (
            "The first torque stays as it is.",
            "The first torque doubles.",
            "The first torque is halved.",
        ),
        1,
        "The reference begins with a jump of its velocity, and only the damper reacts to velocity.",
        {"kd": 60.0},
    ),
    _question(
        "you add feedforward to a damper of 60 N m s/rad",
        {"kd": 60.0, "feedforward": True},
        (
            "All errors shrink.",
            "The first error stays, the later ones shrink.",
            "The errors stay, the torques change.",
        ),
        1,
        "The model knows which torque the wanted acceleration needs. But it knows neither the jump "
        "at the start nor friction.",
        {"kd": 60.0},
    ),
    _question(
        "the damper gets its velocity from a coarse encoder, as the difference of two readings",
        {"kd": 97.5, "noise": True},
        (
            "The torque gets a little rougher.",
            "The torque jumps by half of 100 N m, and the arm hardly notices.",
            "The arm trembles by degrees.",
        ),
        1,
        "A count is a small angle, but it comes within one period, so the damper sees a high "
        "speed. The heavy arm smooths it out.",
        {"kd": 97.5},
    ),
)
_ASKED = {"error": (0, 1, 2, 3, 4, 5, 8), "torque": (9, 6, 7)}  # by what is shown first


class PIDTuner(CurveWidget):
    """Tune the gains of both joints on trajectory 6; the arm moves, and so does the last one.

    The sliders set the shoulder's gains; the elbow's are in the ratio of `JOINT_DAMPING_KP`, its
    derivative gain a fifth. The arm is rigid, with viscous friction and exact sensors; switches add
    a load, dry friction, a limit of the torque, and an encoder whose readings are differenced for
    the velocity. Feedforward uses the rigid arm as its model, without friction. The page computes
    everything by the live engine. A run is stopped where a joint's error passes 30 degrees. Growth
    and margins are those of the sampled linear loop at the stretched arm, which knows of the
    switches only that the velocity is a difference; margins with the loop cut open at one joint's
    torque while the other joint's is closed.
    """

    _esm = bundle(_HERE / "tuner.js")
    _css = styles(_HERE / "stage.css", _HERE / "tuner.css")

    before = t.Dict(help="the setting before this one, which the ghost has").tag(sync=True)
    loop = t.Dict(help="plant, modes, reference and questions", read_only=True).tag(sync=True)

    def __init__(self, first: str = "error", kd: float = 0.0):
        """Charts of the errors or of the torques stand `first`, with the questions about them."""
        milliseconds = {n: f"{1e3 * CONTROL_STEP * n:g} ms" for n in _LATE}
        super().__init__(
            self._both,
            [
                Parameter("kp", "Proportional gain", 50, 12000, KP[0], "N m/rad", scale="log"),
                Parameter("ki", "Integral gain", 0, 4000, 0, "N m/(rad s)"),
                Parameter("kd", "Derivative gain", 0, 150, kd, "N m s/rad"),
                Choice("late", "The torque comes late by", milliseconds, 0, "slider"),
                *(
                    Choice(name, label, {False: "off", True: "on"}, False, "switch")
                    for name, label in (
                        ("feedforward", "Feedforward"),
                        ("load", f"Load, {_LOAD[0]:g} N m"),
                        ("dry", "Dry friction"),
                        ("noise", "Encoder noise"),
                    )
                ),
                Choice(
                    "limit",
                    "Torque limit",
                    {
                        "none": "none",
                        "yes": f"{_LIMIT[0]:g} N m",
                        "anti-windup": f"{_LIMIT[0]:g} N m, anti-windup",
                    },
                    "none",
                ),
            ],
            [
                Panel(
                    f"{joint.title()} {what}, {unit}",
                    {f"{joint} {what} before": "before", f"{joint} {what}": "now"},
                    "time, s",
                    _TIMES,
                    y_fit=True,
                    roles={"now": joint},
                )
                for what, unit in sorted(
                    (("error", "°"), ("torque", "N m")), key=lambda kind: kind[0] != first
                )
                for joint in JOINTS
            ],
            live=Live(examples=[{"kd": 60.0}, {"kp": 50.0}]),
            title="PID tuner",
            alt=(
                "Tracking error and torque of both joints over trajectory 6 with the springs and "
                f"the friction of the book's arm, {'a' if kd else 'no'} damper, no integral and no "
                "feedforward."
            ),
            scalars=[
                *(Scalar(f"{j} RMS", f"{j.title()} error, RMS", "°", 2) for j in JOINTS),
                *(Scalar(f"{j} phase margin", f"{j.title()} phase margin", "°", 1) for j in JOINTS),
                Scalar("crossover", "Shoulder crossover", "rad/s", 1),
            ],
            code=_CODE,
            note="The sliders set the shoulder's gains. The elbow's follow in a fixed ratio. "
            "The load pushes the shoulder. With encoder noise the velocity is the difference of "
            "two coarse readings. The linear loop knows neither load nor limit nor dry friction.",
        )
        effects = Effects(friction=(ViscousFriction(_VISCOUS),))
        loop = {
            "plant": plant(CMU_DD_ARM_II, effects),
            "modes": modes(CMU_DD_ARM_II, _VISCOUS),
            "elbow": _ELBOW,
            "load": _LOAD,
            "dry": JOINT_DAMPING_COULOMB,
            "limit": _LIMIT,
            "count": _COUNT,
            "extents": np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1]).tolist(),
            "motion": MOTION_SECONDS,
            "step": CONTROL_STEP,
            "periods": len(_T),
            "every": round(LOG_STEP / CONTROL_STEP),
            "most": np.deg2rad(_MOST_DEG),
            "questions": [_QUESTIONS[k] for k in _ASKED[first]],
        }
        self._keep(before=self.values, loop=loop)

    def _both(self, **setting) -> dict:
        """The curves of a setting, and of the one before."""
        now = _remembered(**setting)
        old = _remembered(**{**setting, **self.before})
        ghost = {f"{name} before": x for name, x in old.items() if np.size(x) > 1}
        return {**ghost, **{name: x for name, x in now.items() if name != "stopped"}}


@lru_cache(maxsize=32)
def _remembered(**setting) -> dict:
    return tuned(CMU_DD_ARM_II, **setting)


def _gains(kp, ki, kd) -> dict[str, np.ndarray]:
    """Gains of both joints, shape (..., 2), from the shoulder's: arguments of `PID`."""
    given = {"kp": kp, "ki": ki, "kd": kd}
    return {k: np.multiply.outer(np.asarray(x, float), (1.0, _ELBOW[k])) for k, x in given.items()}


def tuned(
    arm: Arm, kp, ki, kd, late, feedforward, load=False, dry=False, limit="none", noise=False
) -> dict:
    """Curves and numbers of one setting, by ddlib's simulator and python-control.

    Errors in degrees, the motors' torques in N m, NaN after the end of a run; growth of the linear
    loop in 1/s.
    """
    law = _gains(kp, ki, kd)
    reference = Trajectory(*pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], _T))
    cured = {"limit": _LIMIT} if limit == "anti-windup" else {}
    drive = controller(arm, law | cured, feedforward)
    pushed = np.array(_LOAD) * load
    effects = Effects(
        friction=(ViscousFriction(_VISCOUS), *[CoulombFriction(JOINT_DAMPING_COULOMB)] * dry),
        actuator=(Delay(late), *[Saturation(_LIMIT)] * (limit != "none"), Load(tuple(pushed))),
        encoder=(Quantisation(_COUNT),) * noise,
    )
    velocity = "difference" if noise else "tachometer"
    done = run(arm, effects, drive, reference, _T, np.deg2rad(_MOST_DEG), velocity)
    near = linear(arm, _VISCOUS, law, late, velocity=velocity)
    error = np.rad2deg(done.error)
    rows = {}
    for j, joint in enumerate(JOINTS):
        rows[f"{joint} error"] = error[:, j]
        rows[f"{joint} torque"] = done.torque[:, j] - pushed[j]
        rows[f"{joint} RMS"] = np.sqrt((error[_TIMES < MOTION_SECONDS - 1e-9, j] ** 2).mean())
        rows[f"{joint} phase margin"] = near.phase_deg[j]
    stopped = np.nan if done.stopped is None else _TIMES[done.stopped]
    return {**rows, "crossover": near.crossover[0], "growth": near.growth, "stopped": stopped}
