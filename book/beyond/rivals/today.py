"""What one would try today: ensembles of networks on states, beside the equations or alone."""

from __future__ import annotations

import numpy as np
import torch
from torch import nn

from beyond.rivals.identified import Identified
from beyond.rivals.networks import _adam
from beyond.rivals.protocol import Rival


class _Layers(nn.Module):
    """Members side by side, of two layers of tanh: (cases, input) to (member, cases, output)."""

    def __init__(self, members: int, inputs: int, units: int, outputs: int):
        super().__init__()
        sizes = [(inputs, units), (units, units), (units, outputs)]
        self.weights = nn.ParameterList(torch.randn(members, *s) / s[0] ** 0.5 for s in sizes)
        self.biases = nn.ParameterList(torch.zeros(members, 1, s[1]) for s in sizes)

    def forward(self, x):
        for weight, bias in zip(self.weights[:-1], self.biases[:-1]):
            x = torch.tanh(x @ weight + bias)
        return x @ self.weights[-1] + self.biases[-1]


class StateNetworks(Rival):
    """An ensemble of networks of a state and the direction of each joint, trained by Adam.

    Parameters
    ----------
    units
        Of each of two layers.
    decay
        Weight decay.
    members, epochs, rate, seed
        Of the ensemble and its training.
    saturates
        Speed at which a joint's direction is nearly certain, rad/s.
    """

    def __init__(
        self, units=24, decay=0.01, *, members=3, epochs=1000, rate=0.01, saturates=0.02, seed=0
    ):
        self.units, self.decay, self.members = units, decay, members
        self.epochs, self.rate, self.saturates, self.seed = epochs, rate, saturates, seed

    def _inputs(self, x):
        return np.concatenate([x.reshape(len(x), -1), np.tanh(x[..., 1] / self.saturates)], 1)

    def _fit(self, x, torque):
        z = self._inputs(x)
        self.middle, self.size = z.mean(0), z.std(0)
        self.level, self.unit = torque.mean(0), torque.std(0)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.seed)
            self.layers = _Layers(self.members, z.shape[1], self.units, torque.shape[1])
        scaled = (z - self.middle) / self.size, (torque - self.level) / self.unit
        _adam(self.layers, *scaled, self.epochs, self.rate, self.decay)

    def each(self, x) -> np.ndarray:
        """What each member says, (member, cases, joint), N m."""
        z = torch.tensor((self._inputs(x) - self.middle) / self.size, dtype=torch.float32)
        with torch.no_grad():
            return self.level + self.unit * self.layers(z).numpy().astype(float)

    def _torque(self, x):
        return self.each(x).mean(0)

    def deviation(self, x) -> np.ndarray:
        """How far the members disagree: their standard deviation, (cases, joint), N m."""
        return self.each(x).std(0, ddof=1)

    def count(self):
        """Stored numbers: of all members, and of the scaling."""
        learnt = sum(part.numel() for part in self.layers.parameters())
        return learnt + 2 * (len(self.middle) + len(self.level))


class EquationsAndNetworks(Rival):
    """The arm's equations, and `StateNetworks` for the torque that they leave over."""

    def __init__(self, units=24, decay=0.01, **options):
        self.known, self.rest = Identified(), StateNetworks(units, decay, **options)

    def _fit(self, x, torque):
        self.known._fit(x, torque)
        self.rest._fit(x, torque - self.known._torque(x))

    def _torque(self, x):
        return self.known._torque(x) + self.rest._torque(x)

    def deviation(self, x) -> np.ndarray:
        """As of `StateNetworks`; the parameters count as known."""
        return self.rest.deviation(x)

    def count(self):
        """Stored numbers of the equations and of the networks."""
        return self.known.count() + self.rest.count()
