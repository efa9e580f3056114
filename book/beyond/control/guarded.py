"""A safety stop: a run that leaves its limits is an outcome with a time and a reason, no crash."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory

REASONS = ("", "shoulder angle", "elbow angle", "shoulder speed", "elbow speed")
_ANGLES = (np.pi, 2.8)  # rad: half a turn, and an elbow nearly folded; assumed
_SPEEDS = (20.0, 20.0)  # rad/s: several times what the family of Appendix I asks for; assumed


@dataclass(frozen=True)
class Guarded:
    """Switches the motors off where the arm leaves its limits; a learner inside sees the plan."""

    controller: Controller
    angles: tuple[float, float] = _ANGLES
    speeds: tuple[float, float] = _SPEEDS

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law of one run, guarded."""
        return _Law(self, reference, step)


@dataclass(frozen=True)
class Stops:
    """Which runs were stopped, when and why."""

    time: np.ndarray  # after the first control sample, s; infinite for runs that were not stopped
    reason: np.ndarray  # index into `REASONS`

    @property
    def stopped(self) -> np.ndarray:
        """Whether each run was stopped, shape (...)."""
        return np.isfinite(self.time)

    def running(self, t) -> np.ndarray:
        """Whether each run was under control at times of a log (s), shape (..., time)."""
        t = np.asarray(t, float)  # from that of the first control sample on
        return t - t[0] < np.asarray(self.time)[..., None] - 1e-9


class _Law:
    def __init__(self, guard: Guarded, reference: Trajectory, step: float):
        self._reference, self._step = reference, step
        self._limits = np.concatenate([guard.angles, guard.speeds]).astype(float)
        self._reason = np.zeros((), int)
        self._sample = np.full((), np.inf)
        self.inner = as_controller(guard.controller).start(reference, step)

    def __call__(self, k, q, qd):
        state = np.abs(np.concatenate(np.broadcast_arrays(q, qd), -1))
        over = ~(state <= self._limits)  # a speed that is no number is over, too
        new = over.any(-1) & (self._reason == 0)
        self._reason = np.where(new, over.argmax(-1) + 1, self._reason)
        self._sample = np.where(new, k, self._sample)
        off = (self._reason > 0)[..., None]
        wanted = self._reference
        torque = self.inner(
            k, np.where(off, wanted.q[..., k, :], q), np.where(off, wanted.qd[..., k, :], qd)
        )
        return np.where(off, 0.0, torque)

    @property
    def stops(self) -> Stops:
        return Stops(self._sample * self._step, self._reason)
