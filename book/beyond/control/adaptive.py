"""Controllers that adapt while they control: the ones that section 1.1 cites.

`SlotineLi` and `_CraigHsuSastry` adapt base parameters and friction, in which the torque is linear.
The first needs position and velocity only; the second needs the acceleration, too, and an estimated
mass matrix that can be inverted. `_ModelReference` adapts the gains of each joint by itself. A law
that is started keeps its estimates: ``law.estimates`` after a run, ``law.estimate`` the last.
Gains, rates and estimates may have leading axes, of runs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.signal import cont2discrete

from ddlib._check import finite_array, non_negative, number, one_of, shaped
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory

_PARAMETERS = ("a", "b", "d", "g1", "g2", "F_v1", "F_v2", "F_c1", "F_c2")
"""What can be adapted: base parameters (kg m^2), gravity moments (N m), viscous (N m s/rad) and
Coulomb (N m) friction of both joints."""

_SIGN_SPEED = 0.02  # rad/s: below it Coulomb friction is taken for linear in the velocity


def mixed_regressor(q, qd, v, a, names: Sequence[str] = _PARAMETERS[:3]) -> np.ndarray:
    """Matrix Y with ``Y @ parameters = M(q) a + C(q, qd) v + g(q) + friction(v)``.

    With ``v = qd`` and ``a = qdd`` it is `ddlib.dynamics.Arm.regressor` and friction. C is the
    matrix that makes ``dM/dt - 2 C`` skew-symmetric (`ddlib.dynamics.Arm.coriolis_matrix`).
    The form is that of Slotine & Li 1987, for two links; its shape is (..., 2, parameters), and
    `names` are some of `_PARAMETERS`.
    """
    pairs = zip(("q", "qd", "v", "a"), (q, qd, v, a))
    for name in names:
        one_of("names", name, _PARAMETERS)
    return _unchecked_regressor(*(finite_array(n, x, 2) for n, x in pairs), names)


def _unchecked_regressor(q, qd, v, a, names: Sequence[str]) -> np.ndarray:
    """`mixed_regressor` without checks, for the inner loop of a simulation."""
    q, qd, v, a = np.broadcast_arrays(q, qd, v, a)
    c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
    (w1, w2), (v1, v2), (a1, a2) = ((x[..., 0], x[..., 1]) for x in (qd, v, a))
    Y = np.zeros((*q.shape, len(names)))
    for k, name in enumerate(names):
        shoulder, elbow = Y[..., 0, k], Y[..., 1, k]
        if name == "a":
            shoulder[...] = a1
        elif name == "b":
            shoulder[...] = c2 * (2 * a1 + a2) - s2 * (w2 * v1 + (w1 + w2) * v2)
            elbow[...] = c2 * a1 + s2 * w1 * v1
        elif name == "d":
            shoulder[...], elbow[...] = a2, a1 + a2
        elif name == "g1":
            shoulder[...] = np.sin(q[..., 0])
        elif name == "g2":
            shoulder[...] = elbow[...] = np.sin(q[..., 0] + q[..., 1])
        else:
            joint = int(name[-1]) - 1
            rate = v[..., joint]
            own = rate if name.startswith("F_v") else np.clip(rate / _SIGN_SPEED, -1.0, 1.0)
            Y[..., joint, k] = own
    return Y


class _RunningLaw:
    """A running adaptive law; `memory` is its controller's to use."""

    def __init__(self, controller, reference: Trajectory, step: float):
        self.step = number("step", step, 0.0, open_low=True)
        self.controller, self.reference, self.memory = controller, reference, None
        self._kept = [np.asarray(controller.estimate, float)]

    def __call__(self, k, q, qd):
        wanted = Trajectory(*(x[..., k, :] for x in self.reference))
        torque, after = self.controller.advance(self, self._kept[-1], wanted, q, qd)
        if self.controller.limit is not None:  # it learns nothing while it asks for more torque
            able = (np.abs(torque) <= self.controller.limit).all(-1, keepdims=True)
            after = np.where(able, after, self._kept[-1])
        self._kept.append(after)
        return torque

    @property
    def estimates(self) -> np.ndarray:
        """Estimates before each call and after the last, shape (..., calls + 1, parameters)."""
        return np.stack(np.broadcast_arrays(*self._kept), -2)

    @property
    def estimate(self) -> np.ndarray:
        return self._kept[-1]


