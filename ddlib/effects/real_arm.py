"""Sensors, and `Effects`: all effects in the order in which a signal meets them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import finite_array, integer, non_negative, number, one_of, told
from ddlib.effects.actuators import ComputingTime, Saturation
from ddlib.effects.friction import CoulombFriction, ViscousFriction


@dataclass(frozen=True)
class Quantisation:
    """A reading rounded to the nearest multiple of `step`."""

    step: float  #: In the reading's unit.

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
class EncoderZero:
    """A shift of the readings by `angle` (rad, ``(..., joint)``): where an encoder's zero lies."""

    angle: tuple[float, ...]

    def apply(self, x, rng=None):
        """The reading `x`, shifted."""
        return x + np.asarray(finite_array("angle", self.angle, np.shape(x)[-1]))


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
class Delay:
    """A signal that arrives `periods` samples late (whole control periods, 0 or more)."""

    periods: int

    def __post_init__(self):
        integer("periods", self.periods, 0)

    def start(self, initial):
        """The delay of one run, ``late(x, rng)``; it gives `initial` at first."""
        waiting = deque([initial] * self.periods)

        def late(x, rng=None):
            waiting.append(x)
            return waiting.popleft()

        return late


@dataclass(frozen=True)
class Backlash:
    """Play of a gear between joint and encoder: the reading follows when a tooth touches.

    The play operator (Krasnosel'skii & Pokrovskii 1989): with the joint at x the reading stays as
    long as it is within ``gap / 2`` of x, and is dragged along otherwise. `FlexibleJoint` has play
    with the motor's motion.
    """

    gap: tuple[float, float]  #: Whole play, rad per joint.

    def __post_init__(self):
        non_negative("gap", self.gap, 2)

    def start(self, initial):
        """The play of one run, ``play(x, rng)``, centred on `initial` at first."""
        half, held = np.asarray(self.gap) / 2, initial

        def play(x, rng=None):
            nonlocal held
            held = np.clip(held, x - half, x + half)
            return held

        return play


_METHODS = {
    "friction": ("torque",),
    "actuator": ("apply", "start"),
    "encoder": ("apply", "start"),
    "torque_sensor": ("apply", "start"),
    "motor": ("shaft_torque",),
    "transmission": ("spring_torque",),
}


@dataclass(frozen=True, repr=False)
class Effects:
    """Everything between the rigid-body equations and what is written to the log.

    Each part is a tuple of effects, in the order in which a signal meets them: frictions with
    ``torque(qd)``, motors with ``shaft_torque(tau, q)``, others with ``apply(x, rng)`` or, if they
    have a memory, ``start(initial)``.
    """

    friction: tuple = ()  #: Opposes the motion, inside the plant.
    actuator: tuple = ()  #: Between commanded and applied torque.
    encoder: tuple = ()  #: Between true and measured position, which the controller sees.
    torque_sensor: tuple = ()  #: Between applied and logged torque.
    motor: tuple = ()  #: Between applied torque, which is a current, and torque on the shaft.
    transmission: tuple = ()  #: One `FlexibleJoint` between motor and link, or none.

    def __repr__(self):
        parts = [f"{name}={part}" for name, part in vars(self).items() if part]
        return f"Effects({', '.join(parts) or 'none'})"

    def __post_init__(self):
        for part, methods in _METHODS.items():
            effects = getattr(self, part)
            if not isinstance(effects, tuple) or not all(_fits(e, part) for e in effects):
                names = " or ".join(f"{m}()" for m in methods)
                raise TypeError(
                    f"{part} must be a tuple of effects with {names}, got {told(effects)}"
                )
        if len(self.transmission) > 1:
            raise ValueError(
                f"transmission must hold one effect at most, got {told(self.transmission)}"
            )

    @property
    def computing_time(self) -> float:
        """Time between reading and torque, s: the sum over the actuator's `ComputingTime`."""
        return sum(e.seconds for e in self.actuator if isinstance(e, ComputingTime))

    def friction_torque(self, qd) -> np.ndarray:
        """Sum of all friction torques (N m) at `qd` (rad/s), shape ``(..., joint)``."""
        torques = [effect.torque(qd) for effect in self.friction]
        return sum(torques[1:], torques[0]) if torques else np.zeros_like(qd)

    def without(self, *parts: str) -> Effects:
        """A copy with whole parts (``"friction"``, ``"encoder"``, ...) switched off."""
        for part in parts:
            one_of("parts", part, tuple(_METHODS))
        return replace(self, **dict.fromkeys(parts, ()))


def _fits(effect, part: str) -> bool:
    """Whether an effect can stand in a part of `Effects`."""
    if isinstance(effect, ComputingTime) and part != "actuator":
        return False
    return any(hasattr(effect, method) for method in _METHODS[part])


def signal_path(effects: tuple, initial) -> Callable:
    """A signal path ``path(x, rng)``, whose memories hold `initial` (..., 2) at first."""
    steps = [e.start(initial) if hasattr(e, "start") else e.apply for e in effects]

    def path(x, rng):
        for step in steps:
            x = step(x, rng)
        return x

    return path


IDEAL = Effects()  #: No effect at all: the rigid-body arm with perfect sensors.

CMU_DD_ARM_II_EFFECTS = Effects(
    friction=(ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15))),
    actuator=(Saturation((100.0, 30.0)),),
    encoder=(Quantisation.encoder(16),),
    torque_sensor=(Noise((0.163, 0.043)),),
)
"""Effects of the surrogate arm: every number is assumed.

The torque noise is 2.4 % of the standard deviation of the torques in the paper's set-up: the share
that the training errors of Table 4-1 leave room for.
"""
