"""Linear loops around a joint or an arm near one posture, as python-control systems.

Joints obey ``M qdd + F qd = tau`` with a constant inertia ``M`` (a number, or a mass
matrix) and viscous friction ``F``. The loops are those of `ddlib.controllers.PID`: position
errors against a reference at rest, velocity of the reference zero.
"""

from __future__ import annotations

import control
import numpy as np

from ddlib._check import finite_array, non_negative, number


def plant(inertia, viscous) -> control.StateSpace:
    """Joints that obey ``inertia qdd + viscous qd = tau``: torques in, angles and speeds out.

    Parameters
    ----------
    inertia : float or array_like, shape (joint, joint)
        Inertia of one joint or mass matrix of several, kg m^2.
    viscous : float or array_like, shape (joint,)
        Viscous friction, N m s/rad.

    Returns
    -------
    control.StateSpace
        States and outputs: the angles (rad), then the velocities (rad/s).

    Raises
    ------
    ValueError
        If the inertia is not symmetric positive definite or the shapes do not fit.
    """
    inertia = np.atleast_2d(finite_array("inertia", inertia))
    joints = len(inertia)
    if inertia.shape != (joints, joints) or not np.allclose(inertia, inertia.T):
        raise ValueError(f"inertia must be a number or a symmetric matrix, got {inertia.tolist()}")
    if np.linalg.eigvalsh(inertia).min() <= 0:
        raise ValueError(f"inertia must be positive definite, got {inertia.tolist()}")
    viscous = np.diag(_per_joint("viscous", viscous, joints))
    zero, one = np.zeros((joints, joints)), np.eye(joints)
    A = np.block([[zero, one], [zero, -np.linalg.solve(inertia, viscous)]])
    B = np.vstack([zero, np.linalg.inv(inertia)])
    return control.ss(A, B, np.eye(2 * joints), np.zeros((2 * joints, joints)))


def loop_gain(inertia, viscous, kp, ki=0.0, kd=0.0) -> control.TransferFunction:
    """Open loop of one joint under PID control, from position error to position.

    Parameters
    ----------
    inertia, viscous : float
        kg m^2 and N m s/rad.
    kp, ki, kd : float
        Gains in N m/rad, N m/(rad s) and N m s/rad.
    """
    number("inertia", inertia, 0.0, open_low=True)
    for name, value in (("viscous", viscous), ("kp", kp), ("ki", ki), ("kd", kd)):
        number(name, value, 0.0)
    numerator, denominator = [kd, kp, ki], [inertia, viscous, 0.0, 0.0]
    if ki == 0:  # without an integral the pole at zero would only cancel
        numerator, denominator = numerator[:-1], denominator[:-1]
    return control.tf(numerator, denominator)


def closed_loop(joints: control.StateSpace, kp, ki=0.0, kd=0.0, period=None) -> control.StateSpace:
    """The PID loop around joints: reference angles and disturbance torques in, angles out.

    Parameters
    ----------
    joints : control.StateSpace
        From `plant`.
    kp, ki, kd : float or array_like, shape (joint,)
        Gains of `ddlib.controllers.PID`.
    period : float, optional
        Control period in s: the torque is computed once a period and held. The loop is
        then a discrete-time system, exact at the samples. Default: continuous control.

    Returns
    -------
    control.StateSpace
        Inputs: reference angles (rad), then torques (N m) that disturb the joints.
    """
    n = joints.ninputs
    kp, ki, kd = (np.diag(_per_joint(k, v, n)) for k, v in (("kp", kp), ("ki", ki), ("kd", kd)))
    zero, one = np.zeros((n, n)), np.eye(n)
    if period is None:
        A, B, step, at_once = joints.A, joints.B, ki, zero
        hold = zero  # the integral's own dynamics: d(integral)/dt = ki e
    else:
        number("period", period, 0.0, open_low=True)
        sampled = control.sample_system(joints, period, "zoh")
        A, B, step, hold = sampled.A, sampled.B, ki * period, one
        at_once = step  # the law adds the newest error to the integral before using it
    # tau = (kp + at_once) (r - q) - kd qd + integral
    state = np.hstack([-(kp + at_once), -kd])
    A = np.block([[A + B @ state, B], [-step, zero, hold]])
    B = np.block([[B @ (kp + at_once), B], [step, zero]])
    if not ki.any():  # no integral: leave its states out
        A, B = A[: 2 * n, : 2 * n], B[: 2 * n]
    C = np.hstack([one, np.zeros((n, len(A) - n))])
    return control.ss(A, B, C, np.zeros((n, 2 * n)), 0 if period is None else period)


def proportional_limit(inertia, viscous, period) -> float:
    """Largest gain at which sampled proportional control of one joint is stable, N m/rad.

    With ``x = viscous period / inertia`` the poles of the sampled loop have the product
    ``exp(-x) + kp (...)``; it reaches 1 at the value returned, nearly ``2 viscous / period``.
    A very long period loses stability in another way (a real pole at -1); it is covered too.

    Parameters
    ----------
    inertia, viscous : float
        kg m^2 and N m s/rad.
    period : float
        Control period, s.
    """
    number("inertia", inertia, 0.0, open_low=True)
    number("viscous", viscous, 0.0)
    number("period", period, 0.0, open_low=True)
    x = viscous * period / inertia
    if x < 1e-4:  # series: the closed form would lose its digits
        return 2 * viscous / period * (1 + x / 6)
    p = np.exp(-x)
    swing = (1 - p) / ((1 - p) / x - p)
    flip = 2 * (1 + p) / (1 + p - 2 * (1 - p) / x)
    return viscous / period * min(swing, flip)


def _per_joint(name, value, joints) -> np.ndarray:
    """A number or one value per joint as an array, refused if negative."""
    value = non_negative(name, value)
    if value.ndim > 1 or value.size not in (1, joints):
        raise ValueError(f"{name} must be a number or have {joints} values, got {value.tolist()}")
    return np.broadcast_to(value, joints)
