"""Controllers for an unknown load, side by side: the same motion, velocity, motors and load.

The motion is that of the lesson on adaptive control, without noise: four times with an empty hand,
four times with 5 kg that nobody tells of. Each controller is the same law with other parts:
``torque = Y theta + K s + inertia q''_r + observer``, see `Rival`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from beyond.studies.loop.run_time_parts import rounded
from beyond.studies.loop.runs.adaptive import LIMITS, SIZES, TRUTH
from ddlib.dynamics import CMU_DD_ARM_II, with_load
from ddlib.setups import JOINT_DAMPING, JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS, KD
from ddlib.simulation import CONTROL_STEP, REST
from ddlib.trajectories import MOTION_SECONDS

TRIALS, LOAD = 4, 5.0  # motions with an empty hand, and as many with a load, kg
_EXTENTS, _CORNER = (40.0, 30.0), 0.2  # degrees; s over which the plan's corners are averaged
_AROUND = 75  # control samples of rest before and after a motion
_SIGN = 0.02  # rad/s, over which Coulomb friction changes its sign
_RATE = 3.0 * SIZES**2  # of learning, as in the lesson
_FRICTION = np.array([*JOINT_DAMPING_VISCOUS, *JOINT_DAMPING_COULOMB])
_KNOWN = np.concatenate([TRUTH, _FRICTION])
_INERTIA = np.diag(CMU_DD_ARM_II.mass_matrix(np.zeros(2)))  # kg m^2, of the stretched arm
_SLOPE = tuple(np.asarray(JOINT_DAMPING.controller.kp) / KD)


@dataclass(frozen=True)
class Rival:
    """A controller with gains of ``s = e' + slope e``, numbers of the arm, and ways to mend them.

    An observer estimates the missing torque from the motors' torque and the momentum that the
    joints have gained. It takes the arm for two separate inertias if `inertia` is given (which is
    fed forward, too), else it uses the seven numbers.
    """

    numbers: tuple  # a, b, d, viscous and Coulomb friction: what it begins with
    gain: tuple = KD  # K, N m s/rad
    slope: tuple = _SLOPE  # 1/s
    learns: bool = False  # by Slotine and Li's rule
    desired: bool = False  # Y is that of the plan (Sadegh & Horowitz 1990)
    observer: float = 0.0  # its speed, 1/s; 0: there is none
    inertia: tuple = (0.0, 0.0)  # kg m^2


_STIFF = np.array([7500.0, 2250.0])  # N m/rad
_STIFF_DAMPING = 2 * 0.7 * np.sqrt(_STIFF * _INERTIA) - JOINT_DAMPING_VISCOUS
_NOTHING, _HALF = np.zeros(7), _KNOWN * (0.5, 0.5, 0.5, 0, 0, 0, 0)

RIVALS = {
    "PD, the book's gains": Rival(_NOTHING),
    "PD, ten times as stiff": Rival(_NOTHING, _STIFF_DAMPING, _STIFF / _STIFF_DAMPING),
    "PD and a disturbance observer": Rival(_NOTHING, observer=60.0, inertia=_INERTIA),
    "exact numbers, held": Rival(_KNOWN),
    "all of them 10 % too large": Rival(1.1 * _KNOWN),
    "exact numbers, and an observer": Rival(_KNOWN, observer=50.0),
    "adaptive (Slotine & Li)": Rival(_HALF, learns=True),
    "adaptive, desired motion in Y": Rival(_HALF, learns=True, desired=True),
}
"""The same set wherever the book compares controllers for an unknown load."""

POSITION_ALONE = Rival(_NOTHING, (1e-6, 1e-6), tuple(np.divide(JOINT_DAMPING.controller.kp, 1e-6)))
"""The feedback of `JOINT_DAMPING`, which sees no velocity: all damping is the joints' own."""


