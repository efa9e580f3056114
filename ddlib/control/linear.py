"""Linear PID loops around a joint or an arm near one posture, as python-control systems."""

from __future__ import annotations

from typing import NamedTuple

import control
import numpy as np

from ddlib._check import (
    filled,
    finite_array,
    instance,
    integer,
    non_negative,
    number,
    one_of,
    told,
)

_CLOSE = 1e-4  # relative, of a gain to 1 and of a phase to -180 degrees


def plant(inertia, viscous, stiffness=0.0) -> control.StateSpace:
    """Joints that obey ``inertia qdd + viscous qd + stiffness q = tau``: torques in, state out.

    The states are the angles (rad) from the posture, then the velocities (rad/s).

    Parameters
    ----------
    inertia : float or array_like, shape (joint, joint)
        Inertia of one joint or mass matrix of several, kg m^2.
    viscous : float or array_like, shape (joint,)
        Viscous friction, N m s/rad.
    stiffness : float or array_like, shape (joint, joint)
        What gravity adds to the torque away from the posture, N m/rad; negative if it would fall.
    """
    inertia = np.atleast_2d(finite_array("inertia", inertia))
    filled("inertia", inertia)
    joints = len(inertia)
    if inertia.shape != (joints, joints) or not np.allclose(inertia, inertia.T):
        raise ValueError(f"inertia must be a number or a symmetric matrix, got {told(inertia)}")
    if np.linalg.eigvalsh(inertia).min() <= 0:
        raise ValueError(f"inertia must be positive definite, got {told(inertia)}")
    viscous = np.diag(_per_joint("viscous", viscous, joints))
    zero, identity = np.zeros((joints, joints)), np.eye(joints)
    stiffness = finite_array("stiffness", stiffness)
    if stiffness.shape != zero.shape and (stiffness.ndim or (joints > 1 and stiffness != 0)):
        raise ValueError(f"stiffness must have shape {zero.shape}, got {stiffness.shape}")
    back = (-np.linalg.solve(inertia, x) for x in (zero + stiffness, viscous))
    A = np.block([[zero, identity], [*back]])
    B = np.vstack([zero, np.linalg.inv(inertia)])
    return control.ss(A, B, np.eye(2 * joints), np.zeros((2 * joints, joints)))


def loop_gain(inertia, viscous, kp, ki=0.0, kd=0.0) -> control.TransferFunction:
    """Open loop of one joint (inertia, viscous friction) under PID, from error to position."""
    number("inertia", inertia, 0.0, open_low=True)
    for name, value in (("viscous", viscous), ("kp", kp), ("ki", ki), ("kd", kd)):
        number(name, value, 0.0)
    numerator, denominator = [kd, kp, ki], [inertia, viscous, 0.0, 0.0]
    if ki == 0:  # without an integral the pole at zero would only cancel
        numerator, denominator = numerator[:-1], denominator[:-1]
    return control.tf(numerator, denominator)


def closed_loop(
    joints: control.StateSpace, kp, ki=0.0, kd=0.0, period=None, delay=0,
    *, derivative_filter=0.0, velocity="tachometer",
) -> control.StateSpace:  # fmt: skip
    """The PID loop around joints: reference angles and disturbance torques in, angles out.

    The reference's velocity is taken to be zero.

    Parameters
    ----------
    joints : control.StateSpace
        From `plant`.
    kp, ki, kd : float or array_like, shape (joint,)
        Gains of `ddlib.control.PID`.
    period : float, optional
        Control period in s, for which a torque is held: a discrete-time system, exact at the
        samples. Default: continuous control.
    delay : int
        Whole periods between a reading and its torque; sampled loops only.
    derivative_filter : float
        Time constant of the derivative's filter in s, as `ddlib.control.PID` has it.
    velocity : str
        "tachometer", or "difference" of two readings of the angle; sampled loops only.
    """
    instance("joints", joints, control.StateSpace)
    n, damper = joints.ninputs, (derivative_filter, velocity)
    A, command, torque, law, reference = _parts(joints, kp, ki, kd, period, delay, *damper)
    B = np.hstack([command @ reference[0] + reference[1], torque])
    C = np.hstack([np.eye(n), np.zeros((n, len(A) - n))])
    time = 0 if period is None else period
    return control.ss(A + command @ law, B, C, np.zeros((n, 2 * n)), time)


def opened_loop(
    joints: control.StateSpace, kp, ki=0.0, kd=0.0, period=None, delay=0,
    *, joint=0, derivative_filter=0.0, velocity="tachometer",
) -> control.StateSpace:  # fmt: skip
    """The PID loop of `closed_loop` cut open where one joint's torque is commanded.

    In goes that torque, out comes the controller's answer with its sign reversed.
    """
    instance("joints", joints, control.StateSpace)
    number("joint", joint, 0, joints.ninputs - 1)
    damper = derivative_filter, velocity
    A, command, _, law, _ = _parts(joints, kp, ki, kd, period, delay, *damper)
    others = [k for k in range(joints.ninputs) if k != joint]
    A = A + command[:, others] @ law[others]
    time = 0 if period is None else period
    return control.ss(A, command[:, [joint]], -law[[joint]], 0, time)


