"""Sections 1 and 3.1: what the rigid body leaves out, measured on trajectory 6."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ddlib.actuators import FlexibleJoint
from ddlib.claims import Measured
from ddlib.effects import Effects
from ddlib.experiment import STATE_FEEDBACK
from ddlib.filters import savitzky_golay
from ddlib.paper import TEST_TRAJECTORY
from ddlib.simulate import CONTROL_STEP, LOG_STEP, Recording, record
from ddlib.tables import number
from ddlib.trajectories import APPENDIX_I
from ddlib.unmodelled import residual_torque, rms
from ddlib.velocity import difference, end_slope, noise_gain

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


def friction() -> Measured:
    """Friction of the surrogate over the rigid-body torque, both as RMS: the smaller share."""
    run = _drive(friction=SETUP.effects.friction)
    left = rms(residual_torque(SETUP.arm, run)[run.motion])
    share = left / rms(_ideal().tau_true[run.motion])
    text = (
        f"{100 * share[0]:.0f} % of the torque at the shoulder, {100 * share[1]:.0f} % at the elbow"
    )
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
    """Torque that a springy shaft leaves after the start, over the torque sensor's noise."""
    run = _drive(transmission=(SHAFT,))
    smooth = slice(*np.searchsorted(run.t, (0.6, 2.98)))
    left = rms(residual_torque(SETUP.arm, run)[smooth])[0]
    noise = SETUP.effects.torque_sensor[0].std[0]
    modes = SHAFT.mode_frequencies(SETUP.arm, [0.0, 0.0]) / (2 * np.pi)
    text = (
        f"{1e3 * left:.1f} mN m with modes at {modes[0]:.0f} and {modes[1]:.0f} Hz, "
        f"{noise / left:.0f} times below the torque noise"
    )
    return Measured(float(left / noise), text)
