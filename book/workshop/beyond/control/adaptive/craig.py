"""Adaptive computed torque, after Craig, Hsu & Sastry 1987: it needs the acceleration."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ddlib._check import non_negative, shaped
from ddlib.control.controllers import ControlLaw
from ddlib.trajectories import Trajectory
from workshop.beyond.control.adaptive.regressor import (
    PARAMETERS,
    _check_parameters,
    _unchecked_regressor,
)
from workshop.beyond.control.adaptive.running import _RunningLaw

_MARGIN = 0.9  # largest b as a share of that which makes the mass matrix singular


@dataclass(frozen=True)
class CraigHsuSastry:
    """Adaptive computed torque (Craig, Hsu & Sastry 1987): it needs the acceleration.

    The torque is ``M (qdd_ref + kd de/dt + kp e) + C qd + g + friction`` with the estimates, which
    move by ``rate Y(q, qd, qdd)' M^-1 (de/dt + weight e)`` and are held in a box, and b where M can
    be inverted. With `weight` below `kd` the error's equation passes energy on without gaining any
    (it is strictly positive real).
    """

    kp: tuple[float, float]  # 1/s^2
    kd: tuple[float, float]  # 1/s
    weight: tuple[float, float]  # of the error in the adaptation, 1/s
    rate: Sequence[float]
    estimate: Sequence[float]
    low: Sequence[float]  # the box of the estimates, with d above 0 and below a
    high: Sequence[float]
    names: Sequence[str] = PARAMETERS[:3]  # they begin with a, b, d
    acceleration: Callable | None = None  # of q, qd and the torque held; default: by difference

    def __post_init__(self):
        for name in ("kp", "kd", "weight"):
            non_negative(name, getattr(self, name), 2)
        if not (np.asarray(self.weight) < self.kd).all():
            raise ValueError(f"weight must be below kd={self.kd}, got {self.weight}")
        _check_parameters(self)
        if tuple(self.names[:3]) != PARAMETERS[:3]:
            raise ValueError(f"names must begin with a, b, d, got {self.names}")
        low, high = (shaped(n, getattr(self, n), (len(self.names),)) for n in ("low", "high"))
        inside = (low <= self.estimate) & (np.asarray(self.estimate) <= high)
        if not inside.all():
            raise ValueError(f"estimate must lie between low and high, got {self.estimate}")
        if not 0 < low[2] <= high[2] < low[0]:
            raise ValueError(
                "low and high must leave room for a positive definite mass matrix (0 < d < a), got "
                f"d from {low[2]:g} to {high[2]:g}, a from {low[0]:g}"
            )

    def output(self, estimate, wanted: Trajectory, q, qd, qdd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time, outside the box too."""
        estimate = np.asarray(estimate, float)
        error, error_rate = wanted.q - q, wanted.qd - qd
        asked = wanted.qdd + np.asarray(self.kd) * error_rate + np.asarray(self.kp) * error
        Y = _unchecked_regressor(q, qd, qd, asked, self.names)
        torque = np.einsum("...jp,...p->...j", Y, estimate)
        measured = _unchecked_regressor(q, qd, qd, qdd, self.names)
        filtered = error_rate + np.asarray(self.weight) * error
        turned = np.linalg.solve(_mass(estimate, np.asarray(q)), filtered[..., None])[..., 0]
        return torque, np.asarray(self.rate) * np.einsum("...jp,...j->...p", measured, turned)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`; the acceleration is the difference of velocities."""
        return _RunningLaw(self, reference, step)

    def advance(self, law, estimate, wanted, q, qd):
        """Torque of a running law, and its estimate one period later."""
        before, held = (qd, np.zeros(2)) if law.memory is None else law.memory
        if self.acceleration is None:
            qdd = (qd - before) / law.step
        else:
            qdd = self.acceleration(q, qd, held)
        torque, change = self.output(estimate, wanted, q, qd, qdd)
        law.memory = qd, torque
        return torque, self._invertible(np.clip(estimate + law.step * change, self.low, self.high))

    def _invertible(self, estimate):
        a, b, d = np.moveaxis(estimate[..., :3], -1, 0)
        most = _MARGIN * np.sqrt(d * (a - d))
        return np.concatenate(
            [np.stack([a, np.clip(b, -most, most), d], -1), estimate[..., 3:]], -1
        )


def _mass(estimate, q) -> np.ndarray:
    """Mass matrices of estimates whose first three numbers are a, b, d."""
    a, b, d = np.moveaxis(estimate[..., :3], -1, 0)
    c2 = np.cos(q[..., 1])
    m11, m12, m22 = np.broadcast_arrays(a + 2 * b * c2, d + b * c2, d)
    return np.stack([np.stack([m11, m12], -1), np.stack([m12, m22], -1)], -2)
