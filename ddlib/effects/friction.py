"""Friction laws of a joint: viscous, Coulomb, Stribeck, and one that truly sticks.

Each is a small frozen object with ``torque(qd)``, the torque that opposes the motion.
Strengths are arrays ``(2,)``, or ``(runs, 2)`` for runs that differ in friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import non_negative, number


@dataclass(frozen=True)
class ViscousFriction:
    """Friction torque proportional to velocity.

    Parameters
    ----------
    coefficient : array_like, shape (2,) or (..., 2)
        N m s/rad per joint, not negative.
    """

    coefficient: tuple[float, float]

    def __post_init__(self):
        non_negative("coefficient", self.coefficient, 2)

    @property
    def slope(self) -> np.ndarray:
        """Steepest rise of the torque with velocity, N m s/rad per joint."""
        return np.asarray(self.coefficient, dtype=float)

    def torque(self, qd):
        """Friction torque (N m) at joint velocities `qd` (rad/s)."""
        return np.asarray(self.coefficient) * qd


@dataclass(frozen=True)
class CoulombFriction:
    """Friction torque of constant size against the motion, smooth through zero.

    Parameters
    ----------
    level : array_like, shape (2,) or (..., 2)
        N m per joint, not negative.
    smoothing : float
        Velocity in rad/s over which the sign turns (``tanh(qd / smoothing)``).
        It stands in for sticking: below it the joint creeps instead of resting.
    """

    level: tuple[float, float]
    smoothing: float = 2e-3

    def __post_init__(self):
        non_negative("level", self.level, 2)
        number("smoothing", self.smoothing, 0.0, open_low=True)

    @property
    def slope(self) -> np.ndarray:
        """Steepest rise of the torque with velocity, N m s/rad per joint: at rest."""
        return np.asarray(self.level, dtype=float) / self.smoothing

    def torque(self, qd):
        """Friction torque (N m) at joint velocities `qd` (rad/s)."""
        return np.asarray(self.level) * np.tanh(np.asarray(qd) / self.smoothing)


@dataclass(frozen=True)
class _Stribeck:
    """Coulomb friction that is larger near rest (Armstrong-Helouvry et al. 1994)."""

    level: tuple[float, float]
    breakaway: tuple[float, float]
    speed: float = 0.02

    def __post_init__(self):
        level = non_negative("level", self.level, 2)
        excess = non_negative("breakaway", self.breakaway, 2) - level
        if (excess < 0).any():
            raise ValueError(
                f"breakaway must not be below level {self.level}, got {self.breakaway}"
            )
        number("speed", self.speed, 0.0, open_low=True)

    def size(self, qd) -> np.ndarray:
        """Size of the friction torque (N m) of joints that slide at `qd` (rad/s), either way."""
        level = np.asarray(self.level, dtype=float)
        weakening = np.exp(-((np.asarray(qd) / self.speed) ** 2))
        return level + (np.asarray(self.breakaway) - level) * weakening


@dataclass(frozen=True)
class StribeckFriction(_Stribeck):
    """Coulomb friction that is larger near rest, smooth through zero.

    ``[level + (breakaway - level) exp(-(qd / speed)^2)] tanh(qd / smoothing)``: the torque
    falls with speed while the lubricant film builds up.

    Parameters
    ----------
    level : array_like, shape (2,) or (..., 2)
        Torque at speed, N m per joint, not negative.
    breakaway : array_like, shape (2,) or (..., 2)
        Torque near rest, N m per joint, not below `level`.
    speed : float
        Stribeck velocity, rad/s: where the excess has fallen to 1/e.
    smoothing : float
        As in `CoulombFriction`; well below `speed`, or the excess never shows.
    """

    smoothing: float = 2e-3

    def __post_init__(self):
        super().__post_init__()
        number("smoothing", self.smoothing, 0.0, open_low=True)

    @property
    def slope(self) -> np.ndarray:
        """Steepest rise of the torque with velocity, N m s/rad per joint: at rest."""
        return np.asarray(self.breakaway, dtype=float) / self.smoothing

    def torque(self, qd):
        """Friction torque (N m) at joint velocities `qd` (rad/s)."""
        return self.size(qd) * np.tanh(np.asarray(qd) / self.smoothing)


@dataclass(frozen=True)
class StickSlipFriction(_Stribeck):
    """Stribeck friction without smoothing: a joint at rest sticks until it is broken away.

    A stuck joint does not move at all; friction then is whatever torque holds it, up to
    `breakaway` (Karnopp 1985, with a band of zero width). The plant decides at each step
    which joints stick (`ddlib.simulation.plant`): friction's state is that the velocity is
    exactly zero.

    Parameters
    ----------
    level : array_like, shape (2,) or (..., 2)
        Torque at speed, N m per joint, not negative.
    breakaway : array_like, shape (2,) or (..., 2)
        Largest torque that holds a joint at rest, N m per joint, not below `level`.
    speed : float
        Stribeck velocity, rad/s: where the excess has fallen to 1/e.
    """

    def torque(self, qd):
        """Friction torque (N m) of joints that slide at `qd` (rad/s); 0 at rest, where it holds."""
        return self.size(qd) * np.sign(qd)
