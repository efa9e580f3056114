"""Sections 1 and 3.1: what the rigid body leaves out, measured on trajectory 6.

Shares are judged against the rigid body's torque on the motion as driven, the scale of the
networks' errors. More than half of it catches up with the jump at the start; the share of what
the reference asks for, without that, is told beside it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ddlib import linear
from ddlib.actuators import DeadZone, FlexibleJoint
from ddlib.delays import late_poles
from ddlib.effects import Effects
from ddlib.experiment import STATE_FEEDBACK
from ddlib.filters import savitzky_golay
from ddlib.paper import TEST_TRAJECTORY
from ddlib.simulate import CONTROL_STEP, LOG_STEP, Recording, follow, record
from ddlib.tables import number
from ddlib.trajectories import APPENDIX_I, MOTION_SECONDS, Trajectory, pick_and_place
from ddlib.unmodelled import residual_torque, rms
from ddlib.velocity import difference, end_slope, noise_gain
from ddlib.verdicts import Measured

SETUP = STATE_FEEDBACK
SHAFT = FlexibleJoint((2e4, 6e3), (0.4, 0.15), damping=(5.0, 1.0))
"""A springy shaft with modes at 36 and 38 Hz: an example, no value of the real arm."""


def _drive(**effects) -> Recording:
    extents = APPENDIX_I[TEST_TRAJECTORY - 1]
    options = dict(effects=Effects(**effects), log_step=CONTROL_STEP, rest=0.1)
    return record(SETUP.arm, SETUP.controller, extents, **options)


@cache
def _ideal() -> Recording:
    return _drive()


def _shares(left) -> tuple[np.ndarray, str]:
    """RMS over the rigid body's as driven, and a text that has the reference's too."""
    run = _ideal()
    reference = pick_and_place(APPENDIX_I[TEST_TRAJECTORY - 1], run.t[run.motion])
    driven, asked = (
        rms(left) / rms(torque)
        for torque in (run.tau_true[run.motion], SETUP.arm.inverse_dynamics(*reference))
    )
    text = f"{100 * driven[0]:.0f} % of the torque at the shoulder, {100 * driven[1]:.0f} % at the "
    text += f"elbow; of what the reference asks for {100 * asked[0]:.0f} and {100 * asked[1]:.0f} %"
    return driven, text


def friction() -> Measured:
    """Friction of the surrogate over the rigid-body torque, both as RMS: the smaller share."""
    run = _drive(friction=SETUP.effects.friction)
    share, text = _shares(residual_torque(SETUP.arm, run)[run.motion])
    return Measured(float(share.min()), text)


def differencing(width: int = 19) -> Measured:
    """Noise of velocities by differences over that of a parabola, both up to the newest reading.

    Rounding of the encoder on trajectory 6, 500 readings a second; the text gives the torque
    that it makes through the derivative gain of the shoulder.

    Parameters
    ----------
    width : int
        Readings under the parabola.
    """
    q = _ideal().q_true[:, 0]
    rounding = SETUP.effects.encoder[0].apply(q) - q
    noise = [
        SETUP.controller.kd[0] * np.std(sliding_window_view(rounding, len(w)) @ w)
        for w in (difference(1, CONTROL_STEP), end_slope(width, 2, CONTROL_STEP))
    ]
    simple, fitted = (f"{number(n, 2)} N m" for n in noise)
    text = f"{simple} at the shoulder, {fitted} by a parabola over {width} readings"
    return Measured(float(noise[0] / noise[1]), text)


def looking_ahead(width: int = 21) -> Measured:
    """Noise of a velocity without lag: from the past alone, over noise from both sides."""
    past = end_slope(width, 2, LOG_STEP)
    centred = savitzky_golay(width, 1, LOG_STEP, degree=2)
    ratio = float(noise_gain(past) / noise_gain(centred))
    return Measured(ratio, f"{ratio:.1f} times less noise than from the past alone")


def snap() -> Measured:
    """Torque that a springy shaft leaves without a start, over the torque sensor's noise.

    The reference has been running for a period when the measured motion begins. On the motion
    from rest the swing of the start is never over: this torque weighs frequencies by their
    fourth power, so at the end of the three seconds the swing's still outweighs the reference's.
    """
    t = np.arange(round(-2 * MOTION_SECONDS / CONTROL_STEP), round(MOTION_SECONDS / CONTROL_STEP))
    t = t * CONTROL_STEP
    omega, extents = np.pi / MOTION_SECONDS, np.deg2rad(APPENDIX_I[TEST_TRAJECTORY - 1])
    sine, cosine = (f(omega * t)[:, None] * extents for f in (np.sin, np.cos))
    reference = Trajectory(-sine, -omega * cosine, omega**2 * sine)
    options = dict(effects=Effects(transmission=(SHAFT,)), log_every=1)
    run = follow(SETUP.arm, SETUP.controller, reference, t, **options)
    left = rms(residual_torque(SETUP.arm, run)[t[:-1] >= 0])[0]
    noise = SETUP.effects.torque_sensor[0].std[0]
    modes = SHAFT.mode_frequencies(SETUP.arm, [0.0, 0.0]) / (2 * np.pi)
    text = (
        f"{1e3 * left:.2f} mN m with modes at {modes[0]:.0f} and {modes[1]:.0f} Hz, "
        f"{number(noise / left, 2)} times below the torque noise"
    )
    return Measured(float(left / noise), text)


@cache
def _shaken(gap: float) -> np.ndarray:
    """Torque left at both joints by the springy shaft with some play, the whole motion."""
    run = _drive(transmission=(replace(SHAFT, gap=(gap, gap)),))
    return residual_torque(SETUP.arm, run)[run.motion]


def _share(left, what: str) -> Measured:
    """RMS torque over the rigid body's: the larger share is judged, both are told."""
    share, text = _shares(left)
    return Measured(float(share.max()), f"{what}: {text}")


