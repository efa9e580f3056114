"""Three gains and a model: what they do to tracking error, torque and margins."""

from __future__ import annotations

import numpy as np

from ddlib.control import PID, Feedforward, margins, opened_loop, plant
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import Effects, ViscousFriction
from ddlib.experiments import KD, KP
from ddlib.paper import TEST_TRAJECTORY
from ddlib.simulation import CONTROL_STEP, follow
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice, Parameter

JOINTS = ("shoulder", "elbow")

VISCOUS = (0.5, 0.15)
"""Viscous friction of the joints, N m s/rad, and the only effect here: every curve must
change smoothly with the gains, or it could not be interpolated. Assumed."""

LOG_EVERY = 5

_STEPS = np.arange(round(3.5 / CONTROL_STEP) + 1)
_T = _STEPS * CONTROL_STEP

TIMES = np.r_[0:90:3, 90:298:8, 299, 300:351:5] / 100
"""Where the curves are sampled, s: closer where the reference starts and stops."""

_SHOWN = np.rint(TIMES / CONTROL_STEP / LOG_EVERY).astype(int)

_ELBOW = {"kp": KP[1] / KP[0], "ki": KP[1] / KP[0], "kd": KD[1] / KD[0]}


class PIDTuner(CurveWidget):
    """Tune the gains of both joints on trajectory 6, with or without feedforward.

    The sliders set the shoulder's gains; the elbow's are in the ratio of `ddlib.experiments.setups`
    (its integral gain in that of the proportional gains). The arm is rigid, with viscous
    friction and exact sensors; feedforward uses the rigid arm as its model, without friction.
    Margins are those of the sampled loop at the stretched arm, cut open at one joint's torque
    while the other joint's loop is closed.

    Parameters
    ----------
    arm : Arm
        The arm that moves.
    **options
        Passed on to `CurveWidget`: ``checks``, ``tolerance``, ``interpolation``.
    """

    def __init__(self, arm: Arm = CMU_DD_ARM_II, **options):
        super().__init__(
            lambda **setting: _curves(arm, setting),
            [
                Parameter("kp", "Proportional gain", 150, 600, KP[0], "N m/rad", 9, "log"),
                Parameter("ki", "Integral gain", 0, 150, 0, "N m/(rad s)", 4),
                Parameter("kd", "Derivative gain", 20, 80, KD[0], "N m s/rad", 6, "log"),
                Choice("feedforward", "Feedforward", {False: "off", True: "on"}, False, "switch"),
            ],
            [
                Panel(
                    f"{what}, {unit}",
                    {f"{joint} {what.lower()}": joint for joint in JOINTS},
                    "time, s",
                    TIMES,
                )
                for what, unit in (("Error", "°"), ("Torque", "N m"))
            ],
            title="PID tuner",
            alt=(
                "Tracking error and torque of both joints over trajectory 6 under PD control with "
                "the book's gains, without feedforward."
            ),
            scalars=[
                *(Scalar(f"{j} RMS", f"{j.title()} error, RMS", "°") for j in JOINTS),
                *(Scalar(f"{j} phase margin", f"{j.title()} phase margin", "°") for j in JOINTS),
                Scalar("crossover", "Shoulder crossover", "rad/s"),
                Scalar("gain margin", "Shoulder gain margin", "dB"),
            ],
            note=(
                "The sliders set the shoulder's gains; the elbow's follow in fixed ratio. "
                "The ranges end before a loop becomes unstable."
            ),
            many=lambda **settings: _many(arm, settings),
            **options,
        )


def gains(kp, ki, kd) -> dict[str, np.ndarray]:
    """Gains of both joints from the shoulder's.

    Parameters
    ----------
    kp, ki, kd : array_like, shape (...)
        The shoulder's, in N m/rad, N m/(rad s) and N m s/rad.

    Returns
    -------
    dict
        The three gains by name, shape (..., 2): arguments of `PID`.
    """
    given = {"kp": kp, "ki": ki, "kd": kd}
    return {k: np.multiply.outer(np.asarray(x, float), (1.0, _ELBOW[k])) for k, x in given.items()}


def _curves(arm, setting) -> dict:
    """The curves of one setting."""
    rows = _many(arm, {name: np.array([value]) for name, value in setting.items()})
    return {name: row[0] for name, row in rows.items()}


def _many(arm, settings) -> dict[str, np.ndarray]:
    """The curves of many settings, shape (n, samples) or (n,)."""
    law = gains(settings["kp"], settings["ki"], settings["kd"])
    on = np.asarray(settings["feedforward"], dtype=float)[:, None, None]
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], _T)
    recording = follow(
        arm,
        Feedforward(lambda q, qd, qdd: on * arm.inverse_dynamics(q, qd, qdd), PID(**law)),
        Trajectory(*(np.broadcast_to(x, (len(on), *x.shape)) for x in reference)),
        _T,
        effects=Effects(friction=(ViscousFriction(VISCOUS),)),
        log_every=LOG_EVERY,
    )
    error = np.rad2deg(recording.tracking_error)
    moving = error[:, recording.t < MOTION_SECONDS]
    rows = {}
    for j, joint in enumerate(JOINTS):
        rows[f"{joint} error"] = error[:, _SHOWN, j]
        rows[f"{joint} torque"] = recording.tau_true[:, _SHOWN, j]
        rows[f"{joint} RMS"] = np.sqrt((moving[..., j] ** 2).mean(-1))
    return rows | _margins(arm, law)


def _margins(arm, law) -> dict[str, np.ndarray]:
    """Margins of the linear loops at the stretched arm, shape (n,)."""
    joints = plant(arm.mass_matrix([0.0, 0.0]), VISCOUS)
    rows, where = np.unique(np.hstack(list(law.values())), axis=0, return_inverse=True)
    shoulder, elbow = (
        [margins(opened_loop(joints, *x, CONTROL_STEP, joint=j)) for x in rows.reshape(-1, 3, 2)]
        for j in (0, 1)
    )
    numbers = {
        "shoulder phase margin": [m.phase_deg for m in shoulder],
        "elbow phase margin": [m.phase_deg for m in elbow],
        "crossover": [m.crossover for m in shoulder],
        "gain margin": 20 * np.log10([m.upper_gain for m in shoulder]),
    }
    return {name: np.asarray(values)[where] for name, values in numbers.items()}