class _Adaptive:
    """What has ``output(estimate, wanted, q, qd)``: torque, and the estimate's rate of change."""

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it holds its estimate."""
        return _RunningLaw(self, reference, step)

    def advance(self, law, estimate, wanted, q, qd):
        """Torque of a running law, and its estimate one period later."""
        torque, change = self.output(estimate, wanted, q, qd)
        return torque, estimate + law.step * change


@dataclass(frozen=True)
class Watched:
    """A controller whose last law can be asked after the run: ``watched.law``."""

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


@dataclass(frozen=True)
class SlotineLi(_Adaptive):
    """Adaptive control without acceleration (Slotine & Li 1987).

    With ``e = q_ref - q``, the velocity ``v = qd_ref + slope e`` and ``s = v - qd`` the torque is
    ``Y(q, qd, v, dv/dt) estimate + gain s``, and the estimate moves by
    ``d estimate/dt = rate Y' s``. With ``at="desired"`` Y is that of the reference alone, which can
    be computed beforehand (Sadegh & Horowitz 1990); then `lyapunov` may rise.
    """

    gain: tuple[float, float]  # of s, N m s/rad
    slope: tuple[float, float]  # how fast an error would die out on s = 0, 1/s
    rate: Sequence[float]  # (..., parameters), their unit per N m rad; 0: it is not adapted
    estimate: Sequence[float]  # (..., parameters): what the run begins with
    names: Sequence[str] = _PARAMETERS[:3]
    at: str = "measured"  # or "desired": the state at which Y is taken
    dead_zone: tuple[float, float] = (0.0, 0.0)  # of s, rad/s: taken off, nothing is learnt within
    leakage: float = 0.0  # rate at which the estimate goes back to what the run began with, 1/s
    limit: Sequence[float] | None = None  # N m: nothing is learnt while the torque is larger

    def __post_init__(self):
        one_of("at", self.at, ("measured", "desired"))
        for name in ("gain", "slope"):
            value = shaped(name, getattr(self, name), "(..., 2)")
            if (value <= 0).any():
                raise ValueError(f"{name} must be above 0 for each joint, got {value}")
        non_negative("dead_zone", self.dead_zone, 2)
        number("leakage", self.leakage, 0.0)
        for name in self.names:
            one_of("names", name, _PARAMETERS)
        count = f"(..., {len(self.names)})"
        non_negative("rate", shaped("rate", self.rate, count))
        shaped("estimate", self.estimate, count)

    def output(self, estimate, wanted: Trajectory, q, qd) -> tuple[np.ndarray, np.ndarray]:
        """Torque ``(..., 2)`` and the estimate's rate of change per second, in continuous time.

        `wanted` is one sample of the reference, `q` and `qd` are measured.
        """
        s, v, a = self._sliding(wanted, q, qd)
        if self.at == "desired":
            q, qd, v, a = wanted.q, wanted.qd, wanted.qd, wanted.qdd
        Y = _unchecked_regressor(q, qd, v, a, self.names)
        torque = np.einsum("...jp,...p->...j", Y, np.asarray(estimate)) + self.gain * s
        learnt = s - np.clip(s, -np.asarray(self.dead_zone), self.dead_zone)
        change = np.asarray(self.rate) * np.einsum("...jp,...j->...p", Y, learnt)
        return torque, change - self.leakage * (np.asarray(estimate) - self.estimate)

    def lyapunov(self, arm: Arm, truth, estimate, wanted: Trajectory, q, qd) -> np.ndarray:
        """``s' M s / 2`` plus the squared error of the estimate over the rate, shape (...).

        On a rigid body with the parameters `truth`, in continuous time, it falls at the rate
        ``s' gain s`` and never rises. Parameters with a rate of 0 are left out; they must be right.
        """
        s = self._sliding(wanted, q, qd)[0]
        kinetic = 0.5 * np.einsum("...i,...ij,...j", s, arm.mass_matrix(q), s)
        rate = np.asarray(self.rate, float)
        error = np.asarray(estimate) - np.asarray(truth)
        each = np.divide(
            error**2, rate, out=np.zeros(np.broadcast(error, rate).shape), where=rate > 0
        )
        return kinetic + 0.5 * each.sum(-1)

    def _sliding(self, wanted, q, qd):
        slope = np.asarray(self.slope)
        error, error_rate = wanted.q - q, wanted.qd - qd
        v, a = wanted.qd + slope * error, wanted.qdd + slope * error_rate
        return v - qd, v, a


_MARGIN = 0.9  # largest b as a share of that which makes the mass matrix singular


@dataclass(frozen=True)
class _CraigHsuSastry(_Adaptive):
    """Adaptive computed torque (Craig, Hsu & Sastry 1987): it needs the acceleration.

    The torque is ``M (qdd_ref + kd de/dt + kp e) + C qd + g + friction`` with the estimates, which
    move by ``rate Y(q, qd, qdd)' M^-1 (de/dt + weight e)`` and stay in a box where M is invertible.
    """

    kp: tuple[float, float]  # 1/s^2
    kd: tuple[float, float]  # 1/s
    weight: tuple[float, float]  # of the error in the adaptation, 1/s
    rate: Sequence[float]
    estimate: Sequence[float]
    low: Sequence[float]  # the box of the estimates, with d above 0 and below a
    high: Sequence[float]
    names: Sequence[str] = _PARAMETERS[:3]  # they begin with a, b, d
    acceleration: Callable | None = None  # of q, qd and the torque held; default: by difference
    limit: Sequence[float] | None = None  # N m: nothing is learnt while the torque is larger

    def output(self, estimate, wanted: Trajectory, q, qd, qdd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time, outside the box too."""
        estimate = np.asarray(estimate, float)
        error, error_rate = wanted.q - q, wanted.qd - qd
        asked = wanted.qdd + np.asarray(self.kd) * error_rate + np.asarray(self.kp) * error
        Y = _unchecked_regressor(q, qd, qd, asked, self.names)
        torque = np.einsum("...jp,...p->...j", Y, estimate)
        measured = _unchecked_regressor(q, qd, qd, qdd, self.names)
        filtered = error_rate + np.asarray(self.weight) * error
        turned = np.linalg.solve(_mass(estimate, np.asarray(q)), filtered[..., None])[..., 0]
        return torque, np.asarray(self.rate) * np.einsum("...jp,...j->...p", measured, turned)

    def advance(self, law, estimate, wanted, q, qd):
        before, held = (qd, np.zeros(2)) if law.memory is None else law.memory
        if self.acceleration is None:
            qdd = (qd - before) / law.step
        else:
            qdd = self.acceleration(q, qd, held)
        torque, change = self.output(estimate, wanted, q, qd, qdd)
        law.memory = qd, torque
        return torque, self._invertible(np.clip(estimate + law.step * change, self.low, self.high))

    def _invertible(self, estimate):
        a, b, d = np.moveaxis(estimate[..., :3], -1, 0)
        most = _MARGIN * np.sqrt(d * (a - d))
        return np.concatenate(
            [np.stack([a, np.clip(b, -most, most), d], -1), estimate[..., 3:]], -1
        )


