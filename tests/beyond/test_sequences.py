"""Convolutions along the window against plain sums."""

import numpy as np
from scipy.special import expit

from beyond.rivals.networks import Convolution
from beyond.rivals.protocol import Cases


def windows(n=300, width=11, seed=0):
    """Windows of smooth motions, and torques with a second difference and a product in them."""
    rng = np.random.default_rng(seed)
    t = np.arange(width) - width // 2
    c = rng.normal(size=(n, 2, 3, 1))
    x = c[..., 0, :] + 0.05 * c[..., 1, :] * t + 0.01 * c[..., 2, :] * t**2
    y = c[:, :, 2, 0] * (1 + 0.5 * np.tanh(c[:, ::-1, 0, 0])) + c[:, :, 1, 0]
    return Cases(x, y, "windows", 0.01)


def scaled(rival, x):
    """The channels as the class describes them: middles and deviations, each scaled."""
    middle = np.repeat(x[..., 5:6], 11, -1)
    parts = []
    for part, (mean, spread) in zip((middle, x - middle), rival.scale):
        np.testing.assert_allclose(spread, part.std((0, 2)))
        parts.append((part - mean[:, None]) / spread[:, None])
    return np.concatenate(parts, 1)


def arrays(module) -> dict:
    return {name: p.detach().numpy().astype(float) for name, p in module.named_parameters()}


def test_convolutions_are_sums_along_the_window():
    data = windows(40)
    rival = Convolution(3, epochs=3).fit(data)
    w = arrays(rival.network)

    def layer(x, weight, bias):
        seen = np.lib.stride_tricks.sliding_window_view(x, 5, axis=-1)
        net = np.einsum("nctk,ock->not", seen, weight) + bias[:, None]
        return net * expit(net)

    x = layer(scaled(rival, data.x), w["0.weight"], w["0.bias"])
    x = layer(x, w["2.weight"], w["2.bias"])
    y = x.reshape(40, -1) @ w["5.weight"].T + w["5.bias"]
    wanted = data.torque.mean(0) + data.torque.std(0) * y
    np.testing.assert_allclose(rival.torque(data.x), wanted, atol=1e-4)
    assert rival.count() == sum(x.size for x in w.values()) + 8 + 4
