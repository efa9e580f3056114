"""Adaptive control without acceleration, after Slotine & Li 1987."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ddlib._check import non_negative, number, one_of, shaped
from ddlib.control.controllers import ControlLaw
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory
from workshop.beyond.control.adaptive.regressor import (
    PARAMETERS,
    _check_parameters,
    _unchecked_regressor,
)
from workshop.beyond.control.adaptive.running import _RunningLaw


@dataclass(frozen=True)
class SlotineLi:
    """Adaptive control without acceleration (Slotine & Li 1987).

    With ``e = q_ref - q``, the velocity ``v = qd_ref + slope e`` and ``s = v - qd`` the torque is
    ``Y(q, qd, v, dv/dt) estimate + gain s``, and the estimate moves by
    ``d estimate/dt = rate Y' s``. With ``at="desired"`` Y is that of the reference alone, which can
    be computed beforehand (Sadegh & Horowitz 1990); then `lyapunov` may rise.
    """

    gain: tuple[float, float]  # of s, N m s/rad
    slope: tuple[float, float]  # how fast an error would die out on s = 0, 1/s
    rate: Sequence[float]  # (..., parameters), their unit per N m rad; 0: it is not adapted
    estimate: Sequence[float]  # (..., parameters): what the run begins with
    names: Sequence[str] = PARAMETERS[:3]
    at: str = "measured"  # or "desired": the state at which Y is taken
    dead_zone: tuple[float, float] = (0.0, 0.0)  # of s, rad/s: taken off, nothing is learnt within
    leakage: float = 0.0  # rate at which the estimate goes back to what the run began with, 1/s

    def __post_init__(self):
        one_of("at", self.at, ("measured", "desired"))
        for name in ("gain", "slope"):
            value = shaped(name, getattr(self, name), "(..., 2)")
            if (value <= 0).any():
                raise ValueError(f"{name} must be above 0 for each joint, got {value}")
        non_negative("dead_zone", self.dead_zone, 2)
        number("leakage", self.leakage, 0.0)
        _check_parameters(self)

    def output(self, estimate, wanted: Trajectory, q, qd) -> tuple[np.ndarray, np.ndarray]:
        """Torque ``(..., 2)`` and the estimate's rate of change per second, in continuous time.

        `wanted` is one sample of the reference, `q` and `qd` are measured.
        """
        s, v, a = self._sliding(wanted, q, qd)
        if self.at == "desired":
            q, qd, v, a = wanted.q, wanted.qd, wanted.qd, wanted.qdd
        Y = _unchecked_regressor(q, qd, v, a, self.names)
        torque = np.einsum("...jp,...p->...j", Y, np.asarray(estimate)) + self.gain * s
        learnt = s - np.clip(s, -np.asarray(self.dead_zone), self.dead_zone)
        change = np.asarray(self.rate) * np.einsum("...jp,...j->...p", Y, learnt)
        return torque, change - self.leakage * (np.asarray(estimate) - self.estimate)

    def lyapunov(self, arm: Arm, truth, estimate, wanted: Trajectory, q, qd) -> np.ndarray:
        """``s' M s / 2`` plus the squared error of the estimate over the rate, shape (...).

        On a rigid body with the parameters `truth`, in continuous time, it falls at the rate
        ``s' gain s`` and never rises. Parameters with a rate of 0 are left out; they must be right.
        """
        s = self._sliding(wanted, q, qd)[0]
        kinetic = 0.5 * np.einsum("...i,...ij,...j", s, arm.mass_matrix(q), s)
        rate = np.asarray(self.rate, float)
        error = np.asarray(estimate) - np.asarray(truth)
        each = np.divide(
            error**2, rate, out=np.zeros(np.broadcast(error, rate).shape), where=rate > 0
        )
        return kinetic + 0.5 * each.sum(-1)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it holds its estimate."""
        return _RunningLaw(self, reference, step)

    def _sliding(self, wanted, q, qd):
        slope = np.asarray(self.slope)
        error, error_rate = wanted.q - q, wanted.qd - qd
        v, a = wanted.qd + slope * error, wanted.qdd + slope * error_rate
        return v - qd, v, a

    def advance(self, law, estimate, wanted, q, qd):
        """Torque of a running law, and its estimate one period later."""
        torque, change = self.output(estimate, wanted, q, qd)
        return torque, estimate + law.step * change
