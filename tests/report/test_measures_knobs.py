"""The knobs of Table 4-1 on planted designs whose answers are known."""

import numpy as np
import pytest

from workshop.report.knobs import _screening, _spread_evenly, _weigh
from workshop.report.measures import knobs

SLOPES = np.zeros((3, 6))
SLOPES[0, :3], SLOPES[1, 3:], SLOPES[2] = 0.5, 0.8, 0.0


def planted(noise, seed=0):
    """Six logarithms that are linear in two of three knobs, two networks for each run."""
    rng = np.random.default_rng(seed)
    places = _screening()[:, :3]
    means = -2.0 + places @ SLOPES
    values = means[:, None] + rng.normal(0, noise, (25, 2, 6))
    return knobs._screen_of(places, values, ("a", "b", "c"))


def test_a_screen_knows_its_spread_and_its_slopes():
    here = planted(0.1)
    np.testing.assert_allclose(np.sqrt(np.diag(here.covariance)), 0.1, rtol=0.4)
    for k, emulator in enumerate(here.emulators):
        np.testing.assert_allclose(emulator.mean[1:4], SLOPES[:, k], atol=0.06)
    means, variances = here.predict(np.zeros((1, 3)))
    np.testing.assert_allclose(means, -2.0, atol=0.1)
    assert (variances < 0.01).all() and here.scores.shape == (6, 25)


def test_quantiles_of_a_posterior():
    places = _spread_evenly(2**12, 2)
    posterior = knobs._Posterior(places, np.full(len(places), 1 / len(places)), 0.0)
    np.testing.assert_allclose(posterior.quantiles(), [[-0.8] * 2, [0] * 2, [0.8] * 2], atol=0.01)
    assert posterior.effective == pytest.approx(2**12)
    half = (places[:, 0] > 0) / (places[:, 0] > 0).sum()
    narrow = knobs._Posterior(places, half, 0.0)
    np.testing.assert_allclose(narrow.quantiles()[:, 0], [0.1, 0.5, 0.9], atol=0.01)
    assert narrow.effective == pytest.approx(2**11)


def test_the_posterior_finds_the_knobs_behind_the_numbers():
    here = planted(0.06)
    truth = np.array([0.4, -0.6, 0.2])
    places = _spread_evenly(2**13, 3)
    weights, _ = _weigh(*here.predict(places), here.covariance, -2.0 + truth @ SLOPES)
    low, middle, high = knobs._Posterior(places, weights, 0.0).quantiles()
    np.testing.assert_allclose(middle[:2], truth[:2], atol=0.1)
    assert (high - low)[:2].max() < 0.3 and (high - low)[2] > 1.3  # the third knob does nothing
