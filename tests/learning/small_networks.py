"""Small networks and data that they learn from, for the tests of several modules."""

import numpy as np

from ddlib.learning import sliding_windows
from ddlib.learning.network import WEIGHT_NAMES

WIDTH = 7


def smooth_cases(n=80, seed=0, noise=0.0):
    """Windows of two smooth signals and a torque-like target with a few cycles."""
    t = np.arange(n + WIDTH - 1) * 0.1
    rng = np.random.default_rng(seed)
    q = np.stack([np.sin(t + 0.3) + 0.3 * np.sin(2.7 * t), np.cos(1.3 * t)], -1)
    centre = q[WIDTH // 2 : -(WIDTH // 2)]
    torque = np.stack([np.gradient(centre[:, 0]), centre[:, 1] * centre[:, 0]], -1)
    windows = sliding_windows(q + noise * np.random.default_rng(seed).normal(size=q.shape), WIDTH)
    return windows, torque + 0.02 * rng.normal(size=torque.shape)


def parts(weights):
    return [getattr(weights, name) for name in WEIGHT_NAMES]


def close(weights, wanted, rtol, atol=0.0):
    for name, own, w in zip(WEIGHT_NAMES, parts(weights), wanted):
        np.testing.assert_allclose(own, w, rtol=rtol, atol=atol, err_msg=name)
