"""What stands between the commanded torque and the joint: amplifier, motor, shaft and gears.

Small frozen objects; every value is per joint, shape ``(2,)``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import finite_array, non_negative, number, positive


@dataclass(frozen=True)
class Saturation:
    """Torque limited to plus or minus `limit` (N m per joint, shape (2,))."""

    limit: tuple[float, float]

    def __post_init__(self):
        positive("limit", self.limit)

    def apply(self, x, rng=None):
        """The torque `x` (N m), clipped."""
        limit = np.asarray(self.limit)
        return np.clip(x, -limit, limit)

    def inverse(self, y) -> np.ndarray:
        """The torque to command for `y` (N m): `y` itself, where the actuator can give it.

        Raises
        ------
        ValueError
            If `y` is beyond the limit.
        """
        y = finite_array("y", y, 2)
        if (np.abs(y) > np.asarray(self.limit)).any():
            raise ValueError(f"y must lie within plus or minus {self.limit} N m, got {y.tolist()}")
        return y


@dataclass(frozen=True)
class DeadZone:
    """The first `width` N m of a torque, either way, are lost (per joint, shape (2,)).

    What is left starts from zero: ``x - width`` for ``x > width``, 0 within.
    """

    width: tuple[float, float]

    def __post_init__(self):
        non_negative("width", self.width, 2)

    def apply(self, x, rng=None):
        """The torque `x` (N m), less what is lost."""
        width = np.asarray(self.width)
        return x - np.clip(x, -width, width)

    def inverse(self, y) -> np.ndarray:
        """The torque to command for `y` (N m); 0 for 0, out of all that the zone swallows."""
        y = finite_array("y", y, 2)
        return y + np.asarray(self.width) * np.sign(y)


@dataclass(frozen=True)
class Ripple:
    """Shaft torque that varies with the motor's angle, over `cycles` equal waves a turn.

    ``tau (1 + share sin(cycles q + phase)) + cogging sin(cycles q + phase)``. The magnets of
    a motor pull at the teeth of its iron with the `cogging` torque even without a current;
    the `share` is what its windings add, in proportion to the current.

    Parameters
    ----------
    cogging : array_like, shape (2,)
        Amplitude, N m per joint, not negative.
    share : array_like, shape (2,)
        Amplitude relative to the commanded torque, 0 to 1.
    cycles : array_like, shape (2,)
        Whole number of waves a turn, 1 or more.
    phase : float
        Angle of the wave at ``q = 0``, rad.
    """

    cogging: tuple[float, float] = (0.0, 0.0)
    share: tuple[float, float] = (0.0, 0.0)
    cycles: tuple[int, int] = (60, 60)
    phase: float = 0.0

    def __post_init__(self):
        non_negative("cogging", self.cogging, 2)
        if (non_negative("share", self.share, 2) > 1).any():
            raise ValueError(f"share must lie in [0, 1], got {self.share}")
        cycles = positive("cycles", self.cycles)
        if (cycles != np.round(cycles)).any():
            raise ValueError(f"cycles must be whole numbers, got {self.cycles}")
        number("phase", self.phase)

    def shaft_torque(self, tau, q) -> np.ndarray:
        """Torque on the shaft (N m) at motor angles `q` (rad) when `tau` is commanded."""
        wave = np.sin(np.asarray(self.cycles) * q + self.phase)
        return tau + (np.asarray(self.share) * tau + np.asarray(self.cogging)) * wave


@dataclass(frozen=True)
class FlexibleJoint:
    """A springy shaft, with or without play, between the motor and its link.

    The motor's inertia is taken out of the arm and put in front of the spring, so that a
    stiff shaft gives back the rigid arm. The elbow's motor rides on link 1 and turns with
    it. Friction, ripple and the encoder stay at the motor. (Spong 1987, without his
    assumption of high gear ratios.)

    Parameters
    ----------
    stiffness : array_like, shape (2,) or (..., 2)
        N m/rad per joint, positive.
    motor_inertia : array_like, shape (2,)
        kg m^2 per joint, positive; part of the arm's own inertia.
    damping : array_like, shape (2,) or (..., 2)
        Of the twist, N m s/rad.
    gap : array_like, shape (2,) or (..., 2)
        Play (backlash), rad: the motor turns this far between its two contacts.
    """

    stiffness: tuple[float, float]
    motor_inertia: tuple[float, float]
    damping: tuple[float, float] = (0.0, 0.0)
    gap: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self):
        positive("stiffness", self.stiffness)
        positive("motor_inertia", self.motor_inertia, (2,))
        non_negative("damping", self.damping, 2)
        non_negative("gap", self.gap, 2)

    def _pressed(self, twist):
        half = np.asarray(self.gap) / 2
        return twist - np.clip(twist, -half, half)

    def spring_torque(self, twist, rate) -> np.ndarray:
        """Torque from motor to link (N m) at `twist` (rad), motor minus link, and its `rate`."""
        pressed = self._pressed(twist)
        touching = (pressed != 0) | (np.asarray(self.gap) == 0)
        return np.asarray(self.stiffness) * pressed + np.asarray(self.damping) * rate * touching

    def energy(self, twist) -> np.ndarray:
        """Energy in the springs at `twist` (rad, ``(..., 2)``), J, shape ``(...)``."""
        return 0.5 * (np.asarray(self.stiffness) * self._pressed(twist) ** 2).sum(-1)

    def links(self, arm):
        """The `arm` without its motors' inertia: what hangs behind the springs.

        Raises
        ------
        ValueError
            If the arm's inertia is not larger than the motors'.
        """
        shoulder, elbow = self.motor_inertia
        try:
            return replace(arm, a=arm.a - shoulder - elbow, d=arm.d - elbow)
        except ValueError as error:
            raise ValueError(
                f"motor_inertia must be part of the inertia of {arm.name}, got {self.motor_inertia}"
            ) from error

    def mass_matrix(self, arm, q) -> np.ndarray:
        """Mass matrix of links and motors of `arm`, kg m^2, shape ``(..., 4, 4)``.

        Coordinates: the two link angles, then the two motor angles. `q` holds link angles,
        rad, ``(..., 2)``.
        """
        links = self.links(arm).mass_matrix(q)
        shoulder, elbow = self.motor_inertia
        mass = np.zeros((*links.shape[:-2], 4, 4))
        mass[..., :2, :2] = links
        mass[..., 0, 0] += elbow  # carried by link 1
        mass[..., 2, 2], mass[..., 3, 3] = shoulder, elbow
        mass[..., 0, 3] = mass[..., 3, 0] = elbow
        return mass

    def mode_frequencies(self, arm, q) -> np.ndarray:
        """Natural frequencies (rad/s) of the twists of `arm` at link angles `q` (rad).

        Small swings without damping or play, the motors free; shape ``(..., 2)``, rising.
        """
        k = np.asarray(self.stiffness, dtype=float)[..., None] * np.eye(2)
        spring = np.block([[k, -k], [-k, k]])
        squared = np.linalg.eigvals(np.linalg.solve(self.mass_matrix(arm, q), spring)).real
        return np.sqrt(np.sort(squared, axis=-1)[..., 2:])


@dataclass(frozen=True)
class ComputingTime:
    """Time between reading the sensors and applying the torque computed from them.

    Parameters
    ----------
    seconds : float
        Not negative and shorter than the control period; `ddlib.effects.real_arm.Delay` adds whole
        periods. Khosla's customised dynamics take 1.2 ms of 2 (paper, section 1.1).
    """

    seconds: float

    def __post_init__(self):
        number("seconds", self.seconds, 0.0)

    def apply(self, x, rng=None):
        """The torque `x` (N m) itself: only its time changes, which is the plant's business."""
        return x
