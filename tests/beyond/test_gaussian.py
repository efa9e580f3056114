"""Gaussian processes against the closed form, their intervals, and random features."""

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial.distance import cdist

from beyond.rivals.gaussian import GaussianProcess, RandomFeatures, SemiParametric
from beyond.rivals.protocol import Cases
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM
from ddlib.identification import GRAVITY, RIGID

STEP = 0.01


def states(samples, seed=0, size=1.0):
    return np.random.default_rng(seed).uniform(-size, size, (samples, 2, 3))


def data(samples=120, seed=0, noise=0.1, arm=CMU_DD_ARM_II):
    x = states(samples, seed)
    torque = arm.inverse_dynamics(*np.moveaxis(x, -1, 0))
    torque += noise * np.random.default_rng(seed + 1000).standard_normal(torque.shape)
    return Cases(x, torque, "states", STEP)


def kernel(x, y, found):
    length = found.k1.k2.length_scale
    return found.k1.k1.constant_value * np.exp(-0.5 * cdist(x / length, y / length, "sqeuclidean"))


def closed_form(rival, cases, x, joint):
    """Mean and deviation by Cholesky factors, from the hyperparameters alone."""
    flat, wanted = cases.x.reshape(len(cases), -1), x.reshape(len(x), -1)
    mean, spread = flat.mean(0), flat.std(0)
    a, b = (flat - mean) / spread, (wanted - mean) / spread
    level, unit = cases.torque[:, joint].mean(), cases.torque[:, joint].std()
    parts = rival.processes[joint].kernel_
    noise = parts.k2.noise_level
    factor = cho_factor(kernel(a, a, parts) + noise * np.eye(len(a)), lower=True)
    across = kernel(b, a, parts)
    found = across @ cho_solve(factor, (cases.torque[:, joint] - level) / unit)
    known = np.einsum("ij,ji->i", across, cho_solve(factor, across.T))
    variance = parts.k1.k1.constant_value + noise - known
    return level + unit * found, unit * np.sqrt(variance)


def test_a_gaussian_process_is_the_closed_form():
    cases = data()
    rival = GaussianProcess("states", subset=60, restarts=0).fit(cases)
    x = states(30, 7, 0.9)
    for joint in range(2):
        mean, deviation = closed_form(rival, cases, x, joint)
        np.testing.assert_allclose(rival.torque(x)[:, joint], mean, rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(rival.deviation(x)[:, joint], deviation, rtol=1e-5)


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM])
def test_known_structure_leaves_nothing_of_clean_torques(arm):
    rival, x = SemiParametric((*RIGID, *GRAVITY)).fit(data(noise=0.0, arm=arm)), states(40, 8, 0.9)
    assert rival.exact and rival.count() == 5
    wanted = arm.inverse_dynamics(*np.moveaxis(x, -1, 0))
    np.testing.assert_allclose(rival.torque(x), wanted, rtol=1e-8, atol=1e-8)
    np.testing.assert_array_equal(rival.deviation(x), 0)
    truth = [arm.a, arm.b, arm.d, *arm.gravity_moments]
    np.testing.assert_allclose(rival.known.estimate.values, truth, rtol=1e-6, atol=1e-8)


def test_many_random_features_are_kernel_ridge_regression():
    cases, x = data(80, noise=0.3), states(30, 5, 0.9)
    rival = RandomFeatures("states", 20_000, lengths=(3.0,), seed=1).fit(cases)
    flat = cases.x.reshape(80, -1)
    a, b = ((f - flat.mean(0)) / flat.std(0) for f in (flat, x.reshape(30, -1)))
    for joint in range(2):
        y, penalty = cases.torque[:, joint], rival.ridge.alpha_[joint]
        gram, across = (np.exp(-0.5 * cdist(v, a, "sqeuclidean") / 9.0) for v in (a, b))
        centred = gram - gram.mean(0)  # ridge with a constant: the features centred
        doubly = centred - centred.mean(1, keepdims=True)
        weights = np.linalg.solve(doubly + penalty * np.eye(80), y - y.mean())
        row = across - gram.mean(0)
        wanted = y.mean() + (row - row.mean(1, keepdims=True)) @ weights
        error = rival.torque(x)[:, joint] - wanted
        assert np.sqrt(np.mean(error**2)) < 0.05 * y.std()
