"""What simpler models of the arm lose: terms left out, gears in between, a linear fit."""

from __future__ import annotations

import numpy as np

from ddlib._check import filled, finite_array, instance, non_negative, number, shaped, triple
from ddlib.dynamics import Arm
from ddlib.effects import IDEAL, Effects
from ddlib.metrics import rmss
from ddlib.trajectories import Trajectory

# terms of `Arm.torque_terms` that grow with speed squared; Bejczy (1974) leaves them out
_VELOCITY_TERMS = ("centrifugal", "coriolis")
_OTHER_JOINT = ("coupling", *_VELOCITY_TERMS)  # because the other joint moves


def share_of_velocity_terms(
    arm: Arm, trajectory: Trajectory, speed: float = 1.0, effects: Effects = IDEAL
) -> np.ndarray:
    """Velocity terms over the motor's torque, root mean square, for shoulder and elbow.

    The path is travelled `speed` times faster; of the effects, friction is part of the torque.
    """
    instance("arm", arm, Arm)
    triple("trajectory", trajectory)
    instance("effects", effects, Effects)
    number("speed", speed, 0.0, open_low=True)
    qd = speed * trajectory.qd
    terms = arm.torque_terms(trajectory.q, qd, speed**2 * trajectory.qdd)
    needed = sum(terms.values()) + effects.friction_torque(qd)
    return _rms(sum(terms[name] for name in _VELOCITY_TERMS)) / _rms(needed)


def share_of_other_joint(arm: Arm, trajectory: Trajectory, gears, rotor: float) -> np.ndarray:
    """RMS torque due to the other joint over the motor's, behind gears, shape ``(gears, 2)``.

    Behind a gear of ratio N a rotor of inertia J (`rotor`, kg m^2) acts like an inertia N^2 J.
    """
    instance("arm", arm, Arm)
    triple("trajectory", trajectory)
    filled("gears", gears)
    shaped("gears", gears, "(gears,)")
    gears = non_negative("gears", gears)
    number("rotor", rotor, 0.0)
    terms = arm.torque_terms(*trajectory)
    other = _rms(sum(terms[name] for name in _OTHER_JOINT))
    whole = sum(terms.values())
    return np.array([other / _rms(whole + rotor * n**2 * trajectory.qdd) for n in gears])


def linear_residual(arm: Arm, q, qd, qdd) -> float:
    """RMSS that the best linear function of the states leaves of the torque, joints pooled."""
    instance("arm", arm, Arm)
    finite_array("q", q, 2)
    finite_array("qd", qd, 2)
    finite_array("qdd", qdd, 2)
    if not np.shape(q) == np.shape(qd) == np.shape(qdd):
        raise ValueError(
            "q, qd and qdd must have one shape, got "
            f"{np.shape(q)}, {np.shape(qd)} and {np.shape(qdd)}"
        )
    tau = arm.inverse_dynamics(q, qd, qdd).reshape(-1, 2)
    x = np.concatenate([np.reshape(part, (-1, 2)) for part in (q, qd, qdd)], -1)
    x = np.append(x, np.ones((len(x), 1)), -1)
    return float(rmss(x @ np.linalg.lstsq(x, tau, rcond=None)[0], tau))


def _rms(x) -> np.ndarray:
    """Root mean square for each joint."""
    return np.sqrt(np.mean(np.reshape(x, (-1, 2)) ** 2, axis=0))
