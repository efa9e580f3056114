"""Serial arms in space, of any number of revolute joints.

Frames follow Denavit & Hartenberg: joint ``i`` turns about the z axis of frame ``i - 1``,
and frame ``i`` is fixed to the far end of link ``i``. Torques come from the three
formulations of `ddlib.dynamics.formulations`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, integer, number, shaped
from ddlib.dynamics.arm import STANDARD_GRAVITY, Link
from ddlib.dynamics.formulations import Constants, LinkConstants, newton_euler


@dataclass(frozen=True)
class SpatialLink:
    """A rigid link with a revolute joint, in Denavit-Hartenberg's parameters.

    Parameters
    ----------
    twist_deg : float
        Angle from its joint's axis to the next joint's, degrees.
    length, offset : float
        Distances between the axes and along the joint's axis, m.
    mass : float
        kg.
    com : array_like, shape (3,)
        Centre of mass in the link's frame, m. The origin is at the far end of the link.
    inertia : array_like, shape (3, 3)
        Inertia about the centre of mass in the link's frame, kg m^2, symmetric.

    Raises
    ------
    ValueError
        If a value is not finite, of the wrong shape or out of range.
    """

    twist_deg: float
    length: float
    offset: float
    mass: float
    com: tuple[float, float, float]
    inertia: tuple[tuple[float, ...], ...]

    def __post_init__(self):
        for name in ("twist_deg", "length", "offset"):
            number(name, getattr(self, name))
        number("mass", self.mass, 0.0)
        com, inertia = shaped("com", self.com, (3,)), finite_array("inertia", self.inertia, 3)
        if inertia.shape != (3, 3) or not np.array_equal(inertia, inertia.T):
            raise ValueError(f"inertia must be a symmetric 3 x 3 matrix, got {self.inertia}")
        object.__setattr__(self, "com", tuple(com.tolist()))
        object.__setattr__(self, "inertia", tuple(map(tuple, inertia.tolist())))

    def constants(self) -> LinkConstants:
        """What `ddlib.dynamics.formulations` needs of the link."""
        cos_twist, sin_twist = _cos_sin(self.twist_deg)
        tip = [self.length, self.offset * sin_twist, self.offset * cos_twist]
        inertia, point = np.array(self.inertia), np.append(self.com, 1.0)
        moments = self.mass * np.outer(point, point)
        moments[:3, :3] += np.trace(inertia) / 2 * np.eye(3) - inertia
        place = (cos_twist, sin_twist, self.length, self.offset, tip)
        return LinkConstants(*place, self.mass, self.com, self.inertia, moments.tolist())


@dataclass(frozen=True)
class SerialArm:
    """A chain of links, each turning about the axis at its near end.

    Parameters
    ----------
    links : iterable of SpatialLink
        From the base outwards.
    gravity : array_like, shape (3,)
        Acceleration of free fall in the base's frame, m/s^2.
    """

    links: tuple[SpatialLink, ...]
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self):
        links = tuple(self.links)
        if not links or not all(isinstance(link, SpatialLink) for link in links):
            raise TypeError(f"links must be one or more SpatialLink, got {self.links!r}")
        object.__setattr__(self, "links", links)
        object.__setattr__(self, "gravity", tuple(shaped("gravity", self.gravity, (3,)).tolist()))

    @classmethod
    def planar(cls, links: Iterable[Link], gravity: float = 0.0) -> SerialArm:
        """An arm whose axes are parallel, with the conventions of `ddlib.dynamics.arm.Arm`.

        Parameters
        ----------
        links : iterable of Link
            From the shoulder outwards.
        gravity : float
            Acceleration of free fall along the x axis, m/s^2: angles count from hanging.
        """
        spatial = (
            SpatialLink(
                0.0, k.length, 0.0, k.mass, (k.com - k.length, 0.0, 0.0), np.diag([0, 0, k.inertia])
            )
            for k in links
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
        """Torque that produces acceleration `qdd` in state `q`, `qd`.

        Parameters
        ----------
        q, qd, qdd : array_like, shape (..., joints)
            Angles (rad), velocities (rad/s), accelerations (rad/s^2).
        formulation : callable
            `newton_euler`, `lagrange_euler` or `recursive_lagrange` of
            `ddlib.dynamics.formulations`: they agree, at different cost.

        Returns
        -------
        ndarray, shape (..., joints)
            Torques, N m.
        """
        state = (finite_array(n, x, self.joints) for n, x in (("q", q), ("qd", qd), ("qdd", qdd)))
        state = np.broadcast_arrays(*state)
        tau = formulation(self.constants(), *(np.moveaxis(x, -1, 0) for x in state))
        return np.stack([t + np.zeros(state[0].shape[:-1]) for t in tau], -1)

    def constants(self, make: Callable = float) -> Constants:
        """What `ddlib.dynamics.formulations` needs, every number made by `make`.

        The base of an arm under gravity accelerates upwards instead of every link falling.
        """
        links = [_each(make, link.constants()) for link in self.links]
        base = _each(make, [-g for g in self.gravity])
        return Constants([LinkConstants(*values) for values in links], base)


def _each(make, x):
    """`make` applied to every number of nested sequences."""
    return [_each(make, part) for part in x] if isinstance(x, (list, tuple)) else make(x)


def _cos_sin(degrees: float):
    """Cosine and sine, exact where they are -1, 0 or 1."""
    quarters, rest = divmod(degrees, 90.0)
    if rest == 0.0:
        return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarters) % 4]
    return float(np.cos(np.deg2rad(degrees))), float(np.sin(np.deg2rad(degrees)))


def _link(twist, length, offset, mass, com, moments) -> SpatialLink:
    return SpatialLink(twist, length, offset, mass, com, np.diag(moments))


PUMA_560 = SerialArm(
    (
        _link(90.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.35, 0.0)),
        _link(0.0, 0.4318, 0.0, 17.4, (-0.3638, 0.006, 0.2275), (0.13, 0.524, 0.539)),
        _link(-90.0, 0.0203, 0.15005, 4.8, (-0.0203, -0.0141, 0.070), (0.066, 0.086, 0.0125)),
        _link(90.0, 0.0, 0.4318, 0.82, (0.0, 0.019, 0.0), (1.8e-3, 1.3e-3, 1.8e-3)),
        _link(-90.0, 0.0, 0.0, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.4e-3, 0.3e-3)),
        _link(0.0, 0.0, 0.0, 0.09, (0.0, 0.0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3)),
    ),
    gravity=(0.0, 0.0, -STANDARD_GRAVITY),
)
"""The most studied geared arm, without its motors (Corke & Armstrong-Helouvry 1994)."""

PUMA_560_ROTORS = (200e-6, 200e-6, 200e-6, 33e-6, 33e-6, 33e-6)
"""Inertia of its motors' rotors, kg m^2 (Corke & Armstrong-Helouvry 1994)."""

PUMA_560_GEARS = (62.6111, 107.815, 53.7063, 76.0364, 71.923, 76.686)
"""Its gear ratios (Corke & Armstrong-Helouvry 1994)."""
