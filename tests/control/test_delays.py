"""Poles of a late loop: against python-control's own, and against the simulated arm."""

import control
import numpy as np
import pytest

from ddlib.control import late_poles, linear
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP

VISCOUS = (0.5, 0.15)
M = CMU_DD_ARM_II.mass_matrix([0.0, 0.0])
JOINTS = linear.plant(M, VISCOUS)
P = np.hstack([np.diag(KP), np.zeros((2, 2))])
PD = np.hstack([np.diag(KP), np.diag(KD)])


def sizes(poles):
    return np.sort(np.abs(poles))[::-1]


@pytest.mark.parametrize("kd", [0.0, KD], ids=["P", "PD"])
def test_without_delay_it_is_the_sampled_loop(kd):
    gain = P if np.ndim(kd) == 0 else PD
    known = linear.closed_loop(JOINTS, KP, kd=kd, period=CONTROL_STEP).poles()
    ours = late_poles(JOINTS, gain, CONTROL_STEP, 0.0)
    np.testing.assert_allclose(sizes(ours)[:4], sizes(known), atol=1e-9)
    np.testing.assert_allclose(sizes(ours)[4:], 0.0, atol=1e-6)


@pytest.mark.parametrize("periods", [1, 2, 5])
def test_whole_periods_are_delays_in_python_control(periods):
    chain = control.sample_system(JOINTS, CONTROL_STEP, "zoh")
    late = control.ss(np.zeros((2, 2)), np.eye(2), np.eye(2), np.zeros((2, 2)), CONTROL_STEP)
    for _ in range(periods):
        chain = chain * late
    known = control.feedback(chain, control.ss([], [], [], PD, CONTROL_STEP)).poles()
    ours = late_poles(JOINTS, PD, CONTROL_STEP, periods * CONTROL_STEP)
    np.testing.assert_allclose(sizes(ours)[:4], sizes(known)[:4], atol=1e-9)


def test_a_fraction_of_a_period_by_finer_sampling():
    """Delay 0.5 period: the loop on a grid twice as fine, reading and holding every other step."""
    half = control.sample_system(JOINTS, CONTROL_STEP / 2, "zoh")
    A, B, n = half.A, half.B, 4
    # x after half a period under the old torque, then half under the new
    step = np.block([[A @ A - B @ PD, A @ B], [-PD, np.zeros((2, 2))]])
    ours = late_poles(JOINTS, PD, CONTROL_STEP, CONTROL_STEP / 2)
    np.testing.assert_allclose(sizes(ours)[:n], sizes(np.linalg.eigvals(step))[:n], atol=1e-9)
