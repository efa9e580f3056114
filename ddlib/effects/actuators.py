"""What stands between the commanded torque and the joint: amplifier, motor, shaft and gears."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ddlib._check import finite_array, instance, non_negative, number, positive
from ddlib.dynamics import Arm


@dataclass(frozen=True)
class Saturation:
    """Torque limited to plus or minus `limit`."""

    limit: tuple[float, float]  #: N m per joint.

    def __post_init__(self):
        positive("limit", self.limit)

    def apply(self, x, rng=None):
        """The torque `x` (N m), clipped."""
        limit = np.asarray(self.limit)
        return np.clip(x, -limit, limit)

    def inverse(self, y) -> np.ndarray:
        """The torque to command for `y` (N m): `y` itself, refused beyond the limit."""
        y = finite_array("y", y, 2)
        if (np.abs(y) > np.asarray(self.limit)).any():
            raise ValueError(f"y must lie within plus or minus {self.limit} N m, got {y.tolist()}")
        return y


@dataclass(frozen=True)
class DeadZone:
    """The first `width` of a torque, either way, are lost: ``x - width`` beyond, 0 within."""

    width: tuple[float, float]  #: N m per joint.

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
class Load:
    """A constant torque that disturbs the joints, as an effect of the actuator."""

    torque: tuple[float, float]  #: N m per joint, (2,) or (runs, 2).

    def __post_init__(self):
        finite_array("torque", self.torque, 2)

    def apply(self, x, rng=None):
        """The torque `x` (N m) and the load."""
        return x + np.asarray(self.torque)


@dataclass(frozen=True)
class Ripple:
    """Shaft torque ``tau (1 + share sin(cycles q + phase)) + cogging sin(cycles q + phase)``.

    The magnets of a motor pull at the teeth of its iron (cogging) even without a current; the share
    is what its windings add.
    """

    cogging: tuple[float, float] = (0.0, 0.0)  #: Amplitude, N m per joint.
    share: tuple[float, float] = (0.0, 0.0)  #: Amplitude relative to the torque, 0 to 1.
    cycles: tuple[int, int] = (60, 60)  #: Whole number of waves a turn.
    phase: float = 0.0  #: Angle of the wave at ``q = 0``, rad.

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
    """A springy shaft, with or without play, between the motor and its link (Spong 1987).

    The motor's inertia is taken out of the arm and put in front of the spring. The elbow's motor
    rides on link 1 and turns with it. Friction, ripple and the encoder stay at the motor.
    """

    stiffness: tuple[float, float]  #: N m/rad per joint, (2,) or (runs, 2).
    motor_inertia: tuple[float, float]  #: kg m^2 per joint; part of the arm's own inertia.
    damping: tuple[float, float] = (0.0, 0.0)  #: Of the twist, N m s/rad.
    gap: tuple[float, float] = (0.0, 0.0)  #: Play, rad, between the motor's two contacts.

    def __post_init__(self):
        positive("stiffness", self.stiffness)
        positive("motor_inertia", self.motor_inertia, (2,))
        non_negative("damping", self.damping, 2)
        non_negative("gap", self.gap, 2)

    def spring_torque(self, twist, rate) -> np.ndarray:
        """Torque from motor to link (N m) at `twist` (rad), motor minus link, and its `rate`."""
        half = np.asarray(self.gap) / 2
        pressed = twist - np.clip(twist, -half, half)
        touching = (pressed != 0) | (np.asarray(self.gap) == 0)
        return np.asarray(self.stiffness) * pressed + np.asarray(self.damping) * rate * touching

    def links(self, arm: Arm) -> Arm:
        """The `arm` without its motors' inertia: what hangs behind the springs."""
        instance("arm", arm, Arm)
        shoulder, elbow = self.motor_inertia
        try:
            return replace(arm, a=arm.a - shoulder - elbow, d=arm.d - elbow)
        except ValueError as error:
            raise ValueError(
                f"motor_inertia must be part of the inertia of {arm.name}, got {self.motor_inertia}"
            ) from error

    def mass_matrix(self, arm: Arm, q) -> np.ndarray:
        """Mass matrix (..., 4, 4), kg m^2, of both links, then both motors; `q`: link angles."""
        links = self.links(arm).mass_matrix(q)
        shoulder, elbow = self.motor_inertia
        mass = np.zeros((*links.shape[:-2], 4, 4))
        mass[..., :2, :2] = links
        mass[..., 0, 0] += elbow  # carried by link 1
        mass[..., 2, 2], mass[..., 3, 3] = shoulder, elbow
        mass[..., 0, 3] = mass[..., 3, 0] = elbow
        return mass

    def mode_frequencies(self, arm: Arm, q) -> np.ndarray:
        """Natural frequencies (..., 2) of small twists at link angles `q`, rad/s, rising."""
        k = np.asarray(self.stiffness, dtype=float)[..., None] * np.eye(2)
        spring = np.block([[k, -k], [-k, k]])
        # modes of M x'' + K x = 0; two are rigid rotations of frequency 0
        squared = np.linalg.eigvals(np.linalg.solve(self.mass_matrix(arm, q), spring)).real
        return np.sqrt(np.sort(squared, axis=-1)[..., 2:])


@dataclass(frozen=True)
class ComputingTime:
    """Time between reading the sensors and applying the torque computed from them.

    Khosla's customised dynamics take 1.2 ms of 2 (paper, section 1.1).
    """

    seconds: float  #: Shorter than the control period; `Delay` adds whole periods.

    def __post_init__(self):
        number("seconds", self.seconds, 0.0)

    def apply(self, x, rng=None):
        """The torque `x` (N m) itself: only its time changes, which is the plant's business."""
        return x
