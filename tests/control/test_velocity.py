"""Causal velocity estimates: exact where they must be, with the noise and lag they claim."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import savgol_coeffs

from ddlib.analysis import frequency_response, savitzky_golay
from ddlib.control import EstimatedVelocity, difference, end_slope, lag, noise_gain, pd, stacked
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import Effects, Quantisation
from ddlib.simulation import follow
from ddlib.trajectories import pick_and_place, time_grid

STEP = 0.002


@settings(deadline=None)
@given(
    width=st.integers(3, 60),
    degree=st.integers(1, 2),
    coefficients=st.lists(st.floats(-10, 10), min_size=3, max_size=3),
)
def test_end_slope_is_exact_for_its_polynomials(width, degree, coefficients):
    coefficients = coefficients[: degree + 1]
    t = np.arange(1 - width, 1) * STEP
    q = np.polynomial.polynomial.polyval(t, coefficients)
    assert end_slope(width, degree, STEP) @ q == pytest.approx(coefficients[1], abs=1e-7)


@pytest.mark.parametrize("width", [5, 21, 81])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_end_slope_against_scipy(width, degree):
    ours = end_slope(width, degree, STEP)
    scipys = savgol_coeffs(width, degree, deriv=1, delta=STEP, use="dot", pos=width - 1)
    np.testing.assert_allclose(ours, scipys, rtol=0, atol=1e-9 * np.abs(scipys).max())


def test_difference_of_neighbours_is_the_line_through_two_readings():
    np.testing.assert_allclose(difference(1, STEP), [-500.0, 500.0])
    np.testing.assert_allclose(end_slope(2, 1, STEP), [-500.0, 500.0])
    np.testing.assert_allclose(difference(4, 0.01) @ np.arange(5) * 0.01, 1.0)


@pytest.mark.parametrize("periods", [1, 2, 10, 40])
def test_lag_and_noise_of_a_difference_in_closed_form(periods):
    weights = difference(periods, STEP)
    assert lag(weights, STEP) == pytest.approx(periods * STEP / 2)
    assert noise_gain(weights) == pytest.approx(np.sqrt(2) / (periods * STEP))


@pytest.mark.parametrize("width", [5, 21, 41])
def test_lag_is_the_delay_of_a_slow_sine(width):
    """From the phase at a low frequency; a parabola has none."""
    for degree, expected in ((1, (width - 1) / 2 * STEP), (2, 0.0)):
        weights = end_slope(width, degree, STEP)
        assert lag(weights, STEP) == pytest.approx(expected, abs=1e-9)
        t = np.arange(1 - width, 1) * STEP
        answer = weights @ np.exp(2j * np.pi * 0.1 * t) / (2j * np.pi * 0.1)
        assert -np.angle(answer) / (2 * np.pi * 0.1) == pytest.approx(expected, abs=2e-5)


def test_looking_ahead_is_better():
    """The centred filter of the same width has no lag and a quarter of the parabola's noise."""
    width = 21
    centred = savitzky_golay(width, 1, STEP, degree=2)
    assert noise_gain(end_slope(width, 2, STEP)) > 3.8 * noise_gain(centred)
    slow = frequency_response(centred, [0.5], STEP)[0] / (2j * np.pi * 0.5)
    assert abs(np.angle(slow)) < 1e-12


@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 1000), width=st.integers(3, 30))
def test_noise_gain_is_the_deviation_of_filtered_noise(seed, width):
    weights = end_slope(width, 1, STEP)
    noise = np.random.default_rng(seed).standard_normal((20_000, width))
    assert np.std(noise @ weights) == pytest.approx(noise_gain(weights), rel=0.05)


def test_filters_side_by_side():
    rows = stacked([difference(1, STEP), difference(3, STEP), end_slope(3, 1, STEP)])
    assert rows.shape == (3, 4)
    np.testing.assert_allclose(lag(rows, STEP), np.array([0.5, 1.5, 1.0]) * STEP)
    np.testing.assert_allclose(rows[0], [0, 0, -500, 500])


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


def test_runs_may_differ_in_their_filter():
    feedback = pd((200.0, 80.0), (30.0, 12.0))
    rows = [difference(2, STEP), difference(7, STEP), end_slope(9, 2, STEP)]
    together = run(EstimatedVelocity(feedback, stacked(rows)))
    for k, row in enumerate(rows):
        np.testing.assert_allclose(
            together.tau[k], run(EstimatedVelocity(feedback, row)).tau, atol=1e-7
        )


def test_the_law_sees_the_estimate_only():
    """Velocity gain alone: the torque is minus the gain times the filtered readings."""
    weights = end_slope(6, 2, STEP)
    recording = run(EstimatedVelocity(pd((0.0, 0.0), (10.0, 10.0)), weights))
    padded = np.concatenate([np.repeat(recording.q[:1], 5, 0), recording.q])
    speed = np.stack([weights @ padded[k : k + 6] for k in range(200)])
    np.testing.assert_allclose(recording.tau, 10 * (recording.reference.qd - speed), atol=1e-9)


@pytest.mark.parametrize(
    "make, error, words",
    [
        (lambda: difference(0, STEP), ValueError, "periods"),
        (lambda: difference(1.0, STEP), TypeError, "periods"),
        (lambda: difference(1, 0.0), ValueError, "step"),
        (lambda: end_slope(2, 2, STEP), ValueError, "width"),
        (lambda: end_slope(5, 0, STEP), ValueError, "degree"),
        (lambda: end_slope(5, 1, -1.0), ValueError, "step"),
        (lambda: lag([1.0, np.nan], STEP), ValueError, "weights"),
        (lambda: EstimatedVelocity(pd((1, 1), (1, 1)), 3.0), ValueError, "weights"),
        (lambda: EstimatedVelocity(pd((1, 1), (1, 1)), [np.inf]), ValueError, "weights"),
    ],
)
def test_bad_values_are_refused(make, error, words):
    with pytest.raises(error, match=words):
        make()
