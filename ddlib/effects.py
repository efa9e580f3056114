"""What Lagrange-Euler leaves out: friction, actuators and sensors as they are.

Each effect is a small frozen object. `Effects` collects them in the order in
which a signal meets them; leaving one out switches it off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from ddlib._check import finite_array, integer, non_negative, number


class Friction(Protocol):
    """A torque that opposes motion."""

    def torque(self, qd: np.ndarray) -> np.ndarray:
        """Friction torque (N m) at joint velocities `qd` (rad/s), both ``(..., joint)``."""


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
class Saturation:
    """Torque limited to plus or minus `limit` (N m per joint, shape (2,))."""

    limit: tuple[float, float]

    def __post_init__(self):
        if (finite_array("limit", self.limit, 2) <= 0).any():
            raise ValueError(f"limit must be positive, got {self.limit}")

    def apply(self, x, rng=None):
        """The torque `x` (N m), clipped."""
        limit = np.asarray(self.limit)
        return np.clip(x, -limit, limit)


@dataclass(frozen=True)
class Quantisation:
    """A reading rounded to the nearest multiple of `step` (in the reading's unit)."""

    step: float

    def __post_init__(self):
        number("step", self.step, 0.0, open_low=True)

    @classmethod
    def encoder(cls, bits: int) -> Quantisation:
        """Absolute encoder with 2**`bits` steps a turn, in rad."""
        return cls(2 * np.pi / 2 ** integer("bits", bits, 1, 40))

    def apply(self, x, rng=None):
        """The reading `x`, rounded."""
        return np.round(np.asarray(x) / self.step) * self.step


@dataclass(frozen=True)
class Noise:
    """White Gaussian noise of standard deviation `std` (per joint, in the reading's unit)."""

    std: tuple[float, float]

    def __post_init__(self):
        non_negative("std", self.std, 2)

    def apply(self, x, rng):
        """The reading `x` with noise drawn from `rng` (a numpy Generator)."""
        return x + rng.standard_normal(np.shape(x)) * np.asarray(self.std)


@dataclass(frozen=True)
class Effects:
    """Everything between the rigid-body equations and what is written to the log.

    Parameters
    ----------
    friction : tuple of effects with ``torque(qd)``
        Opposes the motion, inside the plant.
    actuator : tuple of effects with ``apply(x, rng)``
        Between commanded and applied torque.
    encoder : tuple of effects with ``apply(x, rng)``
        Between true and measured position; the controller sees the measured one.
    torque_sensor : tuple of effects with ``apply(x, rng)``
        Between applied and logged torque.
    """

    friction: tuple = ()
    actuator: tuple = ()
    encoder: tuple = ()
    torque_sensor: tuple = ()

    def __post_init__(self):
        for part in ("friction", "actuator", "encoder", "torque_sensor"):
            method = "torque" if part == "friction" else "apply"
            effects = getattr(self, part)
            if not isinstance(effects, tuple) or not all(hasattr(e, method) for e in effects):
                raise TypeError(f"{part} must be a tuple of effects with {method}(), got {effects}")

    def friction_torque(self, qd) -> np.ndarray:
        """Sum of all friction torques (N m) at `qd` (rad/s), shape ``(..., joint)``."""
        total = np.zeros_like(qd)
        for effect in self.friction:
            total = total + effect.torque(qd)
        return total

    def without(self, *parts: str) -> Effects:
        """A copy with whole parts switched off.

        Parameters
        ----------
        *parts : {"friction", "actuator", "encoder", "torque_sensor"}

        Raises
        ------
        ValueError
            If a part is unknown.
        """
        known = ("friction", "actuator", "encoder", "torque_sensor")
        for part in parts:
            if part not in known:
                raise ValueError(f"parts must be among {known}, got {part!r}")
        return replace(self, **dict.fromkeys(parts, ()))


def pass_through(effects: tuple, x, rng) -> np.ndarray:
    """`x` after every one of the `effects` in turn; noise is drawn from `rng`."""
    for effect in effects:
        x = effect.apply(x, rng)
    return x


IDEAL = Effects()
"""No effect at all: the rigid-body arm with perfect sensors."""

CMU_DD_ARM_II_EFFECTS = Effects(
    friction=(ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15))),
    actuator=(Saturation((100.0, 30.0)),),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.163, 0.043)),),
)
"""Effects of the surrogate arm: every number is assumed.

The torque noise is 2.4 % of the standard deviation of the torques that
`ddlib.experiment.STATE_FEEDBACK` records: the share that the training errors of Table 4-1
leave room for.
"""
