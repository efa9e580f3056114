"""PID loops as the page computes them: runs that may be stopped, and the linear loop around them.

The script is ``loops.js``; what stands here is the same by `ddlib` and python-control, for
tests and for the still picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from ddlib.control import PID, Controller, Feedforward, closed_loop, margins, opened_loop, plant
from ddlib.dynamics import Arm
from ddlib.effects import Effects
from ddlib.simulation import CONTROL_STEP, LOG_STEP, follow
from ddlib.trajectories import Trajectory


def modes(arm: Arm, viscous, posture=(0.0, 0.0)) -> list[dict]:
    """The joints near a posture as two modes that viscous friction damps: what the page takes.

    Each has a ``rate`` (1/s), a ``shape`` (angles of the joints per amplitude of the mode, which
    has an inertia of one) and a ``dual`` (amplitude per angle).
    """
    mass = arm.mass_matrix(posture)
    rates, shapes = eigh(np.diag(viscous), mass)
    return [
        {"rate": float(rate), "shape": shape.tolist(), "dual": (mass @ shape).tolist()}
        for rate, shape in zip(rates, shapes.T)
    ]


class _Run(NamedTuple):
    """Error (rad) and torque (N m) at the logging period, shape (time, 2), NaN after the run.

    `stopped` is the place of the last sample if an error passed the limit, otherwise None.
    """

    error: np.ndarray
    torque: np.ndarray
    stopped: int | None


@dataclass(frozen=True)
class _SwitchedOff:
    """A controller without torque once a joint is far off: what diverges stays finite."""

    controller: Controller

    def start(self, reference, step):
        law, off = self.controller.start(reference, step), False

        def torque(k, q, qd):
            nonlocal off
            off = off or np.abs(reference.q[k] - q).max() > np.pi
            return np.zeros(2) if off else law(k, q, qd)

        return torque


def run(
    arm: Arm, effects: Effects, law: Controller, reference: Trajectory, t, most, velocity
) -> _Run:
    """Drive an arm along a reference; the velocity as `ddlib.simulation.follow` has it.

    The reference is sampled at the control period; the run is over at an error of `most` (rad).
    """
    options = {"log_every": round(LOG_STEP / CONTROL_STEP), "velocity": velocity}
    recording = follow(arm, _SwitchedOff(law), reference, t, effects=effects, **options)
    error, torque = recording.tracking_error.copy(), recording.tau_true.copy()
    beyond = np.flatnonzero((np.abs(error) > most).any(-1))
    stopped = int(beyond[0]) if beyond.size else None
    if stopped is not None:
        error[stopped + 1 :] = torque[stopped + 1 :] = np.nan
    return _Run(error, torque, stopped)


class _Linear(NamedTuple):
    """The linear loop: growth (1/s) of its slowest or least stable motion; negative if stable.

    Phase margin (degrees) and crossover (rad/s) are those of each joint's loop, the other one
    closed; NaN if the loop is unstable.
    """

    growth: float
    phase_deg: np.ndarray
    crossover: np.ndarray


def linear(
    arm: Arm, viscous, law: dict, late: int, period=CONTROL_STEP, velocity="tachometer"
) -> _Linear:
    """Poles and margins of the sampled loop at the stretched arm, by python-control.

    `law` holds the gains of a `PID` by name, `late` counts periods from a reading to its torque.
    """
    joints = plant(arm.mass_matrix([0.0, 0.0]), viscous)
    timed = {"period": period, "delay": late, "velocity": velocity}
    poles = closed_loop(joints, **law, **timed).poles()
    growth = float(np.log(np.abs(poles).max()) / period)
    if growth >= 0:
        return _Linear(growth, np.full(2, np.nan), np.full(2, np.nan))
    by_joint = [margins(opened_loop(joints, **law, **timed, joint=j)) for j in (0, 1)]
    return _Linear(
        growth, np.array([m.phase_deg for m in by_joint]), np.array([m.crossover for m in by_joint])
    )


def controller(arm: Arm, law: dict, ahead: bool) -> Controller:
    """A `PID` with the fields ``law``; with ``ahead`` it corrects the rigid ``arm``'s torques."""
    return Feedforward(arm, PID(**law)) if ahead else PID(**law)