def _regressor(q, qd, v, a) -> np.ndarray:
    """Y with ``Y @ numbers = M(q) a + C(q, qd) v + friction(v)``, shape (..., 2, 7)."""
    c, s = np.cos(q[..., 1]), np.sin(q[..., 1])
    (w1, w2), (v1, v2), (a1, a2) = (np.moveaxis(x, -1, 0) for x in (qd, v, a))
    Y = np.zeros((*q.shape, 7))
    Y[..., 0, 0], Y[..., 0, 2], Y[..., 1, 2] = a1, a2, a1 + a2
    Y[..., 0, 1] = c * (2 * a1 + a2) - s * (w2 * v1 + (w1 + w2) * v2)
    Y[..., 1, 1] = c * a1 + s * w1 * v1
    for joint in (0, 1):
        Y[..., joint, 3 + joint] = v[..., joint]
        Y[..., joint, 5 + joint] = np.tanh(v[..., joint] / _SIGN)
    return Y


def _mass(numbers, q) -> tuple:
    """Entries m11, m12, m22 of the mass matrix, kg m^2."""
    a, b, d = np.moveaxis(numbers[..., :3], -1, 0)
    x = b * np.cos(q[..., 1])
    return a + 2 * x, d + x, d


def _free(numbers, q, qd) -> np.ndarray:
    """What friction and the turning of the links add to the joints' momentum, N m."""
    found = -numbers[..., 3:5] * qd - numbers[..., 5:] * np.tanh(qd / _SIGN)
    turning = numbers[..., 1] * np.sin(q[..., 1]) * qd[..., 0] * (qd[..., 0] + qd[..., 1])
    found[..., 1] -= turning
    return found


def _accelerations(numbers, q, qd, torque) -> np.ndarray:
    """What the arm with these numbers does, rad/s^2."""
    (w1, w2), (m11, m12, m22) = np.moveaxis(qd, -1, 0), _mass(numbers, q)
    gained = torque + _free(numbers, q, qd)
    turned = numbers[..., 1] * np.sin(q[..., 1]) * w2  # less dM/dt times qd
    f1, f2 = gained[..., 0] + turned * (2 * w1 + w2), gained[..., 1] + turned * w1
    return (
        np.stack([m22 * f1 - m12 * f2, m11 * f2 - m12 * f1], -1) / (m11 * m22 - m12**2)[..., None]
    )


class _Batch:
    """All rivals at once; what they have learnt lasts from motion to motion."""

    def __init__(self, rivals):
        names = ("numbers", "gain", "slope", "inertia", "learns", "desired", "observer")
        each = [np.stack([np.asarray(getattr(r, n), float) for r in rivals]) for n in names]
        self.theta, self.gain, self.slope, self.inertia, learns, desired, speed = each
        self.rate, self.speed = learns[:, None] * _RATE, speed[:, None]
        self.desired = desired.astype(bool)[:, None, None]
        self.separate = (self.inertia > 0).any(-1, keepdims=True)

    def rest(self) -> None:
        """The arm stands still: an observer has nothing to tell."""
        self.gained = self.missing = np.zeros_like(self.gain)

    def torque(self, wanted, q, qd) -> np.ndarray:
        """Torques asked for in this period; `wanted` is a sample of the plan, and its Y."""
        q_r, qd_r, qdd_r, plan = wanted
        v, a = qd_r + self.slope * (q_r - q), qdd_r + self.slope * (qd_r - qd)
        self.s = v - qd
        self.Y = np.where(self.desired, plan, _regressor(q, qd, v, a))
        (w1, w2), (m11, m12, m22) = np.moveaxis(qd, -1, 0), _mass(self.theta, q)
        momentum = np.stack([m11 * w1 + m12 * w2, m12 * w1 + m22 * w2], -1)
        momentum = np.where(self.separate, self.inertia * qd, momentum)
        self.missing = self.speed * (self.gained - momentum)
        known = (self.Y @ self.theta[..., None])[..., 0] + self.inertia * qdd_r
        return known + self.gain * self.s + self.missing

    def after(self, asked, torque, q, qd) -> None:
        """What is learnt and observed in this period, in which the motors gave `torque`."""
        expected = torque - self.missing + np.where(self.separate, 0.0, _free(self.theta, q, qd))
        self.gained = self.gained + (self.speed > 0) * CONTROL_STEP * expected
        able = (np.abs(asked) <= LIMITS).all(-1, keepdims=True)
        change = self.rate * (self.s[:, None] @ self.Y)[:, 0]
        self.theta = self.theta + able * CONTROL_STEP * change