def _mass(estimate, q) -> np.ndarray:
    """Mass matrices of estimates whose first three numbers are a, b, d."""
    a, b, d = np.moveaxis(estimate[..., :3], -1, 0)
    c2 = np.cos(q[..., 1])
    m11, m12, m22 = np.broadcast_arrays(a + 2 * b * c2, d + b * c2, d)
    return np.stack([np.stack([m11, m12], -1), np.stack([m12, m22], -1)], -2)


@dataclass(frozen=True)
class _ModelReference(_Adaptive):
    """Gains of each joint by itself that adapt until it follows a linear model (Parks 1966).

    The model answers ``command = qdd_ref + a1 qd_ref + a0 q_ref`` with
    ``qdd_m = command - a1 qd_m - a0 q_m``. The torque is ``phi' estimate`` with
    ``phi = (command, -q, -qd, 1)``, and the estimate moves by ``rate phi (de/dt + weight e)`` with
    ``e = q_m - q``.
    """

    stiffness: tuple[float, float]  # a0 of each joint's model, 1/s^2
    damping: tuple[float, float]  # a1, 1/s
    weight: tuple[float, float]  # 1/s, below `damping`
    rate: Sequence[float]  # (..., 8): of four gains of the shoulder, then of the elbow
    estimate: Sequence[float]  # theirs at first: kg m^2, N m/rad, N m s/rad, N m
    leakage: float = 0.0  # as of `SlotineLi`
    limit: Sequence[float] | None = None  # N m: nothing is learnt while the torque is larger

    def model(self, reference: Trajectory, step: float) -> Trajectory:
        a0, a1 = np.asarray(self.stiffness), np.asarray(self.damping)
        first = reference.q[..., :1, :]
        command = reference.qdd + a1 * reference.qd + a0 * (reference.q - first)
        motion = np.zeros((*command.shape, 2))
        free, push, ahead = (np.stack(x) for x in zip(*map(self._sampled, a0, a1, 2 * [step])))
        asked = command[..., None]
        state = -asked[..., 0, :, :] * ahead
        for k in range(command.shape[-2]):
            motion[..., k, :, :] = state + asked[..., k, :, :] * ahead
            state = (free @ state[..., None])[..., 0] + asked[..., k, :, :] * push
        q, qd = np.moveaxis(motion, -1, 0)
        return Trajectory(q + first, qd, command - a1 * qd - a0 * q)

    @staticmethod
    def _sampled(a0, a1, step):
        """A joint's model at samples: what state and command become, and the part fed through."""
        system = np.array([[0.0, 1.0], [-a0, -a1]]), np.array([[0.0], [1.0]]), np.eye(2)
        free, push, _, ahead, _ = cont2discrete((*system, np.zeros((2, 1))), step, "foh")
        return free, push[:, 0], ahead[:, 0]

    def output(self, estimate, wanted: Trajectory, q, qd) -> tuple[np.ndarray, np.ndarray]:
        """Torque and the estimate's rate of change in continuous time; `wanted` is the model's."""
        a0, a1 = np.asarray(self.stiffness), np.asarray(self.damping)
        command = wanted.qdd + a1 * wanted.qd + a0 * wanted.q
        command, q, qd = np.broadcast_arrays(command, q, qd)
        phi = np.stack([command, -q, -qd, np.ones_like(q)], -1)
        gains = np.reshape(estimate, (*np.shape(estimate)[:-1], 2, 4))
        filtered = wanted.qd - qd + np.asarray(self.weight) * (wanted.q - q)
        change = phi * filtered[..., None]
        change = np.asarray(self.rate) * change.reshape(*change.shape[:-2], 8)
        drawn = self.leakage * (np.asarray(estimate) - self.estimate)
        return (phi * gains).sum(-1), change - drawn

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        return _RunningLaw(self, self.model(reference, step), step)
