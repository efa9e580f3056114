"""Networks as rivals: the paper's, trained in three ways, and two that read sequences."""

from __future__ import annotations

import math
import warnings
from abc import abstractmethod

import numpy as np
import torch
from torch import nn

from beyond.rivals.protocol import Rival
from ddlib.learning import (
    INITIAL,
    NotConverged,
    TorqueModel,
    TrainingDiverged,
    TrainingSet,
    Weights,
    WindowNetwork,
    solve,
    train_ensemble,
)
from ddlib.paper import EPOCHS, HIDDEN_UNITS


class _Network(Rival):
    """A network with sigmoid hidden units and direct weights; how it is trained is left open."""

    def __init__(
        self, hidden=HIDDEN_UNITS, kind="windows", *, initial=INITIAL, scaling=(0.0, 1.0), seed=0
    ):
        self.kind, self.hidden, self.initial = kind, hidden, initial
        self.scaling, self.seed = scaling, seed

    def _fit(self, x, torque):
        low, high = (x.min(0), x.max(0)) if self.kind == "states" else (0.0, 1.0)
        self._range = low, high - low
        data = TrainingSet.from_arrays(self._even(x), torque, scaling=self.scaling)
        self.model = self._train(data)

    def _even(self, x):
        """States with each quantity from 0 to 1; windows as they are."""
        low, width = self._range
        return (x - low) / width

    def _start(self, data: TrainingSet) -> Weights:
        joints, width = data.x.shape[1:]
        shape = width, self.hidden, joints, data.y.shape[1]
        return Weights.random(1, *shape, initial=self.initial, seed=self.seed)

    @abstractmethod
    def _train(self, data: TrainingSet) -> TorqueModel:
        """One trained network."""

    def _torque(self, x):
        return self.model.torque(self._even(x))

    def count(self):
        weights = self.model.weights
        return weights.count(biases=True) + 2 * weights.output_bias.size


class ByDescent(_Network):
    """The network by batch descent with momentum, as `ddlib.learning.train_ensemble`."""

    def __init__(
        self, hidden=HIDDEN_UNITS, epochs=EPOCHS, *, rate=None, momentum=0.95, warm_up=0, **options
    ):
        super().__init__(hidden, **options)
        self.epochs, self.rate, self.momentum, self.warm_up = epochs, rate, momentum, warm_up

    def _train(self, data):
        options = {"rate": self.rate, "momentum": self.momentum, "warm_up": self.warm_up}
        model, *_ = train_ensemble(
            self._start(data), data, epochs=self.epochs, progress=False, **options
        )
        return model[0]


class BySolver(_Network):
    """The network by Levenberg-Marquardt; it may stop before it has converged.

    Beside `steps` and `decay` of `ddlib.learning.levenberg_marquardt.solve` there are the kind of
    the inputs ("windows" or "states"), the size of the initial weights, and the seed.
    """

    def __init__(self, hidden=HIDDEN_UNITS, steps=60, *, decay=0.0, **options):
        super().__init__(hidden, **options)
        self.steps, self.decay = steps, decay

    def _train(self, data):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)  # the number of steps is the setting
            solution = solve(
                self._start(data)[0], data, steps=self.steps, decay=self.decay, progress=False
            )
        return solution.model


class ByAdam(_Network):
    """The network by Adam with decoupled weight decay, all cases at once, inputs from -1 to 1."""

    def __init__(self, hidden=HIDDEN_UNITS, epochs=3000, *, rate=0.02, decay=0.01, **options):
        super().__init__(hidden, **{"scaling": (-1.0, 1.0), **options})
        self.epochs, self.rate, self.decay = epochs, rate, decay

    def _train(self, data):
        joints, width = data.x.shape[1:]
        network = WindowNetwork(
            width, self.hidden, joints, data.y.shape[1], initial=self.initial, seed=self.seed
        )
        _adam(network, data.x, data.y, self.epochs, self.rate, self.decay)
        weights = network.weights()
        return TorqueModel(weights, data.inputs, data.outputs)


def _adam(
    module: torch.nn.Module, x, y, epochs: int, rate: float, decay: float, batch=None, seed=0
) -> float:
    """Train a module in place by Adam with decoupled weight decay (Loshchilov & Hutter 2019)."""
    x, y = (torch.as_tensor(np.array(each), dtype=torch.float32) for each in (x, y))
    batch = len(x) if batch is None else batch
    parts, draws = -(-len(x) // batch), torch.Generator().manual_seed(seed)
    steps = epochs * parts
    optimiser = torch.optim.AdamW(module.parameters(), lr=rate, weight_decay=decay, fused=True)
    falling = torch.optim.lr_scheduler.LambdaLR(
        optimiser, lambda step: 0.5 * (1 + math.cos(math.pi * step / steps))
    )
    for _ in range(epochs):
        order = torch.randperm(len(x), generator=draws) if parts > 1 else slice(None)
        for inputs, wanted in zip(x[order].split(batch), y[order].split(batch)):
            optimiser.zero_grad()
            loss = (module(inputs) - wanted).square().mean()
            loss.backward()
            optimiser.step()
            falling.step()
    if not torch.isfinite(loss):
        raise TrainingDiverged(f"the error is not finite: lower the rate ({rate:g})", None)
    return float(loss.detach())


_BATCH = 100  # cases of a step of descent


class _Sequence(Rival):
    """A network over the window as a sequence, by Adam: its middle, and deviations from it."""

    kind = "windows"

    def __init__(self, channels=16, epochs=100, *, rate=0.01, decay=0.01, seed=0):
        self.channels, self.epochs = channels, epochs
        self.rate, self.decay, self.seed = rate, decay, seed

    @abstractmethod
    def _network(self, joints: int, width: int, outputs: int) -> nn.Module:
        """Of ``(cases, 2 joint, width)`` to ``(cases, output)``."""

    def _fit(self, x, torque):
        joints, width = x.shape[1:]
        self.scale = [(each.mean((0, 2)), each.std((0, 2))) for each in self._parts(x)]
        self.offset, self.spread = torque.mean(0), torque.std(0)
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
            output = self.network(torch.tensor(self._channels(x), dtype=torch.float32))
        return self.offset + self.spread * output.numpy().astype(float)

    def count(self):
        numbers = sum(p.numel() for p in self.network.parameters())
        return numbers + 4 * len(self.scale[0][0]) + 2 * self.offset.size


class Convolution(_Sequence):
    """Two layers of convolutions along the window, then a linear one over all that is left."""

    TAPS = 5  # samples that a filter sees

    def __init__(self, channels=8, epochs=100, **options):
        super().__init__(channels, epochs, **options)

    def _network(self, joints, width, outputs):
        left = width - 2 * (self.TAPS - 1)
        return nn.Sequential(
            nn.Conv1d(2 * joints, self.channels, self.TAPS),
            nn.SiLU(),
            nn.Conv1d(self.channels, self.channels, self.TAPS),
            nn.SiLU(),
            nn.Flatten(),
            nn.Linear(self.channels * left, outputs),
        )


class Recurrent(_Sequence):
    """A gated recurrent unit that reads the window; its last state gives the torques."""

    def __init__(self, channels=16, epochs=60, **options):
        super().__init__(channels, epochs, **options)

    def _network(self, joints, width, outputs):
        return _LastState(2 * joints, self.channels, outputs)


class _LastState(nn.Module):
    def __init__(self, inputs, units, outputs):
        super().__init__()
        self.recurrent = nn.GRU(inputs, units, batch_first=True)
        self.output = nn.Linear(units, outputs)

    def forward(self, x):
        return self.output(self.recurrent(x.transpose(1, 2))[0][:, -1])
