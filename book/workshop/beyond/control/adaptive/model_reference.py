"""Model-reference adaptive control of each joint by itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import cont2discrete

from ddlib._check import finite_array, non_negative, number, positive
from ddlib.control.controllers import ControlLaw
from ddlib.trajectories import Trajectory
from workshop.beyond.control.adaptive.running import _RunningLaw


@dataclass(frozen=True)
class ModelReference:
    """Gains of each joint by itself that adapt until it follows a linear model.

    The model answers ``command = qdd_ref + a1 qd_ref + a0 q_ref`` with
    ``qdd_m = command - a1 qd_m - a0 q_m``. The torque is ``phi' estimate`` with
    ``phi = (command, -q, -qd, 1)`` of the joint, and the estimate moves by
    ``rate phi (de/dt + weight e)`` with ``e = q_m - q``: for a joint with inertia and viscous
    friction alone a function of e and the gains' errors never rises.

    Source: Parks 1966, for each joint by itself as in Dubowsky & DesForges 1979.
    """

    stiffness: tuple[float, float]  # a0 of each joint's model, 1/s^2
    damping: tuple[float, float]  # a1, 1/s
    weight: tuple[float, float]  # 1/s, below `damping`
    rate: Sequence[float]  # (..., 8): of four gains of the shoulder, then of the elbow
    estimate: Sequence[float]  # theirs at first: kg m^2, N m/rad, N m s/rad, N m
    leakage: float = 0.0  # as of `SlotineLi`

    def __post_init__(self):
        for name in ("stiffness", "damping", "weight"):
            positive(name, getattr(self, name), (2,))
        if not (np.asarray(self.weight) < self.damping).all():
            raise ValueError(f"weight must be below damping={self.damping}, got {self.weight}")
        non_negative("rate", self.rate, 8)
        finite_array("estimate", self.estimate, 8)
        number("leakage", self.leakage, 0.0)

    def model(self, reference: Trajectory, step: float) -> Trajectory:
        """Motion of the model, from rest at the reference's first place, sampled every `step` s."""
        a0, a1 = np.asarray(self.stiffness), np.asarray(self.damping)
        first = reference.q[..., :1, :]
        command = reference.qdd + a1 * reference.qd + a0 * (reference.q - first)
        motion = np.zeros((*command.shape, 2))
        free, push, ahead = (np.stack(x) for x in zip(*map(self._sampled, a0, a1, 2 * [step])))
        asked = command[..., None]
        state = -asked[..., 0, :, :] * ahead
        for k in range(command.shape[-2]):
            motion[..., k, :, :] = state + asked[..., k, :, :] * ahead
            state = (free @ state[..., None])[..., 0] + asked[..., k, :, :] * push
        q, qd = np.moveaxis(motion, -1, 0)
        return Trajectory(q + first, qd, command - a1 * qd - a0 * q)

    @staticmethod
    def _sampled(a0, a1, step):
        """A joint's model at samples: what state and command become, and the part fed through."""
        system = np.array([[0.0, 1.0], [-a0, -a1]]), np.array([[0.0], [1.0]]), np.eye(2)
        free, push, _, ahead, _ = cont2discrete((*system, np.zeros((2, 1))), step, "foh")
        return free, push[:, 0], ahead[:, 0]

    def output(self, estimate, wanted: Trajectory, q, qd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time; `wanted` is the model's."""
        a0, a1 = np.asarray(self.stiffness), np.asarray(self.damping)
        command = wanted.qdd + a1 * wanted.qd + a0 * wanted.q
        command, q, qd = np.broadcast_arrays(command, q, qd)
        phi = np.stack([command, -q, -qd, np.ones_like(q)], -1)
        gains = np.reshape(estimate, (*np.shape(estimate)[:-1], 2, 4))
        filtered = wanted.qd - qd + np.asarray(self.weight) * (wanted.q - q)
        change = phi * filtered[..., None]
        change = np.asarray(self.rate) * change.reshape(*change.shape[:-2], 8)
        drawn = self.leakage * (np.asarray(estimate) - self.estimate)
        return (phi * gains).sum(-1), change - drawn

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows the model of `reference`, called every `step` s."""
        return _RunningLaw(self, self.model(reference, step), step)

    def advance(self, law, estimate, wanted, q, qd):
        """Torque of a running law, and its estimate one period later."""
        torque, change = self.output(estimate, wanted, q, qd)
        return torque, estimate + law.step * change
