"""Causal velocity estimates: exact where they must be, with the noise and lag they claim."""

import numpy as np
import pytest
from scipy.signal import savgol_coeffs

from ddlib.control import EstimatedVelocity, difference, end_slope, noise_gain, pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import Effects, Quantisation
from ddlib.simulation import follow
from ddlib.trajectories import pick_and_place, time_grid

STEP = 0.002


@pytest.mark.parametrize("width", [5, 21, 81])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_end_slope_against_scipy(width, degree):
    ours = end_slope(width, degree, STEP)
    scipys = savgol_coeffs(width, degree, deriv=1, delta=STEP, use="dot", pos=width - 1)
    np.testing.assert_allclose(ours, scipys, rtol=0, atol=1e-9 * np.abs(scipys).max())


@pytest.mark.parametrize("periods", [1, 2, 10, 40])
def test_lag_and_noise_of_a_difference_in_closed_form(periods):
    weights = difference(periods, STEP)
    age = np.arange(periods, -1, -1) * STEP
    assert weights @ age**2 / -2 == pytest.approx(periods * STEP / 2)
    assert noise_gain(weights) == pytest.approx(np.sqrt(2) / (periods * STEP))


@pytest.mark.parametrize("width", [5, 21, 41])
def test_lag_is_the_delay_of_a_slow_sine(width):
    """From the phase at a low frequency; a parabola has none."""
    for degree, expected in ((1, (width - 1) / 2 * STEP), (2, 0.0)):
        weights = end_slope(width, degree, STEP)
        t = np.arange(1 - width, 1) * STEP
        answer = weights @ np.exp(2j * np.pi * 0.1 * t) / (2j * np.pi * 0.1)
        assert -np.angle(answer) / (2 * np.pi * 0.1) == pytest.approx(expected, abs=2e-5)


def run(controller, **options):
    t = time_grid(STEP, 0.1)[:200]
    effects = Effects(encoder=(Quantisation.encoder(14),))
    reference = pick_and_place((45.0, 20.0), t)
    return follow(CMU_DD_ARM_II, controller, reference, t, effects=effects, log_every=1, **options)


def test_the_shortest_difference_is_what_follow_has_built_in():
    feedback = pd((200.0, 80.0), (30.0, 12.0))
    own = run(EstimatedVelocity(feedback, difference(1, STEP)))
    built_in = run(feedback, velocity="difference")
    np.testing.assert_allclose(own.tau, built_in.tau, atol=1e-8)