def _parts(joints, kp, ki, kd, period, delay, derivative_filter, velocity):
    """The loop in pieces.

    State ``x``: angles, velocities, integrals (only if there are any), what the derivative
    remembers (if it is filtered or a difference), waiting torques.
    With the commanded torque ``v = law x + reference[0] r``,
    ``x' = A x + command v + reference[1] r + torque d``.
    """
    n = joints.ninputs
    kp, ki, kd = (np.diag(_per_joint(k, v, n)) for k, v in (("kp", kp), ("ki", ki), ("kd", kd)))
    integer("delay", delay, 0)
    smoothing = number("derivative_filter", derivative_filter, 0.0, 1e4)
    differs = one_of("velocity", velocity, ("tachometer", "difference")) == "difference"
    if period is None and delay:
        raise ValueError(f"delay must be 0 in continuous control, got {delay} periods")
    if period is None and differs:
        raise ValueError("velocity must be 'tachometer' in continuous control, got 'difference'")
    zero, identity = np.zeros((n, n)), np.eye(n)
    A, B, step, at_once, hold = joints.A, joints.B, ki, zero, zero
    # of the derivative: what it remembers of itself, what goes in, what comes out at once
    remembers, enters, leaves, passes = 0.0, 0.0, 1.0, 1.0
    if smoothing and period is None:
        remembers, enters, passes = -1 / smoothing, 1 / smoothing, 0.0
    if period is not None:
        number("period", period, 0.0, open_low=True)
        sampled = control.sample_system(joints, period, "zoh")
        # the law adds the newest error to the integral before using it
        A, B, step, at_once, hold = sampled.A, sampled.B, ki * period, ki * period, identity
        kept = smoothing / (smoothing + period)  # backward Euler, as in the law
        remembers, enters, leaves, passes = kept, 1 - kept, kept, 1 - kept
        if differs:
            # it remembers ``kept d[k] - (1 - kept) q[k] / T``, to which the next angle is added
            enters, leaves, passes = -((1 - kept) ** 2) / period, 1.0, (1 - kept) / period
    size, measured = 2 * n, slice(0, n) if differs else slice(n, 2 * n)
    law = np.hstack([-(kp + at_once), zero])
    law[:, measured] -= passes * kd
    above, more = n if ki.any() else 0, n if (smoothing or differs) and kd.any() else 0
    integral, memory = slice(size, size + above), slice(size + above, size + above + more)
    waiting = size + above + more
    total = waiting + n * delay
    F, command, torque, of_law, reference = (
        np.zeros(shape) for shape in ((total, total), *[(total, n)] * 2, (n, total), (total, n))
    )
    F[:size, :size], torque[:size], of_law[:, :size] = A, B, law
    if above:
        F[integral, :n], F[integral, integral] = -step, hold
        of_law[:, integral], reference[integral] = identity, step
    if more:
        F[memory, measured], F[memory, memory] = enters * identity, remembers * identity
        of_law[:, memory] = -leaves * kd
    if delay:  # v enters the queue at its end and acts when it has reached the front
        F[:size, waiting : waiting + n] = B
        F[waiting : total - n, waiting + n :] = np.eye(total - n - waiting)
        command[total - n :] = identity
    else:
        command[:size] = B
    return F, command, torque, of_law, (kp + at_once, reference)


class Margins(NamedTuple):
    """How far a stable loop is from instability."""

    phase_deg: float  #: Angle in degrees that the loop may lose at its crossover.
    crossover: float  #: Frequency in rad/s at which the loop gain is 1.
    upper_gain: float  #: Factor by which the gain may rise; infinite without a limit.
    lower_gain: float  #: Factor to which the gain may fall; 0 without a limit.


