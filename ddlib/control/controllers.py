"""Joint controllers: proportional, PD, PID, and off-line feedforward (paper, section 1.1).

A controller is a frozen description. ``start(reference, step)`` gives the control
law for one run (or a batch of runs): a function ``law(k, q, qd)`` called once a
control period with the sample number and the *measured* state.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ddlib._check import (
    function_of,
    instance,
    non_negative,
    number,
    one_of,
    positive,
    shaped,
    told,
)
from ddlib.dynamics import Arm
from ddlib.trajectories import Trajectory

ControlLaw = Callable[[int, np.ndarray, np.ndarray], np.ndarray]


class Controller(Protocol):
    """Anything that can start a control law."""

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""


@dataclass(frozen=True)
class _Function:
    function: Callable

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        def law(k, q, qd):
            wanted = Trajectory(*(x[..., k, :] for x in reference))
            return np.asarray(self.function(wanted, q, qd), dtype=float)

        return law


def as_controller(controller: Controller | Callable, name: str = "controller") -> Controller:
    """A controller as it is, or one made of a plain function ``f(wanted, q, qd) -> tau``.

    The function gets the sample of the reference (a `Trajectory` of position, velocity,
    acceleration) and the measured state, ``(..., 2)`` in rad and rad/s, and returns torques in N m.
    A refusal calls it by `name`.
    """
    if callable(getattr(controller, "start", None)):
        return controller
    if callable(controller):
        return _Function(controller)
    raise TypeError(
        f"{name} must have a start method, as pd(kp, kd) has, or be a function f(wanted, q, qd), "
        f"got {told(controller)}"
    )


@dataclass(frozen=True, repr=False)
class PID:
    """Independent PID control of each joint.

    ``tau = kp e + ki integral(e) + kd de/dt`` with ``e = q_ref - q``. The derivative
    part uses the reference velocity and the measured velocity. Its filter is discretised by
    backward Euler, ``d[k] = (T_f d[k-1] + T de/dt[k]) / (T_f + T)`` at the control period T.

    At its `limit` the integral would go on growing. ``"conditional"`` lets it rest while the error
    would push the torque further beyond. A time in s is that of back-calculation: within it, the
    integral loses what the motor could not give (Astrom & Murray 2021, section 11.4). None lets it
    wind up. Beside a `Feedforward` the limit holds for the correction alone.
    """

    kp: tuple[float, float]  #: N m/rad per joint, (2,) or (runs, 2).
    ki: tuple[float, float] = (0.0, 0.0)  #: N m/(rad s).
    kd: tuple[float, float] = (0.0, 0.0)  #: N m s/rad.
    limit: tuple[float, float] | None = None  #: Largest torque that it may ask for, N m.
    anti_windup: float | str | None = "conditional"  #: What the integral does at the limit.
    derivative_filter: float = 0.0  #: Time constant T_f of the derivative's filter, s.

    def __post_init__(self):
        for name in ("kp", "ki", "kd"):
            non_negative(name, getattr(self, name), 2)
        if self.limit is not None:
            positive("limit", self.limit)
        if isinstance(self.anti_windup, str):
            one_of("anti_windup", self.anti_windup, ("conditional",))
        elif self.anti_windup is not None:
            number("anti_windup", self.anti_windup, 0.0, 1e4, open_low=True)
        number("derivative_filter", self.derivative_filter, 0.0, 1e4)

    def __repr__(self):
        terms = {name: getattr(self, name) for name in ("kp", "ki", "kd")}
        text = ", ".join(f"{k}={v}" for k, v in terms.items() if k == "kp" or np.any(v))
        if self.limit is not None:
            text += f", limit={self.limit}, anti_windup={self.anti_windup!r}"
        if self.derivative_filter:
            text += f", derivative_filter={self.derivative_filter:g}"
        return f"PID({text})"

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        kp, ki, kd = (np.asarray(g, dtype=float) for g in (self.kp, self.ki, self.kd))
        limit, cure, damping = self.limit, self.anti_windup, np.zeros(())
        integral, integrates, damps = np.zeros(()), ki.any(), kd.any()
        kept = self.derivative_filter / (self.derivative_filter + step)

        def law(k, q, qd):
            nonlocal integral, damping
            error = reference.q[..., k, :] - q
            tau, before = kp * error, integral
            if integrates:
                integral = integral + ki * error * step
                tau = tau + integral
            if damps:
                rate = reference.qd[..., k, :] - qd
                damping = kept * damping + (1 - kept) * rate if kept else rate
                tau = tau + kd * damping
            if limit is None:
                return tau
            given = np.clip(tau, -np.asarray(limit), limit)
            if cure == "conditional":
                integral = np.where((given != tau) & (tau * error > 0), before, integral)
            elif cure is not None:
                integral = integral + (given - tau) * min(1.0, step / cure)
            return given

        return law


def proportional(kp) -> PID:
    """The paper's controller (section 4), ``tau = kp (q_ref - q)``; gain in N m/rad per joint."""
    return PID(kp)


def pd(kp, kd) -> PID:
    """Proportional-derivative control: gains `kp` in N m/rad, `kd` in N m s/rad per joint."""
    return PID(kp, kd=kd)


@dataclass(frozen=True)
class Feedforward:
    """Off-line inverse dynamics of the reference, added to a feedback law (Figure 2-1)."""

    model: Callable | Arm  #: ``model(q, qd, qdd) -> tau`` over ``(..., 2)``, or an arm.
    feedback: Controller  #: Corrects what the model gets wrong.

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        model = self.model.inverse_dynamics if isinstance(self.model, Arm) else self.model
        function_of("model", model, "model(q, qd, qdd) -> tau, or an Arm")
        wanted = f"(..., {reference.q.shape[-2]}, 2)"
        torque = shaped("model(q, qd, qdd)", model(*reference), wanted)
        feedback = as_controller(self.feedback, "feedback").start(reference, step)

        def law(k, q, qd):
            return torque[..., k, :] + feedback(k, q, qd)

        return law


@dataclass(frozen=True)
class ComputedTorque:
    """Feedback linearisation: the model is evaluated at the *measured* state.

    ``tau = M(q) (qdd_ref + kd (qd_ref - qd) + kp (q_ref - q)) + C(q, qd) qd + g(q)``
    with gains in 1/s^2 and 1/s, the same closed-loop dynamics for every joint.
    """

    arm: Arm
    kp: tuple[float, float]
    kd: tuple[float, float]

    def __post_init__(self):
        instance("arm", self.arm, Arm)
        for name in ("kp", "kd"):
            non_negative(name, getattr(self, name), 2)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        kp, kd = np.asarray(self.kp), np.asarray(self.kd)

        def law(k, q, qd):
            error, error_rate = reference.q[..., k, :] - q, reference.qd[..., k, :] - qd
            wanted = reference.qdd[..., k, :] + kd * error_rate + kp * error
            return self.arm.inverse_dynamics(q, qd, wanted)

        return law
