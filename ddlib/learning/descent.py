"""The arithmetic of `ddlib.learning.training.train_ensemble`: one epoch of many networks at once.

All members see the same inputs, so one matrix product serves them all; the rest is done
in place, on as few members as fit into a core's cache.
"""

from __future__ import annotations

import platform
from collections.abc import Callable

import numpy as np
import torch

from ddlib.learning.network import Weights

_times_slope = torch.ops.aten.sigmoid_backward.grad_input  # g, s -> g s (1 - s), one pass

ONEDNN = (
    torch.backends.mkldnn.is_available()
    and platform.machine().lower() in {"x86_64", "amd64"}
    and all(
        hasattr(torch.ops.mkldnn, f"_{op}") for op in ("reorder_linear_weight", "linear_pointwise")
    )
)
"""Whether products with the inputs may go through oneDNN, by the operators that torch's compiler
uses. Its kernels take the widest registers of any processor, those of MKL of Intel's alone."""

LEAST = 300_000
"""Multiplications from which a product is worth oneDNN's longer way."""


class Descent:
    """Batch gradient descent with acceleration of many networks on the same inputs.

    The input-to-hidden and direct weights of all members are the rows of one matrix:
    member by member the hidden units, then the outputs; its last column holds the biases.

    Parameters
    ----------
    weights : Weights
        Initial weights with one leading axis of members.
    x : ndarray, shape (cases, joint, width)
        Scaled windows.
    y : ndarray, shape (cases, output) or (members, cases, output)
        Scaled targets, shared or one set per member.
    eps, momentum : float or ndarray, shape (members,)
        Step size of the summed gradient, and the factor of the previous step.
    """

    def __init__(self, weights: Weights, x, y, eps, momentum):
        n, self.hidden = weights.hidden_bias.shape
        self.shape, self.members = weights.hidden_weights.shape[-2:], n
        inputs = int(np.prod(self.shape))
        layers = (weights.hidden_weights, weights.direct_weights)
        rows = np.concatenate([w.reshape(n, -1, inputs) for w in layers], 1)
        biases = np.concatenate([weights.hidden_bias, weights.output_bias], 1)
        first = np.concatenate([rows, biases[..., None]], -1)
        self.rows = first.shape[1]
        self.first = _tensor(first.reshape(n * self.rows, -1))
        self.second = _tensor(weights.output_weights)
        self.inputs = _with_ones(x)
        self.targets = _tensor(np.swapaxes(y, -1, -2))
        per_member = [np.broadcast_to(value, n) for value in (eps, momentum)]
        self.eps, self.momentum = (
            [_tensor(np.repeat(v, self.rows))[:, None], _tensor(v)[:, None, None]]
            for v in per_member
        )
        self.step_first = torch.zeros_like(self.first)
        self.step_second = torch.zeros_like(self.second)
        cases = self.inputs.shape[1]
        self.back = torch.empty(n, self.hidden, cases)
        self.delta = torch.empty(n, self.rows - self.hidden, cases)
        self._net = times(self.inputs, len(self.first))
        self._gradient = times(self.inputs.t().contiguous(), len(self.first))

    def _activities(self, net):
        """Activities of the hidden and output units, in place, as views of `net`."""
        net = net.view(self.members, self.rows, -1)
        hidden, output = net[:, : self.hidden], net[:, self.hidden :]
        hidden.sigmoid_()
        output.baddbmm_(self.second, hidden).sigmoid_()
        return hidden, output

    @torch.inference_mode()
    def epoch(self, wanted: bool = False, most: float = 1.0) -> np.ndarray | None:
        """One step of every member, in place.

        Parameters
        ----------
        wanted : bool
            Return the `mean_square` errors before the step; they cost nothing here.
        most : float
            Largest momentum of this step.
        """
        net = self._net(self.first)
        hidden, output = self._activities(net)
        torch.sub(output, self.targets, out=self.delta)
        errors = self._mean_square(self.delta) if wanted else None
        _times_slope(self.delta, output, grad_input=self.delta)
        gradient_second = torch.bmm(self.delta, hidden.transpose(1, 2))
        torch.bmm(self.second.transpose(1, 2), self.delta, out=self.back)
        _times_slope(self.back, hidden, grad_input=hidden)
        output.copy_(self.delta)
        gradients = (self._gradient(net), gradient_second)
        steps, weights = (self.step_first, self.step_second), (self.first, self.second)
        for step, weight, gradient, eps, alpha in zip(
            steps, weights, gradients, self.eps, self.momentum
        ):
            step.mul_(alpha.clamp(max=most) if most < 1 else alpha).sub_(gradient.mul_(eps))
            weight.add_(step)
        return errors

    def mean_square(self, inputs, targets) -> np.ndarray:
        """Mean squared error of each member and output, shape (members, output).

        NaN for members whose weights are not finite.

        Parameters
        ----------
        inputs : torch.Tensor
            Windows prepared by `prepare`.
        targets : torch.Tensor, shape (output, cases)
        """
        _, output = self._activities(torch.mm(self.first, inputs))
        return self._mean_square(output.sub_(targets))

    def _mean_square(self, delta) -> np.ndarray:
        errors = delta.square().mean(-1).numpy().astype(float)
        fine = torch.isfinite(self.first).all(1).view(-1, self.rows).all(1)
        fine &= torch.isfinite(self.second).all(2).all(1)
        errors[~fine.numpy()] = np.nan
        return errors

    def weights(self) -> Weights:
        """All members as plain arrays."""
        first = self.first.numpy().astype(float).reshape(self.members, self.rows, -1)
        hidden, skip = first[:, : self.hidden, :-1], first[:, self.hidden :, :-1]
        return Weights(
            hidden.reshape(*hidden.shape[:2], *self.shape),
            first[:, : self.hidden, -1],
            self.second.numpy().astype(float),
            skip.reshape(*skip.shape[:2], *self.shape),
            first[:, self.hidden :, -1],
        )


def times(matrix: torch.Tensor, rows: int) -> Callable[[torch.Tensor], torch.Tensor]:
    """Products ``left @ matrix`` with a matrix that stays the same, packed once.

    Parameters
    ----------
    matrix : torch.Tensor, shape (inner, columns)
        In single precision.
    rows : int
        Of each matrix ``left``.

    Returns
    -------
    callable
        ``left -> left @ matrix``, a new tensor of shape (rows, columns).
    """
    if not ONEDNN or rows * matrix.numel() < LEAST:
        return lambda left: torch.mm(left, matrix)
    packed = torch.ops.mkldnn._reorder_linear_weight(matrix.t().contiguous(), rows)
    linear = torch.ops.mkldnn._linear_pointwise
    return lambda left: linear(left, packed, None, "none", [], "")


def prepare(x, y) -> tuple[torch.Tensor, torch.Tensor]:
    """Windows ``(cases, joint, width)`` and targets ``(cases, output)`` for `mean_square`."""
    return _with_ones(x), _tensor(np.swapaxes(y, -1, -2))


def _tensor(array) -> torch.Tensor:
    return torch.tensor(np.ascontiguousarray(array), dtype=torch.float32)


def _with_ones(x) -> torch.Tensor:
    """Inputs as columns, with a row of ones for the biases."""
    x = np.asarray(x).reshape(len(x), -1)
    return _tensor(np.vstack([x.T, np.ones(len(x))]))
