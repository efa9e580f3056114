"""Rigid-body dynamics of a two-link arm: ``M(q) qdd + C(q, qd) qd + g(q) = tau``."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ddlib._check import finite_array, instance, non_negative, number, shaped, text

STANDARD_GRAVITY = 9.81  #: Acceleration of free fall, m/s^2.


@dataclass(frozen=True)
class Link:
    """A rigid link: mass (kg), length (m), centre of mass (m from its joint), inertia (kg m^2).

    The inertia is about the centre of mass, about an axis parallel to the joint's.
    """

    mass: float
    length: float
    com: float
    inertia: float

    def __post_init__(self):
        for name in ("mass", "length", "com", "inertia"):
            number(name, getattr(self, name), 0.0)


@dataclass(frozen=True)
class Arm:
    """A planar two-link arm, reduced to its base parameters.

    All methods take angles `q` (rad), velocities `qd` (rad/s) and accelerations `qdd` (rad/s^2)
    as arrays ``(..., 2)``, shoulder first; under gravity angles count from hanging straight down.
    """

    name: str  #: What tables and figures call it.
    a: float  #: Base inertial parameters, kg m^2: ``M11 = a + 2 b cos q2``,
    b: float  #: ``M12 = d + b cos q2``,
    d: float  #: ``M22 = d``.
    lengths: tuple[float, float]  #: Of the links, m (for drawing and kinematics only).
    gravity_moments: tuple[float, float] = (0.0, 0.0)  #: ``((m1 lc1 + m2 l1) g, m2 lc2 g)``, N m.
    #: For each quantity, where its value comes from.
    provenance: dict[str, str] = field(default_factory=dict, compare=False, repr=False)

    def __post_init__(self):
        text("name", self.name)
        for name in ("a", "b", "d"):
            number(name, getattr(self, name))
        non_negative("lengths", self.lengths)
        for name in ("lengths", "gravity_moments"):
            object.__setattr__(self, name, tuple(shaped(name, getattr(self, name), (2,)).tolist()))
        # det M = a d - d^2 - b^2 cos^2 q2, least with the elbow straight or folded
        if not (self.d > 0 and self.a * self.d > self.d**2 + self.b**2):
            raise ValueError(
                "a, b, d must make the mass matrix positive definite "
                f"(d > 0 and a d > d^2 + b^2), got a={self.a}, b={self.b}, d={self.d}"
            )

    @classmethod
    def from_links(cls, name, link1: Link, link2: Link, gravity=0.0, provenance=()) -> Arm:
        """Arm of two links (upper arm, forearm) under `gravity` (m/s^2; 0 in a horizontal plane).

        ``a = I1 + m1 lc1^2 + m2 l1^2 + d``, ``b = m2 l1 lc2`` and ``d = I2 + m2 lc2^2``.
        """
        instance("link1", link1, Link)
        instance("link2", link2, Link)
        number("gravity", gravity)
        d = link2.inertia + link2.mass * link2.com**2
        a = link1.inertia + link1.mass * link1.com**2 + link2.mass * link1.length**2 + d
        b = link2.mass * link1.length * link2.com
        moments = (
            gravity * (link1.mass * link1.com + link2.mass * link1.length),
            gravity * link2.mass * link2.com,
        )
        return cls(name, a, b, d, (link1.length, link2.length), moments, dict(provenance))

    def mass_matrix(self, q) -> np.ndarray:
        """Mass matrix M(q) in kg m^2, shape ``(..., 2, 2)``, symmetric positive definite."""
        c2 = np.cos(finite_array("q", q, 2)[..., 1])
        m12 = self.d + self.b * c2
        m11 = self.a + 2 * self.b * c2
        m22 = np.full_like(c2, self.d)
        return np.stack([np.stack([m11, m12], -1), np.stack([m12, m22], -1)], -2)

    def coriolis_matrix(self, q, qd) -> np.ndarray:
        """Coriolis and centrifugal matrix C(q, qd), shape ``(..., 2, 2)``, N m s/rad.

        Built from Christoffel symbols, so that ``dM/dt - 2 C`` is skew-symmetric.
        """
        q, qd = finite_array("q", q, 2), finite_array("qd", qd, 2)
        h = self.b * np.sin(q[..., 1])
        row1 = np.stack([-h * qd[..., 1], -h * (qd[..., 0] + qd[..., 1])], -1)
        row2 = np.stack([h * qd[..., 0], np.zeros_like(h * qd[..., 0])], -1)
        return np.stack([row1, row2], -2)

    def gravity(self, q) -> np.ndarray:
        """Gravity torque g(q) in N m, shape ``(..., 2)``; zero for a horizontal arm."""
        return self._gravity(finite_array("q", q, 2))

    def _gravity(self, q) -> np.ndarray:
        """`gravity` without checks, for the inner loop of a simulation."""
        g1, g2 = self.gravity_moments
        elbow = g2 * np.sin(q[..., 0] + q[..., 1])
        return np.stack([g1 * np.sin(q[..., 0]) + elbow, elbow], -1)

    def inverse_dynamics(self, q, qd, qdd) -> np.ndarray:
        """Torque in N m that produces `qdd` in state `q`, `qd` (Lagrange-Euler), shape (..., 2)."""
        return sum(self.torque_terms(q, qd, qdd).values())

    def torque_terms(self, q, qd, qdd) -> dict[str, np.ndarray]:
        """The torque of `inverse_dynamics` by physical origin, each ``(..., 2)`` in N m.

        ``coupling`` is that of the off-diagonal inertia.
        """
        q, qd, qdd = checked_state(q, qd, qdd)
        c2, h = np.cos(q[..., 1]), self.b * np.sin(q[..., 1])
        m12 = self.d + self.b * c2
        v1, v2 = qd[..., 0], qd[..., 1]
        return {
            "inertial": np.stack(
                [(self.a + 2 * self.b * c2) * qdd[..., 0], self.d * qdd[..., 1]], -1
            ),
            "coupling": np.stack([m12 * qdd[..., 1], m12 * qdd[..., 0]], -1),
            "centrifugal": np.stack([-h * v2**2, h * v1**2], -1),
            "coriolis": np.stack([-2 * h * v1 * v2, np.zeros_like(h * v1)], -1),
            "gravity": self.gravity(q),
        }

    def forward_dynamics(self, q, qd, tau) -> np.ndarray:
        """Acceleration in rad/s^2 under net joint torques `tau` (N m), both ``(..., 2)``."""
        q, qd = finite_array("q", q, 2), finite_array("qd", qd, 2)
        tau = finite_array("tau", tau, 2)
        return self._acceleration(q, qd, tau)

    def _acceleration(self, q, qd, tau) -> np.ndarray:
        """`forward_dynamics` without checks, for the inner loop of a simulation."""
        # M qdd = tau - C qd - g, solved by Cramer's rule
        c2, h = np.cos(q[..., 1]), self.b * np.sin(q[..., 1])
        v1, v2 = qd[..., 0], qd[..., 1]
        r1 = tau[..., 0] + h * v2 * (2 * v1 + v2)
        r2 = tau[..., 1] - h * v1 * v1
        if self.gravity_moments != (0.0, 0.0):
            weight = self._gravity(q)
            r1, r2 = r1 - weight[..., 0], r2 - weight[..., 1]
        m11, m12 = self.a + 2 * self.b * c2, self.d + self.b * c2
        determinant = m11 * self.d - m12 * m12
        numerators = self.d * r1 - m12 * r2, m11 * r2 - m12 * r1
        qdd = np.empty((2, *np.shape(numerators[0])))  # joint by joint: contiguous over runs
        for joint, numerator in enumerate(numerators):
            np.divide(numerator, determinant, out=qdd[joint, ...])
        return qdd.transpose(*range(1, qdd.ndim), 0)

    def kinetic_energy(self, q, qd) -> np.ndarray:
        """Kinetic energy ``qd' M(q) qd / 2`` in J, shape ``(...)``."""
        qd = finite_array("qd", qd, 2)
        return 0.5 * np.einsum("...i,...ij,...j", qd, self.mass_matrix(q), qd)

    def potential_energy(self, q) -> np.ndarray:
        """Potential energy in J, zero for a horizontal arm, shape ``(...)``."""
        q = finite_array("q", q, 2)
        g1, g2 = self.gravity_moments
        return -g1 * np.cos(q[..., 0]) - g2 * np.cos(q[..., 0] + q[..., 1])

    @staticmethod
    def regressor(q, qd, qdd) -> np.ndarray:
        """Matrix Y with ``tau = Y @ [a, b, d, g1, g2]``, shape ``(..., 2, 5)``, for every arm.

        That torque is linear in these is what identification rests on (An 1988; Khosla 1986).
        """
        q, qd, qdd = checked_state(q, qd, qdd)
        c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
        (v1, v2), (a1, a2) = np.moveaxis(qd, -1, 0), np.moveaxis(qdd, -1, 0)
        s1, s12, zero = np.sin(q[..., 0]), np.sin(q[..., 0] + q[..., 1]), np.zeros_like(a1 * c2)
        row1 = [a1 + zero, c2 * (2 * a1 + a2) - s2 * v2 * (2 * v1 + v2), a2 + zero, s1, s12]
        row2 = [zero, c2 * a1 + s2 * v1**2, a1 + a2, zero, s12]
        return np.stack([np.stack(row1, -1), np.stack(row2, -1)], -2)

    def forward_kinematics(self, q) -> np.ndarray:
        """Elbow and hand, m, shape ``(..., point, xy)``; at ``q = 0`` both lie on the x axis."""
        q = finite_array("q", q, 2)
        l1, l2 = self.lengths
        q12 = q[..., 0] + q[..., 1]
        elbow = np.stack([l1 * np.cos(q[..., 0]), l1 * np.sin(q[..., 0])], -1)
        return np.stack([elbow, elbow + np.stack([l2 * np.cos(q12), l2 * np.sin(q12)], -1)], -2)