def backlash(gap: float = 1e-3) -> Measured:
    """Torque that play adds behind a springy shaft, over the rigid body's.

    Parameters
    ----------
    gap : float
        Play, rad.
    """
    return _share(_shaken(gap) - _shaken(0.0), f"play of {np.rad2deg(gap):.2f}°, if it had gears")


def high_frequency() -> Measured:
    """Torque that a springy shaft leaves, the ringing at the start included."""
    return _share(_shaken(0.0), "springy shaft")


def dead_zone(width: float = 0.1) -> Measured:
    """Torque that a dead zone swallows, over the rigid body's.

    Parameters
    ----------
    width : float
        Half the zone, N m, at both joints.
    """
    tau = _ideal().tau_true[_ideal().motion]
    lost = DeadZone((width, width)).inverse(tau) - tau
    return _share(lost, f"dead zone of {width:g} N m")


def saturation() -> Measured:
    """Largest torque of the motion over the torque limit, the joint that comes closer."""
    limit = np.array(SETUP.effects.actuator[0].limit)
    share = (np.abs(_ideal().tau_true).max(0) / limit).max()
    text = f"the motion takes {100 * share:.0f} % of the limit at most"
    return Measured(float(share), text)


def sampling(late: float = 1.2e-3) -> Measured:
    """Growth rate of position feedback whose torque is held and late, 1/s; negative is stable.

    Parameters
    ----------
    late : float
        Delay between reading and torque, s.
    """
    viscous = SETUP.effects.friction[0].coefficient
    joints = linear.plant(SETUP.arm.mass_matrix([0.0, 0.0]), viscous)
    gain = np.hstack([np.diag(SETUP.controller.kp), np.zeros((2, 2))])
    held, delayed = (
        np.log(np.abs(late_poles(joints, gain, CONTROL_STEP, d)).max()) / CONTROL_STEP
        for d in (0.0, late)
    )
    text = (
        f"position feedback: swings grow at {delayed:.2f} 1/s if the torque is {1e3 * late:g} ms "
    )
    text += f"late, {held:.2f} 1/s if it is only held"
    return Measured(float(delayed), text)


def sensor_noise() -> Measured:
    """Noise in torque from second differences of rounded positions, over the rigid body's."""
    run = _ideal()
    log = run.q_true[:: round(LOG_STEP / CONTROL_STEP)]
    torque = []
    for q in (log, SETUP.effects.encoder[0].apply(log)):
        qd, qdd = (q[2:] - q[:-2]) / (2 * LOG_STEP), np.diff(q, 2, axis=0) / LOG_STEP**2
        torque.append(SETUP.arm.inverse_dynamics(q[1:-1], qd, qdd))
    return _share(torque[1] - torque[0], "16 bits, second differences at 100 a second")