def errors(rivals=RIVALS, bits: float | None = None, filtered: float = 0.0) -> dict:
    """End-point errors in mm by rival, shape (8,): with an empty hand, then with the load.

    With `bits` a turn the controllers have an encoder alone: positions are rounded, a velocity is
    the difference of two readings, averaged over about `filtered` s. Else both are exact.
    """
    first = round(REST / CONTROL_STEP)
    span = slice(first - _AROUND, first + round(MOTION_SECONDS / CONTROL_STEP) + _AROUND)
    plan = [x[span] for x in rounded(_EXTENTS, _CORNER)]
    plan.append(_regressor(plan[0], plan[1], plan[1], plan[2]))
    step = 0.0 if bits is None else 2 * np.pi / 2**bits
    share = -np.expm1(-CONTROL_STEP / filtered) if filtered else 1.0
    batch, found = _Batch(rivals.values()), []
    for arm in TRIALS * [CMU_DD_ARM_II] + TRIALS * [with_load(CMU_DD_ARM_II, LOAD)]:
        true = np.array([arm.a, arm.b, arm.d, *_FRICTION])
        found.append(_motion(batch, true, plan, step, share))
    return dict(zip(rivals, np.stack(found, -1)))


def _motion(batch: _Batch, true, plan, step: float, share: float) -> np.ndarray:
    """One motion of the arm with these numbers by all rivals: end-point errors, mm."""
    q, qd, path, h = np.zeros_like(batch.gain), np.zeros_like(batch.gain), [], CONTROL_STEP / 2
    reading, speed = q, qd
    batch.rest()
    for wanted in zip(*plan):
        path.append(q)
        before, reading = reading, np.round(q / step) * step if step else q
        new = (reading - before) / CONTROL_STEP if step else qd
        speed = speed + share * (new - speed)
        asked = batch.torque(wanted, reading, speed)
        torque = np.clip(asked, -LIMITS, LIMITS)
        batch.after(asked, torque, reading, speed)
        for _ in range(2):  # steps of the midpoint method
            half = qd + h / 2 * _accelerations(true, q, qd, torque)
            q, middle = q + h * half, q + h / 2 * qd
            qd = qd + h * _accelerations(true, middle, half, torque)
    hands, places = (
        CMU_DD_ARM_II.forward_kinematics(x[_AROUND:-_AROUND])[..., 1, :]
        for x in (np.array(path), plan[0])
    )
    return 1e3 * np.sqrt(((hands - places[:, None]) ** 2).sum(-1).mean(0))


def delay_margin(rival: Rival) -> float:
    """Delay of all torques, in s, at which the linear loop about the stretched arm is unstable.

    Estimates are held, Coulomb friction is left out, and half a period is taken off for the hold.
    """
    numbers = _KNOWN if rival.learns else rival.numbers
    a, b, d, *rest = numbers
    own = np.array([[a + 2 * b, d + b], [d + b, d]])  # the mass matrix that it believes in
    rubs, gain, slope = np.diag(rest[:2]), np.diag(rival.gain), np.asarray(rival.slope)
    stiff = gain * slope if rival.desired else (gain + rubs) * slope
    damps = gain if rival.desired else gain + own * slope
    separate = np.any(rival.inertia)
    seen, rubbed = (np.diag(rival.inertia), 0 * rubs) if separate else (own, rubs)

    w = np.geomspace(1.0, 1e3, 4000)
    s, g = 1j * w[:, None, None], rival.observer
    feedback = (1 + g / s) * (stiff + s * damps) + g * (s * seen + rubbed)
    M = CMU_DD_ARM_II.mass_matrix(np.zeros(2))
    arm = np.linalg.inv(s**2 * M + s * np.diag(JOINT_DAMPING_VISCOUS))
    values = np.linalg.eigvals(arm @ feedback)  # a common delay turns all of them alike
    values = np.take_along_axis(values, np.abs(values).argsort(-1), -1)
    over = np.abs(values) > 1
    k, joint = np.nonzero(over[1:] != over[:-1])
    lags = np.mod(np.angle(-values[k, joint]), 2 * np.pi) / w[k]
    return float(lags.min() - CONTROL_STEP / 2)