def margins(loop) -> Margins:
    """Gain and phase margins of an `opened_loop` or a `loop_gain`.

    The loop has one input and one output, in continuous time or, with a `dt`, sampled. Frequencies
    at which its gain is 1 or its phase is -180 degrees are zeros of state-space systems: a
    polynomial would lose its digits if the loop had a long delay.
    """
    instance("loop", loop, control.StateSpace, control.TransferFunction)
    if (loop.ninputs, loop.noutputs) != (1, 1):
        raise ValueError(
            f"loop must have one input and one output, got {loop.ninputs} and {loop.noutputs}"
        )
    if loop.dt is True:
        raise ValueError("loop must have a sampling period in s as its dt, got dt=True")
    period, loop = loop.dt or 0.0, control.ss(loop)
    if period:
        # z = (1 + w) / (1 - w): the unit circle becomes the imaginary axis
        state = np.eye(loop.nstates)
        inverse = np.linalg.inv(loop.A + state)
        A, B, C = inverse @ (loop.A - state), inverse @ loop.B, 2 * loop.C @ inverse
        loop = control.ss(A, B, C, loop.D - loop.C @ inverse @ loop.B)
    mirrored = control.ss(-loop.A, loop.B, -loop.C, loop.D)  # the loop at -w
    crossovers = _on_the_axis(loop * mirrored - 1)
    crossovers = crossovers[np.abs(np.abs(loop(1j * crossovers)) - 1) < _CLOSE]
    if not crossovers.size:
        raise ValueError("loop must have a gain of 1 at some frequency, got none")
    phases = np.angle(-loop(1j * crossovers), deg=True)
    k = np.argmin(np.abs(phases))
    # it is real there, at frequency 0, and at w of infinity, the highest that samples can show
    turned = loop(1j * _on_the_axis(loop - mirrored))
    turned = turned[np.abs(turned.imag) < _CLOSE * np.abs(turned)]
    real = np.real([*turned, loop.dcgain(), loop.D[0, 0]])
    gains = -1 / real[np.isfinite(real) & (real < 0)]
    crossover = 2 / period * np.arctan(crossovers[k]) if period else crossovers[k]
    upper, lower = min(gains[gains > 1], default=np.inf), max(gains[gains < 1], default=0.0)
    return Margins(float(phases[k]), float(crossover), float(upper), float(lower))


def _on_the_axis(system) -> np.ndarray:
    """Zeros of a system that lie near the positive imaginary axis: their imaginary parts."""
    zeros = control.zeros(system)
    return zeros.imag[(np.abs(zeros.real) < 1e-3 * np.abs(zeros)) & (zeros.imag > 0)]


def proportional_limit(inertia, viscous, period) -> float:
    """Largest gain at which sampled proportional control of one joint is stable, N m/rad.

    With ``x = viscous period / inertia`` the poles of the sampled loop have the product
    ``exp(-x) + kp (...)``; it reaches 1 at the value returned, nearly ``2 viscous / period``.
    A very long period loses stability in another way (a real pole at -1); it is covered too.
    """
    number("inertia", inertia, 0.0, open_low=True)
    number("viscous", viscous, 0.0)
    number("period", period, 0.0, open_low=True)
    x = viscous * period / inertia
    if x < 1e-4:  # series: the closed form would lose its digits
        return 2 * viscous / period * (1 + x / 6)
    p = np.exp(-x)
    swing = (1 - p) / ((1 - p) / x - p)  # the product of the poles reaches 1
    flip = 2 * (1 + p) / (1 + p - 2 * (1 - p) / x)
    return viscous / period * min(swing, flip)


def _per_joint(name, value, joints) -> np.ndarray:
    """A number or one value per joint as an array, refused if negative."""
    value = non_negative(name, value)
    if value.ndim > 1 or value.size not in (1, joints):
        raise ValueError(f"{name} must be a number or have {joints} values, got {told(value)}")
    return np.broadcast_to(value, joints)


def late_poles(joints: control.StateSpace, gain, period: float, late: float) -> np.ndarray:
    """Poles of sampled state feedback with a delay between reading and torque, in the z plane.

    The torque ``-gain x`` of a reading is held for a `period` from `late` s on, which may be
    longer. Between changes the joints (`plant`) are solved exactly (Astrom & Wittenmark 1997).
    """
    instance("joints", joints, control.StateSpace)
    number("period", period, 0.0, open_low=True)
    whole, late = divmod(number("late", late, 0.0) / period + 1e-12, 1.0)
    states, inputs = joints.B.shape
    K = finite_array("gain", gain, states)
    if K.shape not in ((inputs, states), (states,)):
        raise ValueError(f"gain must have shape {(inputs, states)}, got {K.shape}")
    parts = [_held(joints, share * period) for share in (late, 1 - late)]
    older, newer = parts[1][0] @ parts[0][1], parts[1][1]

    # states: those of the joints, then the torques of 1, 2, ... periods ago
    waiting = int(whole) + 1
    A = np.zeros((states + waiting * inputs,) * 2)
    A[:states, :states] = parts[1][0] @ parts[0][0]
    A[states:, states:] = np.eye(waiting * inputs, k=-inputs)
    A[states : states + inputs, :states] = -K
    last = slice(states + int(whole) * inputs, None)
    A[:states, last] = older
    if whole:
        A[:states, last.start - inputs : last.start] += newer
    else:
        A[:states, :states] -= newer @ K
    return np.linalg.eigvals(A)


def _held(joints, seconds):
    """State and input matrix of the joints over some seconds under a constant torque."""
    if seconds < 1e-9:
        return np.eye(joints.nstates), np.zeros_like(joints.B)
    sampled = control.sample_system(joints, seconds, "zoh")
    return sampled.A, sampled.B
