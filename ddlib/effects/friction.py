"""Friction laws of a joint: viscous, Coulomb, Stribeck, one that truly sticks.

Strengths are arrays ``(2,)``, or ``(runs, 2)`` for runs that differ in friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import non_negative, number


@dataclass(frozen=True)
class ViscousFriction:
    """Friction torque proportional to velocity."""

    coefficient: tuple[float, float]  #: N m s/rad per joint.

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
    """Friction torque of constant size against the motion, ``level tanh(qd / smoothing)``.

    The smoothing stands in for sticking: below it the joint creeps instead of resting.
    """

    level: tuple[float, float]  #: N m per joint.
    smoothing: float = 2e-3  #: Velocity over which the sign turns, rad/s.

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

    level: tuple[float, float]  #: Torque at speed, N m per joint.
    breakaway: tuple[float, float]  #: Torque near rest, N m per joint, not below `level`.
    speed: float = 0.02  #: Stribeck velocity, rad/s: where the excess has fallen to 1/e.

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

    ``[level + (breakaway - level) exp(-(qd / speed)^2)] tanh(qd / smoothing)``.
    """

    smoothing: float = 2e-3  #: rad/s, well below `speed`, or the excess never shows.

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

    Friction then is whatever torque holds it, up to `breakaway` (Karnopp 1985, with a band of zero
    width). `ddlib.simulation.plant` decides at each step which joints stick.
    """

    def torque(self, qd):
        """Friction torque (N m) of joints that slide at `qd` (rad/s); 0 at rest, where it holds."""
        return self.size(qd) * np.sign(qd)
