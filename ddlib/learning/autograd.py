"""One window network in PyTorch, and its training by autograd: for reading and for small runs."""

from __future__ import annotations

import numpy as np
import torch
from torch import nn
from tqdm.auto import tqdm

from ddlib._check import finite_array, flag, like
from ddlib.learning.network import _FIELDS, INITIAL, Weights
from ddlib.learning.training import (
    History,
    TrainingDiverged,
    _check_descent,
    _check_points,
    _warn_if_worse_than_mean,
)


class WindowNetwork(nn.Module):
    """One window network as a PyTorch module (Figure 3-1), drawn as by `Weights.random`."""

    def __init__(self, width, hidden=10, joints=2, outputs=2, *, initial=INITIAL, seed=0):
        super().__init__()
        draw = Weights.random(1, width, hidden, joints, outputs, initial, seed)[0]
        for name in _FIELDS:
            tensor = torch.tensor(getattr(draw, name), dtype=torch.float32)
            self.register_parameter(name, nn.Parameter(tensor))

    def forward(self, x):
        """Output activities, shape (cases, output), for windows (cases, joint, width)."""
        x = x.flatten(1)
        hidden = torch.sigmoid(x @ self.hidden_weights.flatten(1).T + self.hidden_bias)
        net = x @ self.direct_weights.flatten(1).T + hidden @ self.output_weights.T
        return torch.sigmoid(net + self.output_bias)

    def weights(self) -> Weights:
        """The weights as plain arrays."""
        return Weights(*(getattr(self, name).detach().numpy().copy() for name in _FIELDS))


def train(
    network: WindowNetwork, x, y, *, rate, momentum=0.95, epochs=1000, progress=True
) -> History:
    """Train one network in place by autograd: the plain reference, as in 1988 (section 3.3).

    ``dw(t) = -eps dE/dw + alpha dw(t-1)`` with E half the summed squared error of all cases and
    outputs (Rumelhart, Hinton & Williams 1986). Errors are noted before the step of an epoch.

    Parameters
    ----------
    x, y : array_like, shapes (cases, joint, width) and (cases, output)
        Scaled windows and targets.
    rate : float
        Step size per case: ``eps = rate / cases``.
    momentum : float
        The factor alpha of the previous step, 0 to 0.999.
    epochs : int
        Passes over all cases, a step each.

    Raises
    ------
    TrainingDiverged
        If the error is no longer finite; if it is, but ends above 1: a `WorseThanMean` warning.
    """
    like("network", network, "Module")
    flag("progress", progress)
    _check_descent(rate, momentum, epochs)
    x, y = finite_array("x", x), finite_array("y", y)
    if y.ndim != 2 or len(y) != len(x) or (np.ptp(y, axis=0) == 0).any():
        raise ValueError(
            f"y must have shape ({len(x)}, output) like x and vary in each column, got {y.shape}"
        )
    x, y = (torch.as_tensor(array, dtype=torch.float32) for array in (x, y))
    spread = y.std(0, correction=0)
    optimiser = torch.optim.SGD(network.parameters(), lr=rate / len(x), momentum=momentum)
    history, points = History(), set(_check_points(epochs))
    bar = tqdm(range(1, epochs + 1), desc="epochs", disable=not progress)
    for epoch in bar:
        optimiser.zero_grad()
        error = network(x) - y
        loss = 0.5 * error.square().sum()
        loss.backward()
        optimiser.step()
        if epoch in points:
            value = float((error.detach() / spread).square().mean().sqrt())
            history.append(epoch, value)
            bar.set_postfix(rmss=f"{value:.3f}")
            if not np.isfinite(value):
                raise TrainingDiverged(
                    f"the error is not finite at epoch {epoch}: lower the rate ({rate:g})", history
                )
    _warn_if_worse_than_mean(history, rate)
    return history
