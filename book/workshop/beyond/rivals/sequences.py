"""Networks that read a window as a sequence: convolutions along time, and a gated recurrent unit.

The paper's network belongs to them: slid along a recording it is a convolution as wide as its
window, with a layer of width one on top (`as_convolution`).
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
import torch
from torch import nn

from ddlib._check import integer, number
from ddlib.dynamics import Operations
from ddlib.learning import Weights
from workshop.beyond.rivals.networks import _adam
from workshop.beyond.rivals.protocol import Rival

_BATCH = 100  # cases of a step of descent


def as_convolution(weights: Weights) -> nn.Module:
    """The window network as a convolutional one, in double precision.

    It takes scaled positions ``(recordings, joint, time)`` to output activities ``(recordings,
    output, time - width + 1)``: no window is cut, and none is computed twice.
    """
    if weights.hidden_bias.ndim != 1:
        raise ValueError(f"weights must be of one network, got {weights!r}")
    return _Slid(weights)


class _Slid(nn.Module):
    """Two convolutions of the window's width, and one of width 1 from hidden to output units."""

    def __init__(self, weights: Weights):
        super().__init__()
        (hidden, joints, width), outputs = weights.hidden_weights.shape, weights.output_bias.size
        self.hidden = nn.Conv1d(joints, hidden, width)
        self.direct = nn.Conv1d(joints, outputs, width)
        self.output = nn.Conv1d(hidden, outputs, 1, bias=False)
        given = {
            self.hidden.weight: weights.hidden_weights,
            self.hidden.bias: weights.hidden_bias,
            self.direct.weight: weights.direct_weights,
            self.direct.bias: weights.output_bias,
            self.output.weight: weights.output_weights[..., None],
        }
        for parameter, values in given.items():
            parameter.data = torch.tensor(values, dtype=torch.float64)

    def forward(self, x):
        return torch.sigmoid(self.direct(x) + self.output(torch.sigmoid(self.hidden(x))))


class _Sequence(Rival):
    """A network over the window as a sequence, trained by Adam; its layers are left open.

    Each joint's window enters as its middle position and the deviations from it, both scaled to
    a deviation of 1; torques likewise. The scaling counts among the stored numbers.
    """

    kind = "windows"

    def __init__(self, channels=16, epochs=100, *, rate=0.01, decay=0.01, seed=0):
        self.channels, self.epochs = integer("channels", channels, 1), integer("epochs", epochs, 1)
        self.rate = number("rate", rate, 0.0, open_low=True)
        self.decay, self.seed = number("decay", decay, 0.0), integer("seed", seed, 0)

    @abstractmethod
    def _network(self, joints: int, width: int, outputs: int) -> nn.Module:
        """Of ``(cases, 2 joint, width)`` to ``(cases, output)``."""

    def _fit(self, x, torque):
        joints, width = x.shape[1:]
        self.scale = [(each.mean((0, 2)), each.std((0, 2))) for each in self._parts(x)]
        self.offset, self.spread = torque.mean(0), torque.std(0)
        if not (np.ptp(x, (0, 2)) > 0).all() or not (np.ptp(torque, 0) > 0).all():
            raise ValueError("x and torque must vary in each joint")
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(self.seed)
            self.network = self._network(joints, width, torque.shape[1])
        scaled = (torque - self.offset) / self.spread
        options = self.epochs, self.rate, self.decay, _BATCH, self.seed
        _adam(self.network, self._channels(x), scaled, *options)

    @staticmethod
    def _parts(x):
        middle = x[..., x.shape[-1] // 2, None]
        return np.broadcast_to(middle, x.shape), x - middle

    def _channels(self, x):
        parts = []
        for part, (mean, spread) in zip(self._parts(x), self.scale):
            parts.append((part - mean[:, None]) / np.where(spread > 0, spread, 1.0)[:, None])
        return np.concatenate(parts, 1)

    def _torque(self, x):
        with torch.no_grad():
            found = self.network(torch.tensor(self._channels(x), dtype=torch.float32))
        return self.offset + self.spread * found.numpy().astype(float)

    def count(self):
        """Stored numbers: weights, biases and all scaling."""
        numbers = sum(p.numel() for p in self.network.parameters())
        return numbers + 4 * len(self.scale[0][0]) + 2 * self.offset.size


class Convolution(_Sequence):
    """Two layers of convolutions along the window, then a linear one over all that is left."""

    TAPS = 5  # samples that a filter sees

    def __init__(self, channels=8, epochs=100, **options):
        super().__init__(channels, epochs, **options)

    def _network(self, joints, width, outputs):
        left = width - 2 * (self.TAPS - 1)
        if left < 1:
            raise ValueError(f"windows must have {2 * self.TAPS - 1} samples or more, got {width}")
        return nn.Sequential(
            nn.Conv1d(2 * joints, self.channels, self.TAPS),
            nn.SiLU(),
            nn.Conv1d(self.channels, self.channels, self.TAPS),
            nn.SiLU(),
            nn.Flatten(),
            nn.Linear(self.channels * left, outputs),
        )

    def operations(self):
        """Arithmetic of both convolutions with their units, and of the last layer."""
        products = units = 0
        length = self._shape[1]
        for layer in self.network:
            if isinstance(layer, nn.Conv1d):
                length -= self.TAPS - 1
                products += layer.weight.numel() * length
                units += self.channels * length
        products += self.network[-1].weight.numel()
        return Operations(products + units, products + units, units, units)


class Recurrent(_Sequence):
    """A gated recurrent unit that reads the window; its last state gives the torques."""

    def __init__(self, channels=16, epochs=60, **options):
        super().__init__(channels, epochs, **options)

    def _network(self, joints, width, outputs):
        return _LastState(2 * joints, self.channels, outputs)

    def operations(self):
        """Arithmetic of all steps of the unit along the window, and of the last layer."""
        steps, units = self._shape[1], self.channels
        gates = self.network.recurrent
        products = gates.weight_ih_l0.numel() + gates.weight_hh_l0.numel() + 3 * units
        last = self.network.output.weight.numel()
        sums = products + 4 * units
        curved = 3 * units * steps
        return Operations(steps * products + last, steps * sums + last, curved, curved)


class _LastState(nn.Module):
    def __init__(self, inputs, units, outputs):
        super().__init__()
        self.recurrent = nn.GRU(inputs, units, batch_first=True)
        self.output = nn.Linear(units, outputs)

    def forward(self, x):
        return self.output(self.recurrent(x.transpose(1, 2))[0][:, -1])
