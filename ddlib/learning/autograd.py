"""One window network in PyTorch, and its training by autograd: for reading and for small runs."""

from __future__ import annotations

import numpy as np
import torch
from torch import nn
from tqdm.auto import tqdm

from ddlib._check import finite_array, flag, instance, shaped
from ddlib.learning.network import INITIAL, WEIGHT_NAMES, TorqueModel, Weights
from ddlib.learning.training import (
    History,
    TrainingDiverged,
    _warn_if_worse_than_mean,
    check_descent,
    recorded_epochs,
)

_BLOCK = 4096  # cases whose gradients are held at once


class WindowNetwork(nn.Module):
    """One window network as a PyTorch module (Figure 3-1), drawn as by `Weights.random`."""

    def __init__(self, width, hidden=10, joints=2, outputs=2, *, initial=INITIAL, seed=0):
        super().__init__()
        draw = Weights.random(1, width, hidden, joints, outputs, initial, seed)[0]
        for name in WEIGHT_NAMES:
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
        return Weights(*(getattr(self, name).detach().numpy() for name in WEIGHT_NAMES))


class TorqueNetwork(nn.Module):
    """A `TorqueModel` as a PyTorch module: windows in rad to torques in N m.

    The scaling is inside, in buffers, so that ``state_dict()`` and ``torch.export.export`` take it
    along. Numbers are float64, with the torques of
    `TorqueModel.torque`; ``.float()`` makes them float32.

    Parameters
    ----------
    model : TorqueModel
        One network, or an ensemble with leading axes.
    """

    def __init__(self, model: TorqueModel):
        super().__init__()
        for name in WEIGHT_NAMES:
            array = np.array(getattr(model.weights, name), float)
            self.register_parameter(name, nn.Parameter(torch.from_numpy(array)))
        for name in ("inputs", "outputs"):
            scaler = getattr(model, name)
            for part in ("low", "high", "target"):
                array = np.array(getattr(scaler, part), float)
                self.register_buffer(f"{name}_{part}", torch.from_numpy(array))

    def forward(self, windows):
        """Torques, N m, ``(..., output)``, for windows, rad, ``(..., joint, width)``.

        The networks of an ensemble come first, in the axes in front.
        """
        low, target = self.inputs_low.unsqueeze(-1), self.inputs_target
        span = self.inputs_high.unsqueeze(-1) - low
        x = target[0] + (windows.to(low.dtype) - low) * ((target[1] - target[0]) / span)
        cases = x.shape[:-2]
        x = x.reshape(-1, x.shape[-2] * x.shape[-1])
        rows = self.hidden_weights.flatten(-2).transpose(-1, -2)
        hidden = torch.sigmoid(x @ rows + self.hidden_bias.unsqueeze(-2))
        net = x @ self.direct_weights.flatten(-2).transpose(-1, -2)
        net = net + hidden @ self.output_weights.transpose(-1, -2)
        output = torch.sigmoid(net + self.output_bias.unsqueeze(-2))
        target, span = self.outputs_target, self.outputs_high - self.outputs_low
        torque = self.outputs_low + (output - target[0]) * (span / (target[1] - target[0]))
        return torque.reshape(torque.shape[:-2] + cases + torque.shape[-1:])


def module_gradient(module: nn.Module, windows) -> np.ndarray:
    """Mean gradient of a module's torques, ``(..., output, joint, width)``, by autograd.

    The module is asked in its ``eval`` mode, in its own precision and on its own device.

    Parameters
    ----------
    module : torch.nn.Module
        Takes windows ``(cases, joint, width)`` and returns torques ``(..., cases, output)``, each
        case by itself.
    windows : array_like, shape (cases, joint, width)
        Over which the mean is taken.
    """
    windows = shaped("windows", windows, "(cases, joint, width)")
    some = next(
        (x for x in (*module.parameters(), *module.buffers()) if x.is_floating_point()), None
    )
    kind = {} if some is None else {"dtype": some.dtype, "device": some.device}
    modes = {part: part.training for part in module.modules()}
    total = 0.0
    module.eval()
    try:
        for start in range(0, len(windows), _BLOCK):
            x = torch.tensor(windows[start : start + _BLOCK], **kind).requires_grad_()
            torque = module(x)
            if not isinstance(torque, torch.Tensor) or torque.shape[-2:-1] != x.shape[:1]:
                got = getattr(torque, "shape", type(torque).__name__)
                raise ValueError(
                    f"model must return torques of shape (..., {len(x)}, output), got {got}"
                )
            sums = torque.sum(-2)
            gradients = [
                torch.autograd.grad(y, x, retain_graph=True)[0].sum(0) for y in sums.flatten()
            ]
            total = total + torch.stack(gradients).double().reshape(*sums.shape, *x.shape[1:])
    finally:
        for part, mode in modes.items():
            part.training = mode
    return finite_array("gradient of model", total.cpu().numpy() / len(windows))


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
    instance("network", network, nn.Module)
    flag("progress", progress)
    check_descent(rate, momentum, epochs)
    x, y = finite_array("x", x), finite_array("y", y)
    if y.ndim != 2 or len(y) != len(x) or (np.ptp(y, axis=0) == 0).any():
        raise ValueError(
            f"y must have shape ({len(x)}, output) like x and vary in each column, got {y.shape}"
        )
    x, y = (torch.as_tensor(array, dtype=torch.float32) for array in (x, y))
    spread = y.std(0, correction=0)
    optimiser = torch.optim.SGD(network.parameters(), lr=rate / len(x), momentum=momentum)
    history, points = History(), set(recorded_epochs(epochs))
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