def with_load(arm: Arm, mass: float) -> Arm:
    """The arm with a point mass (kg; Han, Hemami & Yurkovich 1987 use 2, 5 and 10) in its hand."""
    instance("arm", arm, Arm)
    number("mass", mass, 0.0)
    l1, l2 = arm.lengths
    moments = arm.gravity_moments
    if any(moments):  # in a horizontal plane the weight does not matter
        weight = mass * STANDARD_GRAVITY
        moments = (moments[0] + weight * l1, moments[1] + weight * l2)
    return replace(
        arm,
        name=f"{arm.name} with {mass:g} kg",
        a=arm.a + mass * (l1**2 + l2**2),
        b=arm.b + mass * l1 * l2,
        d=arm.d + mass * l2**2,
        gravity_moments=moments,
    )


def checked_state(q, qd, qdd, joints: int = 2) -> tuple[np.ndarray, ...]:
    """Checked angles, velocities and accelerations, broadcast against each other."""
    state = (("q", q), ("qd", qd), ("qdd", qdd))
    return np.broadcast_arrays(*(finite_array(name, x, joints) for name, x in state))


CMU_DD_ARM_II = Arm.from_links(
    "CMU DD Arm II (surrogate)",
    Link(mass=14.0, length=0.50, com=0.22, inertia=0.40),
    Link(mass=14.0, length=0.40, com=0.09, inertia=0.60),
    provenance={
        "two vertical axes": "inferred: the paper's network ignores shoulder position",
        "masses": "assumed; together they fit the 70 lb that is remembered of the arm",
        "lengths, centres, inertias": "assumed; link 2 stands for links 2 to 6, locked",
        "a, b, d": "computed from the assumed links",
    },
)
"""Stand-in for the first two links of the CMU Direct-Drive Arm II; no value is the real one's."""

IMI_ARM = Arm(
    "IMI direct-drive arm",
    a=3.473,
    b=0.242,
    d=0.193,
    lengths=(0.36, 0.24),
    provenance={
        "a, b, d": "read in public code that simulates this arm (p1, p3, p2)",
        "lengths": "assumed",
    },
)
"""A planar direct-drive arm; its parameters are those that public simulations of it use."""

REYES_KELLY_ARM = Arm.from_links(
    "Reyes-Kelly vertical arm",
    Link(mass=23.902, length=0.45, com=0.091, inertia=1.266),
    Link(mass=3.880, length=0.45, com=0.048, inertia=0.093),
    gravity=STANDARD_GRAVITY,
    provenance={"all": "read in public code that simulates this arm"},
)
"""A direct-drive arm that moves in a vertical plane, to show the gravity terms."""
