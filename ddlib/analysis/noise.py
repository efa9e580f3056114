"""The error that sensors leave to anybody who estimates the acceleration from a window.

Fit a parabola to a window of measured positions: its curvature estimates the acceleration, and
rounding by the encoder makes the estimate noisy. The mass matrix turns that noise into torque;
the noise of the measured torque comes on top. What results, as an RMSS, is a floor for the
training errors of Table 4-1, if the networks see the acceleration through such a filter.
"""

from __future__ import annotations

import numpy as np

from ddlib._check import integer, number, positive
from ddlib.analysis.filters import savitzky_golay
from ddlib.dynamics import Arm


def acceleration_noise_gain(width: int, period: float) -> float:
    """Deviation of the estimated acceleration for noise of deviation 1 in the positions, 1/s^2.

    It falls with the window's size like ``width ** -2.5``; the sampling period is in s.
    """
    integer("width", width, 3)
    number("period", period, 0.0, open_low=True)
    return float(np.linalg.norm(savitzky_golay(width, 2, period, degree=2)))


def noise_floor(
    arm: Arm, deviation, width: int, bits: float, torque_noise: float, period: float
) -> float:
    """RMSS that encoder and torque sensor leave, both joints pooled.

    Parameters
    ----------
    arm : Arm
        Its mass matrix at ``q = 0`` turns accelerations into torques.
    deviation : array_like, shape (2,)
        Standard deviation of the torques of both joints, N m, above 0.
    width : int
        Window size in samples, odd, 3 or more.
    bits : float
        Of the encoders: ``2 ** bits`` steps a turn, 1 to 40. Rounding is taken for white
        noise with a deviation of a step over the root of 12.
    torque_noise : float
        Noise of the measured torques as a share of their deviation, 0 or more.
    period : float
        Sampling period, s.
    """
    deviation = positive("deviation", deviation, (2,))
    number("bits", bits, 1.0, 40.0)
    number("torque_noise", torque_noise, 0.0)
    rounding = 2 * np.pi / 2**bits / np.sqrt(12)
    joint = np.sqrt((arm.mass_matrix([0.0, 0.0]) ** 2).sum(-1))  # independent errors of both
    error = joint * rounding * acceleration_noise_gain(width, period) / deviation
    return float(np.sqrt(np.mean(error**2) + torque_noise**2))
