"""The equations of motion of a planar arm, derived by sympy and turned into code."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, cached_property

import sympy as sp

from ddlib._check import flag, integer, number, series
from ddlib.dynamics.arm import Link

_MAX_LINKS = 6


@dataclass(frozen=True)
class Derivation:
    """The dynamics of a planar arm in symbols; `derive` makes it."""

    q: tuple  #: Angles of the joints; `qd` and `qdd` are velocities and accelerations.
    qd: tuple
    qdd: tuple
    base: dict  #: For each base parameter what it is in masses, lengths and inertias.
    lagrangian: sp.Expr  #: Kinetic minus potential energy, in base parameters.
    torque: tuple  #: Of each joint, in base parameters, multiplied out.

    @property
    def arguments(self) -> tuple:
        """What the function takes: angles, velocities, accelerations, base parameters."""
        return (*self.q, *self.qd, *self.qdd, *self.base)

    @cached_property
    def function(self) -> Callable:
        """The torques as a numpy function of `arguments`; common subexpressions are shared."""
        return sp.lambdify(self.arguments, list(self.torque), "numpy", cse=True)

    @cached_property
    def printed_function(self) -> Callable:
        """The same function with every term as printed, nothing shared."""
        return sp.lambdify(self.arguments, list(self.torque), "numpy")

    @property
    def source(self) -> str:
        """The Python code of `function`, as sympy wrote it."""
        text = inspect.getsource(self.function)
        return text.replace("_lambdifygenerated", "torque").strip()

    def base_values(self, links: Iterable[Link], gravity: float = 0.0) -> list[float]:
        """The base parameters of an arm under `gravity` (m/s^2), in the order of `base`."""
        links = series("links", links, Link)
        if len(links) != len(self.q):
            raise ValueError(f"links must be {len(self.q)}, got {len(links)}")
        values = {sp.Symbol("g"): number("gravity", gravity)}
        for k, link in enumerate(links, 1):
            parts = zip("mlrI", (link.mass, link.length, link.com, link.inertia))
            values |= {sp.Symbol(f"{letter}{k}"): value for letter, value in parts}
        return [float(expression.subs(values)) for expression in self.base.values()]


@cache
def derive(links: int, gravity: bool = False) -> Derivation:
    """Derive the torques of a planar arm of 1 to 6 links from its energy.

    With `gravity` the plane is vertical, and angles count from hanging straight down. Link k turns
    at the rate ``w_k = qd_1 + ... + qd_k``. Its centre of mass moves with the sum of ``l_i w_i``
    across every earlier link and ``r_k w_k`` across its own, and two directions i and j enclose the
    angle ``q_(i+1) + ... + q_j``.
    """
    flag("gravity", gravity)
    integer("links", links, 1, _MAX_LINKS)

    def named(name):
        return sp.symbols([f"{name}{k}" for k in range(1, links + 1)])

    q, qd, qdd = named("q"), named("qd"), named("qdd")
    masses, lengths, coms, inertias = named("m"), named("l"), named("r"), named("I")
    kinetic, moments = {}, {}
    for k in range(links):
        rods = [*lengths[:k], coms[k]]
        for i, rod in enumerate(rods):
            moments[i] = moments.get(i, 0) + masses[k] * sp.Symbol("g") * rod
            for j in range(i, k + 1):
                kinetic[i, j] = kinetic.get((i, j), 0) + masses[k] * rod * rods[j]
        kinetic[k, k] += inertias[k]
    base = {sp.Symbol(f"A{i + 1}{j + 1}"): kinetic[i, j] for i, j in sorted(kinetic)}
    spin = [sum(qd[: k + 1]) for k in range(links)]
    lagrangian = sp.Integer(0)
    for (i, j), symbol in zip(sorted(kinetic), base):
        both = spin[i] * spin[j] * sp.cos(sum(q[i + 1 : j + 1]))
        lagrangian += symbol * both * (sp.Rational(1, 2) if i == j else 1)
    if gravity:
        falls = {sp.Symbol(f"G{i + 1}"): moment for i, moment in moments.items()}
        lagrangian += sum(s * sp.cos(sum(q[: i + 1])) for i, s in enumerate(falls))
        base |= falls
    torque = tuple(_lagrange(lagrangian, i, q, qd, qdd) for i in range(links))
    return Derivation(tuple(q), tuple(qd), tuple(qdd), base, lagrangian, torque)


def _lagrange(lagrangian, i, q, qd, qdd):
    """``d/dt dL/dqd_i - dL/dq_i``, the time derivative by the chain rule."""
    momentum = lagrangian.diff(qd[i])
    rate = sum(
        momentum.diff(x) * v + momentum.diff(v) * a for x, v, a in zip(q, qd, qdd, strict=True)
    )
    return sp.expand(rate - lagrangian.diff(q[i]))
