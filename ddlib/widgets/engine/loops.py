"""PID loops as the page computes them: runs that may be stopped, and the linear loop around them.

The script is ``static/loops.js``; what stands here is the same by `ddlib` and python-control, for
tests and for the still picture.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from ddlib.control import (
    PID,
    Controller,
    Feedforward,
    Guarded,
    closed_loop,
    margins,
    opened_loop,
    plant,
)
from ddlib.dynamics import Arm
from ddlib.effects import Delay, Effects, ViscousFriction
from ddlib.simulation import CONTROL_STEP, LOG_STEP, follow
from ddlib.trajectories import Trajectory

LOOPS = "loops.js"
"""The script, after those of the engine."""

FAST = (1e3, 1e3)
"""Joint speeds that no run reaches before its error stops it, rad/s."""


def modes(arm: Arm, viscous, posture=(0.0, 0.0)) -> list[dict]:
    """The joints near a posture as two modes that viscous friction damps: what the page takes.

    Parameters
    ----------
    arm : Arm
    viscous : array_like, shape (2,)
        N m s/rad, positive.
    posture : array_like, shape (2,)
        rad.

    Returns
    -------
    list of dict
        ``rate`` (1/s), ``shape`` (angles of the joints per amplitude of the mode, which has an
        inertia of one) and ``dual`` (amplitude per angle).
    """
    mass = arm.mass_matrix(posture)
    rates, shapes = eigh(np.diag(viscous), mass)
    return [
        {"rate": float(rate), "shape": shape.tolist(), "dual": (mass @ shape).tolist()}
        for rate, shape in zip(rates, shapes.T)
    ]


class Run(NamedTuple):
    """A run that was over when a joint's error passed a limit.

    Attributes
    ----------
    error, torque : ndarray, shape (time, 2)
        rad and N m, at the logging period; NaN after the run.
    stopped : int or None
        Place of its last sample, if it was stopped.
    """

    error: np.ndarray
    torque: np.ndarray
    stopped: int | None


def run(arm: Arm, viscous, law: Controller, late: int, reference: Trajectory, t, most) -> Run:
    """Drive an arm with viscous friction along a reference, the torque some periods late.

    Parameters
    ----------
    arm : Arm
    viscous : tuple of float
        N m s/rad.
    law : Controller
    late : int
        Control periods between a reading and its torque.
    reference : Trajectory
        Sampled at the control period, shape (time, 2).
    t : array_like, shape (time,)
        s.
    most : float
        Error at which the run is over, rad.
    """
    effects = Effects(friction=(ViscousFriction(viscous),), actuator=(Delay(late),) * bool(late))
    every = round(LOG_STEP / CONTROL_STEP)
    recording = follow(
        arm, Guarded(law, speeds=FAST), reference, t, effects=effects, log_every=every
    )
    error, torque = recording.tracking_error.copy(), recording.tau_true.copy()
    beyond = np.flatnonzero((np.abs(error) > most).any(-1))
    stopped = int(beyond[0]) if beyond.size else None
    if stopped is not None:
        error[stopped + 1 :] = torque[stopped + 1 :] = np.nan
    return Run(error, torque, stopped)


class Linear(NamedTuple):
    """The linear loop around a posture.

    Attributes
    ----------
    growth : float
        Of its slowest or least stable motion, 1/s; negative: the loop is stable.
    phase_deg, crossover : ndarray, shape (2,)
        Margin (degrees) and crossover (rad/s) of each joint's loop, the other one closed; NaN if
        the loop is unstable.
    """

    growth: float
    phase_deg: np.ndarray
    crossover: np.ndarray


def linear(arm: Arm, viscous, law: dict, late: int, period=CONTROL_STEP) -> Linear:
    """Poles and margins of the sampled loop at the stretched arm, by python-control.

    Parameters
    ----------
    arm : Arm
    viscous : array_like, shape (2,)
        N m s/rad.
    law : dict
        Gains, as of `PID`: ``kp``, ``ki``, ``kd``, a pair each.
    late : int
        Periods between a reading and its torque.
    period : float
        s.
    """
    joints = plant(arm.mass_matrix([0.0, 0.0]), viscous)
    poles = closed_loop(joints, **law, period=period, delay=late).poles()
    growth = float(np.log(np.abs(poles).max()) / period)
    if growth >= 0:
        return Linear(growth, np.full(2, np.nan), np.full(2, np.nan))
    each = [margins(opened_loop(joints, **law, period=period, delay=late, joint=j)) for j in (0, 1)]
    return Linear(
        growth, np.array([m.phase_deg for m in each]), np.array([m.crossover for m in each])
    )


def controller(arm: Arm, law: dict, ahead: bool) -> Controller:
    """A `PID` with the gains ``law``; with ``ahead`` it corrects the rigid ``arm``'s torques."""
    return Feedforward(arm, PID(**law)) if ahead else PID(**law)
