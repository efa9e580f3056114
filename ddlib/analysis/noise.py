"""The error that encoder and torque sensor leave to anybody who estimates accelerations."""

from __future__ import annotations

import numpy as np

from ddlib._check import instance, integer, number, positive
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

    The arm's mass matrix at ``q = 0`` turns errors of the acceleration, estimated in windows of
    `width` samples, into torques, of which `deviation` (N m, (2,)) is the spread. Encoders have
    ``2 ** bits`` steps a turn, and rounding is taken for white noise with a deviation of a step
    over the root of 12; `torque_noise` is a share of the deviation, `period` is in s.
    """
    instance("arm", arm, Arm)
    deviation = positive("deviation", deviation, (2,))
    number("bits", bits, 1.0, 40.0)
    number("torque_noise", torque_noise, 0.0)
    rounding = 2 * np.pi / 2**bits / np.sqrt(12)
    joint = np.sqrt((arm.mass_matrix([0.0, 0.0]) ** 2).sum(-1))  # independent errors of both
    error = joint * rounding * acceleration_noise_gain(width, period) / deviation
    return float(np.sqrt(np.mean(error**2) + torque_noise**2))
