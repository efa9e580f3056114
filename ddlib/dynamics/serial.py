"""Serial arms in space, of any number of revolute joints.

Frames follow Denavit & Hartenberg: joint ``i`` turns about the z axis of frame ``i - 1``,
and frame ``i`` is fixed to the far end of link ``i``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, function_of, integer, number, series, shaped, told
from ddlib.dynamics.arm import STANDARD_GRAVITY, Link, checked_state
from ddlib.dynamics.formulations import ArmConstants, LinkConstants, newton_euler


@dataclass(frozen=True)
class SpatialLink:
    """A rigid link with a revolute joint, in Denavit-Hartenberg's parameters."""

    twist_deg: float  #: Angle from its joint's axis to the next joint's, degrees.
    length: float  #: Distance between the axes, m.
    offset: float  #: Distance along the joint's axis, m.
    mass: float  #: kg
    com: tuple[float, float, float]  #: Centre of mass, m, from the frame at the link's far end.
    inertia: tuple[tuple[float, ...], ...]  #: About the centre of mass, kg m^2, symmetric.

    def __post_init__(self):
        for name in ("twist_deg", "length", "offset"):
            number(name, getattr(self, name))
        number("mass", self.mass, 0.0)
        com, inertia = shaped("com", self.com, (3,)), finite_array("inertia", self.inertia, 3)
        if inertia.shape != (3, 3) or not np.array_equal(inertia, inertia.T):
            raise ValueError(f"inertia must be a symmetric 3 x 3 matrix, got {told(self.inertia)}")
        if np.linalg.eigvalsh(inertia)[0] < -1e-9 * np.abs(inertia).max():
            raise ValueError(
                "inertia must have no negative principal moment, got "
                f"{np.linalg.eigvalsh(inertia)[0]:.3g} kg m^2 in {told(inertia.tolist())}"
            )
        object.__setattr__(self, "com", tuple(com.tolist()))
        object.__setattr__(self, "inertia", tuple(map(tuple, inertia.tolist())))

    def constants(self) -> LinkConstants:
        """What the formulations of inverse dynamics need of the link."""
        cos_twist, sin_twist = _cos_sin(self.twist_deg)
        tip = [self.length, self.offset * sin_twist, self.offset * cos_twist]
        inertia, point = np.array(self.inertia), np.append(self.com, 1.0)
        # second moments of mass from the tensor of inertia: integral r r' = tr(I)/2 - I
        moments = self.mass * np.outer(point, point)
        moments[:3, :3] += np.trace(inertia) / 2 * np.eye(3) - inertia
        place = (cos_twist, sin_twist, self.length, self.offset, tip)
        return LinkConstants(*place, self.mass, self.com, self.inertia, moments.tolist())


@dataclass(frozen=True)
class SerialArm:
    """A chain of links, each turning about the axis at its near end."""

    links: tuple[SpatialLink, ...]  #: From the base outwards.
    #: Acceleration of free fall in the base's frame, m/s^2.
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self):
        links = tuple(series("links", self.links, SpatialLink))
        if not links:
            raise ValueError("links must be one or more, got none")
        object.__setattr__(self, "links", links)
        object.__setattr__(self, "gravity", tuple(shaped("gravity", self.gravity, (3,)).tolist()))

    @classmethod
    def planar(cls, links: Iterable[Link], gravity: float = 0.0) -> SerialArm:
        """An arm of parallel axes; angles count from hanging along the x axis, as in `Arm`."""
        number("gravity", gravity)
        spatial = (
            SpatialLink(
                0.0, k.length, 0.0, k.mass, (k.com - k.length, 0.0, 0.0), np.diag([0, 0, k.inertia])
            )
            for k in series("links", links, Link)
        )
        return cls(tuple(spatial), (gravity, 0.0, 0.0))

    @property
    def joints(self) -> int:
        """Number of joints."""
        return len(self.links)

    def first(self, joints: int) -> SerialArm:
        """The arm cut off after so many joints."""
        integer("joints", joints, 1, self.joints)
        return SerialArm(self.links[:joints], self.gravity)

    def inverse_dynamics(self, q, qd, qdd, formulation: Callable = newton_euler) -> np.ndarray:
        """Torque (N m) that produces `qdd` in state `q`, `qd`, each ``(..., joints)`` in rad and s.

        `formulation` is `newton_euler`, `lagrange_euler` or `recursive_lagrange`: they agree, at
        different cost.
        """
        function_of("formulation", formulation, "like newton_euler")
        state = checked_state(q, qd, qdd, self.joints)
        tau = formulation(self.constants(), *(np.moveaxis(x, -1, 0) for x in state))
        return np.stack([t + np.zeros(state[0].shape[:-1]) for t in tau], -1)

    def constants(self, make: Callable = float) -> ArmConstants:
        """What the formulations need of the arm, every number made by `make`."""
        links = [_each(make, link.constants()) for link in self.links]
        # under gravity the base accelerates upwards, instead of every link falling
        base = _each(make, [-g for g in self.gravity])
        return ArmConstants([LinkConstants(*values) for values in links], base)


def _each(make, x):
    """`make` applied to every number of nested sequences."""
    return [_each(make, part) for part in x] if isinstance(x, (list, tuple)) else make(x)


def _cos_sin(degrees: float):
    """Cosine and sine, exact where they are -1, 0 or 1."""
    quarters, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return float(np.cos(np.deg2rad(degrees))), float(np.sin(np.deg2rad(degrees)))


_PUMA_560_LINKS = (  # twist (degrees), length, offset, mass, centre, diagonal of the inertia
    (90.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.35, 0.0)),
    (0.0, 0.4318, 0.0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
    (-90.0, 0.0203, 0.15005, 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.086, 0.0125)),
    (90.0, 0.0, 0.4318, 0.82, (0.0, 0.019, 0.0), (1.8e-3, 1.3e-3, 1.8e-3)),
    (-90.0, 0.0, 0.0, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.4e-3, 0.3e-3)),
    (0.0, 0.0, 0.0, 0.09, (0.0, 0.0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
)
PUMA_560 = SerialArm(
    tuple(SpatialLink(*place, np.diag(moments)) for *place, moments in _PUMA_560_LINKS),
    gravity=(0.0, 0.0, -STANDARD_GRAVITY),
)
"""The most studied geared arm, without its motors (Corke & Armstrong-Helouvry 1994)."""

#: Inertia of its motors' rotors, kg m^2 (Corke & Armstrong-Helouvry 1994).
PUMA_560_ROTORS = (200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6)
#: Its gear ratios (Corke & Armstrong-Helouvry 1994).
PUMA_560_GEARS = (62.6111, 107.815, 53.7063, 76.0364, 71.923, 76.686)
