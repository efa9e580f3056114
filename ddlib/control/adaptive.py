"""Controllers that learn while they control: the adaptive ones that section 1.1 cites.

Both adapt base parameters and friction, in which the torque is linear. They differ in what they
need and in what they keep: `SlotineLi` needs position and velocity only, and a function of its
errors never rises (`SlotineLi.lyapunov`); `CraigHsuSastry` needs the acceleration, too, and an
estimated mass matrix that can be inverted.

A law that is started keeps its estimates: ``law.estimates`` after a run. `Watched` keeps the law
of a controller that somebody else starts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from ddlib._check import finite_array, non_negative, number, one_of, shaped
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory

PARAMETERS = ("a", "b", "d", "g1", "g2", "F_v1", "F_v2", "F_c1", "F_c2")
"""What can be adapted: base parameters (kg m^2), gravity moments (N m), viscous (N m s/rad) and
Coulomb (N m) friction of both joints."""

SIGN_SPEED = 0.02
"""Coulomb friction is taken for linear in the velocity below this speed, rad/s."""


def mixed_regressor(q, qd, v, a, names: Sequence[str] = PARAMETERS[:3]) -> np.ndarray:
    """Matrix Y with ``Y @ parameters = M(q) a + C(q, qd) v + g(q) + friction(v)``.

    With ``v = qd`` and ``a = qdd`` it is `ddlib.dynamics.Arm.regressor` and friction. C is the
    matrix that makes ``dM/dt - 2 C`` skew-symmetric (`ddlib.dynamics.Arm.coriolis_matrix`).

    Parameters
    ----------
    q, qd : array_like, shape (..., 2)
        Angles (rad) and velocities (rad/s).
    v, a : array_like, shape (..., 2)
        Another velocity (rad/s) and another acceleration (rad/s^2).
    names : sequence of str
        Parameters, from `PARAMETERS`.

    Returns
    -------
    ndarray, shape (..., 2, parameters)

    Source: Slotine & Li 1987, for two links.
    """
    pairs = zip(("q", "qd", "v", "a"), (q, qd, v, a))
    q, qd, v, a = np.broadcast_arrays(*(finite_array(n, x, 2) for n, x in pairs))
    for name in names:
        one_of("names", name, PARAMETERS)
    c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
    (w1, w2), (v1, v2), (a1, a2) = (np.moveaxis(x, -1, 0) for x in (qd, v, a))
    s1, s12, zero = np.sin(q[..., 0]), np.sin(q[..., 0] + q[..., 1]), np.zeros_like(c2)
    sign = np.clip(v / SIGN_SPEED, -1.0, 1.0)
    columns = {
        "a": (a1, zero),
        "b": (c2 * (2 * a1 + a2) - s2 * (w2 * v1 + (w1 + w2) * v2), c2 * a1 + s2 * w1 * v1),
        "d": (a2, a1 + a2),
        "g1": (s1, zero),
        "g2": (s12, s12),
        "F_v1": (v1, zero),
        "F_v2": (zero, v2),
        "F_c1": (sign[..., 0], zero),
        "F_c2": (zero, sign[..., 1]),
    }
    return np.stack([np.stack(columns[name], -1) for name in names], -1)


@dataclass(frozen=True)
class SlotineLi:
    """Adaptive control without acceleration (Slotine & Li 1987).

    With ``e = q_ref - q``, the velocity ``v = qd_ref + slope e`` and ``s = v - qd`` the torque is
    ``Y(q, qd, v, dv/dt) estimate + gain s``, and the estimate moves by
    ``d estimate/dt = rate Y' s``.

    Parameters
    ----------
    gain : array_like, shape (2,)
        Of s, N m s/rad, above 0.
    slope : array_like, shape (2,)
        How fast an error would die out on ``s = 0``, 1/s, above 0.
    rate : array_like, shape (parameters,)
        Speed of adaptation, in the parameter's unit per N m rad; 0: it is not adapted.
    estimate : array_like, shape (parameters,)
        What the run begins with.
    names : sequence of str
        The parameters, from `PARAMETERS`.
    at : {"measured", "desired"}
        The state at which Y is taken: "desired" is Y of the reference alone, which can be computed
        beforehand (Sadegh & Horowitz 1990). Then `lyapunov` may rise.

    Raises
    ------
    ValueError
        If a number is out of range or a shape does not fit.
    """

    gain: tuple[float, float]
    slope: tuple[float, float]
    rate: Sequence[float]
    estimate: Sequence[float]
    names: Sequence[str] = PARAMETERS[:3]
    at: str = "measured"

    def __post_init__(self):
        one_of("at", self.at, ("measured", "desired"))
        for name in ("gain", "slope"):
            value = shaped(name, getattr(self, name), (2,))
            if (value <= 0).any():
                raise ValueError(f"{name} must be above 0 for each joint, got {value}")
        _check_parameters(self)

    def output(self, estimate, wanted: Trajectory, q, qd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time.

        Parameters
        ----------
        estimate : array_like, shape (..., parameters)
        wanted : Trajectory
            One sample of the reference.
        q, qd : array_like, shape (..., 2)
            Measured state.

        Returns
        -------
        torque : ndarray, shape (..., 2)
        change : ndarray, shape (..., parameters)
            Per second.
        """
        s, v, a = self._sliding(wanted, q, qd)
        if self.at == "desired":
            q, qd, v, a = wanted.q, wanted.qd, wanted.qd, wanted.qdd
        Y = mixed_regressor(q, qd, v, a, self.names)
        torque = np.einsum("...jp,...p->...j", Y, np.asarray(estimate)) + self.gain * s
        return torque, np.asarray(self.rate) * np.einsum("...jp,...j->...p", Y, s)

    def lyapunov(self, arm: Arm, truth, estimate, wanted: Trajectory, q, qd) -> np.ndarray:
        """``s' M s / 2`` plus the squared error of the estimate over the rate, shape (...).

        On a rigid body with the parameters `truth`, in continuous time, it falls at the rate
        ``s' gain s`` and never rises. Parameters with a rate of 0 are left out; they must be right.

        Parameters
        ----------
        arm : Arm
            The plant.
        truth : array_like, shape (parameters,)
        estimate, wanted, q, qd
            As in `output`.
        """
        s = self._sliding(wanted, q, qd)[0]
        kinetic = 0.5 * np.einsum("...i,...ij,...j", s, arm.mass_matrix(q), s)
        rate = np.asarray(self.rate, float)
        adapted = rate > 0
        error = (np.asarray(estimate) - np.asarray(truth))[..., adapted]
        return kinetic + 0.5 * (error**2 / rate[adapted]).sum(-1)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it holds its estimate."""
        return _Law(self, reference, step, np.zeros(0))

    def _sliding(self, wanted, q, qd):
        slope = np.asarray(self.slope)
        error, error_rate = wanted.q - q, wanted.qd - qd
        v, a = wanted.qd + slope * error, wanted.qdd + slope * error_rate
        return v - qd, v, a

    def _advance(self, law, estimate, wanted, q, qd):
        torque, change = self.output(estimate, wanted, q, qd)
        return torque, estimate + law.step * change


@dataclass(frozen=True)
class CraigHsuSastry:
    """Adaptive computed torque (Craig, Hsu & Sastry 1987): it needs the acceleration.

    The torque is ``M (qdd_ref + kd de/dt + kp e) + C qd + g + friction`` with the estimates, which
    move by ``rate Y(q, qd, qdd)' M^-1 (de/dt + weight e)`` and are held in a box in which M can be
    inverted.

    Parameters
    ----------
    kp, kd : array_like, shape (2,)
        Gains, 1/s^2 and 1/s.
    weight : array_like, shape (2,)
        Of the error in the adaptation, 1/s; below `kd`, so that the error's equation passes
        energy on without gaining any (it is strictly positive real).
    rate, estimate, names
        As in `SlotineLi`; the names begin with a, b, d.
    low, high : array_like, shape (parameters,)
        The box of the estimates.

    Raises
    ------
    ValueError
        If the box holds parameters whose mass matrix is not positive definite, or another
        number is out of range.
    """

    kp: tuple[float, float]
    kd: tuple[float, float]
    weight: tuple[float, float]
    rate: Sequence[float]
    estimate: Sequence[float]
    low: Sequence[float]
    high: Sequence[float]
    names: Sequence[str] = PARAMETERS[:3]

    def __post_init__(self):
        for name in ("kp", "kd", "weight"):
            non_negative(name, shaped(name, getattr(self, name), (2,)), 2)
        if not (np.asarray(self.weight) < self.kd).all():
            raise ValueError(f"weight must be below kd={self.kd}, got {self.weight}")
        _check_parameters(self)
        if tuple(self.names[:3]) != PARAMETERS[:3]:
            raise ValueError(f"names must begin with a, b, d, got {self.names}")
        low, high = (shaped(n, getattr(self, n), (len(self.names),)) for n in ("low", "high"))
        inside = (low <= self.estimate) & (np.asarray(self.estimate) <= high)
        if not inside.all():
            raise ValueError(f"estimate must lie between low and high, got {self.estimate}")
        coupling = max(low[1] ** 2, high[1] ** 2)
        if not min(d * (low[0] - d) - coupling for d in (low[2], high[2])) > 0 or low[2] <= 0:
            raise ValueError(
                "low and high must keep the mass matrix positive definite (d > 0 and "
                f"a d > d^2 + b^2), got a from {low[0]:g}, b^2 up to {coupling:g}, "
                f"d from {low[2]:g} to {high[2]:g}"
            )

    def output(self, estimate, wanted: Trajectory, q, qd, qdd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time, outside the box too.

        Parameters
        ----------
        estimate, wanted, q, qd
            As in `SlotineLi.output`.
        qdd : array_like, shape (..., 2)
            Measured acceleration, rad/s^2.
        """
        estimate = np.asarray(estimate, float)
        error, error_rate = wanted.q - q, wanted.qd - qd
        asked = wanted.qdd + np.asarray(self.kd) * error_rate + np.asarray(self.kp) * error
        Y = mixed_regressor(q, qd, qd, asked, self.names)
        torque = np.einsum("...jp,...p->...j", Y, estimate)
        measured = mixed_regressor(q, qd, qd, qdd, self.names)
        filtered = error_rate + np.asarray(self.weight) * error
        turned = np.linalg.solve(_mass(estimate, np.asarray(q)), filtered[..., None])[..., 0]
        return torque, np.asarray(self.rate) * np.einsum("...jp,...j->...p", measured, turned)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`; the acceleration is the difference of velocities."""
        return _Law(self, reference, step, np.full(2, np.nan))

    def _advance(self, law, estimate, wanted, q, qd):
        before, law.memory = law.memory, qd
        qdd = np.where(np.isnan(before), 0.0, (qd - before) / law.step)
        torque, change = self.output(estimate, wanted, q, qd, qdd)
        return torque, np.clip(estimate + law.step * change, self.low, self.high)


def _mass(estimate, q) -> np.ndarray:
    """Mass matrices of estimates whose first three numbers are a, b, d."""
    a, b, d = np.moveaxis(estimate[..., :3], -1, 0)
    c2 = np.cos(q[..., 1])
    m11, m12, m22 = np.broadcast_arrays(a + 2 * b * c2, d + b * c2, d)
    return np.stack([np.stack([m11, m12], -1), np.stack([m12, m22], -1)], -2)


class _Law:
    """A running adaptive law: called once a control period, it remembers its estimates."""

    def __init__(self, controller, reference: Trajectory, step: float, memory):
        self.step = number("step", step, 0.0, open_low=True)
        self.controller, self.reference, self.memory = controller, reference, memory
        self._kept = [np.asarray(controller.estimate, float)]

    def __call__(self, k, q, qd):
        wanted = Trajectory(*(x[..., k, :] for x in self.reference))
        torque, after = self.controller._advance(self, self._kept[-1], wanted, q, qd)
        self._kept.append(after)
        return torque

    @property
    def estimates(self) -> np.ndarray:
        """Estimates before each call and after the last, shape (..., calls + 1, parameters)."""
        return np.stack(np.broadcast_arrays(*self._kept), -2)


@dataclass(frozen=True)
class Watched:
    """A controller whose last law can be asked after the run: ``watched.law``.

    Parameters
    ----------
    controller : Controller or callable
    """

    controller: Controller
    _laws: list = field(default_factory=list, compare=False, repr=False)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law of the controller inside, kept."""
        law = as_controller(self.controller).start(reference, step)
        self._laws[:] = [law]
        return law

    @property
    def law(self) -> ControlLaw:
        """The law of the last run; a ValueError if there was none."""
        if not self._laws:
            raise ValueError("controller must have been started before its law can be asked")
        return self._laws[0]


def _check_parameters(controller) -> None:
    for name in controller.names:
        one_of("names", name, PARAMETERS)
    count = (len(controller.names),)
    non_negative("rate", shaped("rate", controller.rate, count))
    shaped("estimate", controller.estimate, count)
