"""States from noisy positions, against textbook recursions and closed forms."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from ddlib.effects import Quantisation
from ddlib.identification import butterworth_states, encoder_step, kalman_states, smoothers

STEP = 0.01


def rough_motion(samples, process, noise, seed):
    """Samples of a motion whose jerk is white, and readings of it."""
    rng = np.random.default_rng(seed)
    ahead, power = model(process)
    x = np.zeros((samples, 3))
    for k in range(1, samples):
        x[k] = ahead @ x[k - 1] + rng.multivariate_normal(np.zeros(3), power)
    return x, x[:, 0] + noise * rng.normal(size=samples)


def model(process):
    h = STEP
    ahead = np.array([[1, h, h**2 / 2], [0, 1, h], [0, 0, 1]])
    power = process * np.array(
        [
            [h**5 / 20, h**4 / 8, h**3 / 6],
            [h**4 / 8, h**3 / 3, h**2 / 2],
            [h**3 / 6, h**2 / 2, h],
        ]
    )
    return ahead, power


def recursions(y, process, noise):
    """Kalman's filter forwards, Rauch's, Tung's and Striebel's smoother backwards."""
    ahead, power = model(process)
    x, p = np.zeros(3), np.diag([1e3, 1e5, 1e7])
    kept = []
    for k, reading in enumerate(y):
        early, spread = (x, p) if k == 0 else (ahead @ x, ahead @ p @ ahead.T + power)
        gain = spread[:, 0] / (spread[0, 0] + noise**2)
        x = early + gain * (reading - early[0])
        p = spread - np.outer(gain, spread[0])
        kept.append((early, spread, x, p))
    found = [x]
    for (_, _, x, p), (early, spread, _, _) in zip(kept[-2::-1], kept[:0:-1]):
        found.append(x + p @ ahead.T @ np.linalg.solve(spread, found[-1] - early))
    return np.array(found[::-1])


def test_the_smoother_is_that_of_rauch_tung_and_striebel():
    process, noise = 400.0, 1e-3
    _, y = rough_motion(150, process, noise, 1)
    share = process * STEP**5 / noise**2
    x = smoothers._states(y[None], share)[0][0] / STEP ** np.arange(3)
    wanted = recursions(y, process, noise)
    size = np.abs(wanted).max(0)
    np.testing.assert_allclose(x / size, wanted / size, atol=1e-5)


def test_the_likelihood_is_that_of_the_readings():
    """Differences of it between two models, against the normal density of third differences."""
    noise, samples = 1e-3, 40
    _, y = rough_motion(samples, 400.0, noise, 2)
    third = np.diff(np.eye(samples), 3, axis=0)  # takes away the unknown start
    # what a unit of white jerk gives in positions: from the model, by simulation of its columns
    ahead, power = model(1.0)
    root = np.linalg.cholesky(power)
    columns = np.zeros((samples, samples - 1, 3))
    for k in range(1, samples):
        columns[k:, k - 1] = [
            (np.linalg.matrix_power(ahead, n) @ root)[0] for n in range(samples - k)
        ]
    moved = columns.reshape(samples, -1)

    def minus_twice(process):
        cover = third @ (process * moved @ moved.T + noise**2 * np.eye(samples)) @ third.T
        scale = np.abs(np.diag(cover)).mean()
        return -2 * multivariate_normal.logpdf(third @ y / scale**0.5, cov=cover / scale) + (
            samples - 3
        ) * np.log(scale)

    def ours(process):
        _, halves, left = smoothers._states(y[None], process * STEP**5 / noise**2)
        return halves + left[0] / noise**2

    wanted = minus_twice(100.0) - minus_twice(1000.0)
    assert ours(100.0) - ours(1000.0) == pytest.approx(wanted, abs=1e-3)


@pytest.mark.parametrize("known", [None, 1e-3])
def test_the_process_noise_is_found(known):
    process, noise = 400.0, 1e-3
    runs = np.stack([rough_motion(800, process, noise, seed)[1] for seed in range(6)])
    found = smoothers._likeliest(runs, known)
    assert np.log10(found / (process * STEP**5 / noise**2)) == pytest.approx(0.0, abs=0.12)


def test_a_slow_sine_passes_both_with_its_derivatives():
    t = np.arange(600) * STEP
    w = 2 * np.pi * 0.8
    q = np.stack([np.sin(w * t), 0.3 * np.cos(w * t)], -1)
    first = np.stack([np.sin(w * t), w * np.cos(w * t), -(w**2) * np.sin(w * t)], -1)
    for found, rtol in (
        (butterworth_states(q, STEP, 12.0), 2e-4),
        (kalman_states(q, STEP), 2e-3),
        (kalman_states(q, STEP, 1e-6), 2e-3),
    ):
        inner = slice(100, -100)
        np.testing.assert_allclose(found[inner, 0], first[inner], atol=rtol * w**2)


def test_the_encoders_step_is_seen_from_its_readings():
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(size=(3, 400)), 1) * 0.01
    for bits in (10, 16):
        step = Quantisation.encoder(bits).step
        readings = Quantisation(step).apply(walk) + rng.uniform(size=(3, 1))  # zeros anywhere
        assert encoder_step(readings) == pytest.approx(step, rel=1e-6)
        assert encoder_step(readings.astype(np.float32)) == pytest.approx(step, rel=1e-2)
    assert encoder_step(walk) is None
    assert encoder_step(np.ones((2, 50))) is None


def test_decimals_of_a_text_do_not_pass_for_the_noise_of_an_encoder():
    """Six decimals are multiples of 1e-6 rad, but the noise of these readings is 20 times that."""
    t, rng = 0.001 * np.arange(4000), np.random.default_rng(4)
    q = 0.5 * np.sin(3 * t)[:, None] + 2e-5 * rng.normal(size=(len(t), 2))
    found = kalman_states(np.round(q, 6), 0.001)[200:-200, :, 2]
    truth = -4.5 * np.sin(3 * t)[200:-200, None]
    assert np.abs(found - truth).max() < 0.05 * np.abs(truth).max()
