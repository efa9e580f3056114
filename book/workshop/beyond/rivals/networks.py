"""The paper's network as a rival: by descent as in 1988, by Levenberg-Marquardt, by Adam."""

from __future__ import annotations

import math
import warnings
from abc import abstractmethod

import numpy as np
import torch

from ddlib._check import integer, number, one_of
from ddlib.dynamics import Operations
from ddlib.learning import (
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
from workshop.beyond.rivals.protocol import _KINDS, Rival


class _Network(Rival):
    """A network with sigmoid hidden units and direct weights; how it is trained is left open.

    Positions of a window are scaled by the joint's range, states by that of each quantity. The
    scaling of the inputs goes into the weights and biases and is not stored for itself. Initial
    weights are uniform in plus or minus `initial`.
    """

    def __init__(
        self, hidden=HIDDEN_UNITS, kind="windows", *, initial=0.3, scaling=(0.0, 1.0), seed=0
    ):
        self.kind, self.hidden = one_of("kind", kind, _KINDS), integer("hidden", hidden, 1)
        self.initial = number("initial", initial, 0.0, open_low=True)
        self.scaling, self.seed = scaling, integer("seed", seed, 0)

    def _fit(self, x, torque):
        low, high = (x.min(0), x.max(0)) if self.kind == "states" else (0.0, 1.0)
        if np.any(high <= low):
            raise ValueError("x must vary in every position, velocity and acceleration")
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
        """Stored numbers: weights, biases, and the scaling of the torques."""
        weights = self.model.weights
        return weights.count(biases=True) + 2 * weights.output_bias.size

    def operations(self):
        """As section 3.2 counts, with the sigmoids: each weight one product and one sum."""
        weights = self.model.weights
        units = weights.hidden_bias.size + weights.output_bias.size
        each, outputs = weights.count(), weights.output_bias.size
        return Operations(each + outputs, each + units + outputs, units, units)


class ByDescent(_Network):
    """The network by batch descent with momentum, as `ddlib.learning.train_ensemble`."""

    def __init__(
        self, hidden=HIDDEN_UNITS, epochs=EPOCHS, *, rate=None, momentum=0.95, warm_up=0, **options
    ):
        super().__init__(hidden, **options)
        self.epochs = integer("epochs", epochs, 1)
        self.rate, self.momentum, self.warm_up = rate, momentum, warm_up

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
        self.steps, self.decay = integer("steps", steps, 1), number("decay", decay, 0.0)

    def _train(self, data):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)  # the number of steps is the setting
            found = solve(
                self._start(data)[0], data, steps=self.steps, decay=self.decay, progress=False
            )
        return found.model


class ByAdam(_Network):
    """The network by Adam with decoupled weight decay, all cases at once, inputs from -1 to 1."""

    def __init__(self, hidden=HIDDEN_UNITS, epochs=3000, *, rate=0.02, decay=0.01, **options):
        super().__init__(hidden, **{"scaling": (-1.0, 1.0), **options})
        self.epochs, self.rate, self.decay = integer("epochs", epochs, 1), rate, decay

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
    """Train a module in place by Adam with decoupled weight decay (Loshchilov & Hutter 2019).

    It takes scaled inputs ``(cases, joint, rows)`` to targets ``(cases, output)``. The step size
    falls from `rate` along half a cosine; a `batch` of cases is drawn anew in each epoch, by
    default all. The mean squared error of the last step's cases before it is returned.
    """
    number("rate", rate, 0.0, open_low=True)
    number("decay", decay, 0.0)
    x, y = (torch.as_tensor(np.array(each), dtype=torch.float32) for each in (x, y))
    batch = len(x) if batch is None else integer("batch", batch, 1)
    parts, draws = -(-len(x) // batch), torch.Generator().manual_seed(integer("seed", seed, 0))
    steps = integer("epochs", epochs, 1) * parts
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
