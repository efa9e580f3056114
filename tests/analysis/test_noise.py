"""The floor that the sensors leave: against noise that is really added, and the paper's facts."""

import numpy as np
import pytest

from ddlib.analysis import acceleration_noise_gain, noise_floor, savitzky_golay
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.trajectories import APPENDIX_I, pick_and_place, time_grid


@pytest.mark.parametrize("width, gain", [(11, 683.0), (21, 133.5), (41, 25.0)])
def test_gains_are_those_of_a_parabola(width, gain):
    """Closed form: variance 720 / (n (n^2 - 1) (n^2 - 4)) over the fourth power of the period."""
    n = width
    closed = np.sqrt(720 / (n * (n**2 - 1) * (n**2 - 4))) / 0.01**2
    assert acceleration_noise_gain(width, 0.01) == pytest.approx(closed, rel=1e-10)
    assert closed == pytest.approx(gain, rel=0.01)


@pytest.mark.parametrize("width", [11, 21, 41])
@pytest.mark.parametrize("bits", [12.0, 16.0])
def test_floor_is_what_rounded_positions_give(width, bits):
    """Round the reference's positions, filter, put into the arm's equations, add torque noise."""
    arm, share = CMU_DD_ARM_II, 0.024
    t = time_grid(0.01)
    q, qd, qdd = pick_and_place(APPENDIX_I[:5], t)
    tau = arm.inverse_dynamics(q, qd, qdd)
    deviation = tau.std((0, 1))
    rng = np.random.default_rng(0)
    step = 2 * np.pi / 2**bits
    noise = rng.uniform(-step / 2, step / 2, (40, *q.shape))
    filtered = np.apply_along_axis(
        np.convolve, -2, noise, savitzky_golay(width, 2, 0.01, degree=2), mode="same"
    )[:, :, width:-width]
    wrong = np.einsum("...ij,...j", arm.mass_matrix(q[:, width:-width]), filtered)
    wrong = wrong + share * deviation * rng.standard_normal(wrong.shape)
    measured = np.sqrt(((wrong / deviation) ** 2).mean())
    assert noise_floor(arm, deviation, width, bits, share, 0.01) == pytest.approx(measured, rel=0.1)
