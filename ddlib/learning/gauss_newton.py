"""Error, gradient and second derivatives of a window network, for Levenberg-Marquardt.

Windows vary some hundred thousand times more in one direction than in another. The parameters may
therefore be taken in coordinates in which the inputs have unit mean square in every direction.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import torch

from ddlib.learning.network import Weights, from_rows
from ddlib.learning.training import TrainingSet

_BLOCK = 512  # cases whose products of inputs are held at once, or more while they are
_HELD = 600_000  # numbers at most, so that they stay in a core's cache
_float64 = partial(torch.as_tensor, dtype=torch.float64)
_zeros = partial(torch.zeros, dtype=torch.float64)


class Objective:
    """What `ddlib.learning.solve` minimises, as a function of one vector of parameters.

    The vector holds a row for each hidden unit, then for each output unit (the weights
    from the window, then the bias), and then the hidden-to-output weights. A row w is
    held as ``C'w`` with ``CC'`` the mean square of the inputs and the penalty, so that the
    inputs ``C^-1 [x, 1]`` are white; or, unless `whiten`, as it is (``C = I``).
    """

    def __init__(self, weights: Weights, data: TrainingSet, decay=0.0, test=None, whiten=True):
        self._hidden, *self._window = weights.hidden_weights.shape
        self._outputs = len(weights.output_bias)
        self._rows = self._hidden + self._outputs
        x = _columns(data.x)
        self._inputs, cases = x.shape
        self._split = self._rows * self._inputs

        self._decay = decay
        matrix = _zeros(self._inputs, self._inputs)
        matrix.diagonal()[:-1] = decay  # no penalty on the bias
        if whiten:
            power, axes = torch.linalg.eigh((x @ x.T + matrix) / cases)
            idle = power < 1e-14 * power[-1]  # nothing but rounding: weights stay as they are
            power[idle] = power[-1]
            self._colour, self._whiten = axes * power.sqrt(), axes / power.sqrt()
            busy = torch.where(idle, 0.0, self._whiten).T
        else:
            busy = self._colour = self._whiten = torch.eye(self._inputs, dtype=x.dtype)
        self._z, self._y = busy @ x, _float64(data.y).T.contiguous()
        self._test = (self._whiten.T @ _columns(test[0]), _float64(test[1]).T) if test else None
        self._penalty = busy @ matrix @ busy.T

        self._pairs = torch.tril_indices(self._hidden, self._hidden)
        self._blocks = _blocks(self._hidden, self._outputs)
        self._symmetric = _pair_number(self._inputs)
        size = self._symmetric.max() + 1
        self._products = _zeros(size, min(cases, max(_BLOCK, _HELD // size)))
        self._multiplied = None  # the first case of the block in `_products`

    def pack(self, weights: Weights) -> torch.Tensor:
        """Vector of a network's parameters, shape (parameter,)."""
        first = _float64(weights.rows) @ self._colour
        return torch.cat([first.flatten(), _float64(weights.output_weights).flatten()])

    def unpack(self, vector: torch.Tensor) -> Weights:
        """Network of a vector of parameters."""
        first, second = self._parts(vector)
        return from_rows((first @ self._whiten.T).numpy(), second.numpy().copy(), self._window)

    def value(self, vector: torch.Tensor) -> tuple[float, float]:
        """The objective (penalty included) and the pooled training RMSS."""
        square = (self._activity(vector, self._z)[1] - self._y).square()
        return 0.5 * float(square.sum()) + self._penalise(vector)[0], _rmss(square, self._y)

    def test_rmss(self, vector: torch.Tensor) -> float:
        """Pooled RMSS of the test cases, NaN if there are none."""
        if self._test is None:
            return np.nan
        z, y = self._test
        return _rmss((self._activity(vector, z)[1] - y).square(), y)

    def normal(self, vector: torch.Tensor, exact: bool = False) -> tuple[torch.Tensor, ...]:
        """Matrix of a Newton step, gradient, and lengths of the columns of J.

        J are the derivatives of the residuals (penalties among them). The matrix, of which only
        the lower triangle is set, is Gauss-Newton's ``J'J``, or if `exact` all second derivatives.
        """
        hidden, split = self._hidden, self._split
        row_blocks, cross, corner, slopes, squares = self._sums(vector, exact)
        matrix = _zeros(len(vector), len(vector))
        first, inputs = matrix[:split, :split], self._inputs
        blocks = first.view(self._rows, inputs, self._rows, inputs).numpy()
        blocks[self._blocks[0], :, self._blocks[1]] = row_blocks.numpy()[:, self._symmetric]
        lower = matrix[split:, :split].view(*cross.shape[:2], self._rows, self._inputs)
        lower[:, :, :hidden] = cross[:, :, :hidden]
        for o in range(self._outputs):
            own = slice(split + o * hidden, split + (o + 1) * hidden)
            matrix[own, own] = corner[o]
            lower[o, :, hidden + o] = cross[o, :, hidden]
        for r in range(self._rows):
            own = slice(r * self._inputs, (r + 1) * self._inputs)
            first[own, own] += self._penalty
        matrix.diagonal()[split:] += self._decay
        squares[0] += self._penalty.diagonal()
        squares[1] += self._decay
        gradient, squares = (torch.cat([x.flatten() for x in pair]) for pair in (slopes, squares))
        return matrix, gradient + self._penalise(vector)[1], squares.sqrt()

    def _parts(self, vector):
        first = vector[: self._split].view(self._rows, self._inputs)
        return first, vector[self._split :].view(self._outputs, self._hidden)

    def _activity(self, vector, z):
        first, second = self._parts(vector)
        net = first @ z
        hidden = torch.sigmoid(net[: self._hidden])
        return hidden, torch.sigmoid(torch.addmm(net[self._hidden :], second, hidden))

    def _multiply(self, z, start):
        """Products of all pairs of inputs in a block of cases, shape (pair, cases)."""
        products = self._products[:, : z.shape[1]]
        if self._multiplied != start:
            self._multiplied = start
            for i in range(self._inputs):
                row = i * (i + 1) // 2
                torch.mul(z[i], z[: i + 1], out=products[row : row + i + 1])
        return products

    def _penalise(self, vector):
        """The penalty and its gradient."""
        first, second = self._parts(vector)
        slope = torch.cat([(first @ self._penalty).flatten(), self._decay * second.flatten()])
        return 0.5 * float(vector @ slope), slope

    def _sums(self, vector, exact):
        """The sums over cases of which matrix, gradient and lengths consist.

        The net input of output o has the derivative ``f[o, r] z[i]`` by the weight i of row r,
        where f is ``second[o, r] hidden_slope[r]`` for a hidden unit and 1 for output o itself,
        and ``hidden[h]`` by the weight from hidden unit h. The block of the matrix between rows r
        and s sums ``z[i] z[j]`` times a product of factors, so that one product of matrices
        gives all blocks, each pair of rows and inputs once.

        `row_blocks`, (pair of rows, pair of inputs), has the orders of `_blocks` and
        `_pair_number`.
        `cross`, (output, hidden, hidden + 1, input), is the weight from a hidden unit to an
        output against all hidden rows and that output's, `corner` against its fellows. `slopes`
        and `squares` are the gradient and J's squared lengths, of rows and of those weights.
        """
        (_, second), (r, s) = self._parts(vector), self._pairs
        h, outputs = self._hidden, self._outputs
        k = torch.arange(h)
        both = (second[:, r] * second[:, s]).T
        row_blocks, corner = (
            _zeros(len(self._blocks[0]), len(self._products)),
            _zeros(outputs, h, h),
        )
        shared, own = _zeros(h * (h + 1), outputs * self._inputs), _zeros(outputs * h, self._inputs)
        slopes, squares = ([_zeros(self._rows, self._inputs), _zeros(outputs, h)] for _ in range(2))
        block = self._products.shape[1]
        for start in range(0, self._z.shape[1], block):
            z, y = (array[:, start : start + block] for array in (self._z, self._y))
            n = z.shape[1]
            hidden, output = self._activity(vector, z)
            slope, hidden_slope = output - output * output, hidden - hidden * hidden
            delta = (output - y) * slope
            back = (second.T @ delta) * hidden_slope
            slopes[0].addmm_(torch.cat([back, delta]), z.T)
            slopes[1].addmm_(delta, hidden.T)
            # J'J: the residual of output o has the derivative slope[o] times that of its net input
            bend = slope * slope
            steep = (second.square().T @ bend) * hidden_slope.square()
            squares[0].addmm_(torch.cat([steep, bend]), z.square().T)
            squares[1].addmm_(bend, hidden.square().T)

            if exact:  # the residual times its own bend: what J'J leaves out
                bend = bend + delta * (1 - 2 * output)
            bent = bend[:, None] * second[:, :, None] * hidden_slope
            pair = (both @ bend) * hidden_slope[r] * hidden_slope[s]
            if exact:  # (k, k) is pair k (k + 3) / 2: a hidden unit's sigmoid bends, too
                pair[k * (k + 3) // 2] += back * (1 - 2 * hidden)
                own.addmm_((delta[:, None] * hidden_slope).view(-1, n), z.T)
            # all blocks in one product, (pairs of rows, cases) @ (cases, pairs of inputs); with an
            # explicit J it is 1.6 to 3.6 times slower: every pair of inputs is multiplied anew
            products = self._multiply(z, start)
            row_blocks.addmm_(torch.cat([pair, bent.flatten(0, 1), bend]), products.T)
            factors = torch.cat([(hidden[:, None] * hidden_slope).flatten(0, 1), hidden])
            shared.addmm_(factors, (bend[:, None] * z).flatten(0, 1).T)
            corner += (bend[:, None] * hidden) @ hidden.T
        # back from pairs: what was summed for all outputs gets each output's own factor
        cross = torch.empty(outputs, h, h + 1, self._inputs, dtype=z.dtype)
        parts = shared.view(h + 1, h, outputs, self._inputs).permute(2, 0, 1, 3)
        torch.mul(parts[:, :h], second[:, None, :, None], out=cross[:, :, :h])
        cross[:, :, h] = parts[:, h]
        if exact:
            cross[:, k, k] += own.view(outputs, h, -1)
        return row_blocks, cross, corner, slopes, squares


def _columns(x) -> torch.Tensor:
    """Windows as columns, with a one for the bias, shape (input, cases)."""
    x = _float64(x).flatten(1)
    return torch.cat([x, torch.ones(len(x), 1, dtype=torch.float64)], 1).T


def _rmss(square, y) -> float:
    """Pooled RMSS as of `ddlib.metrics.rmss`; both arguments of shape (output, cases)."""
    return float((square.mean(1) / y.var(1, correction=0)).mean().sqrt())


def _pair_number(size: int) -> np.ndarray:
    """Number of the pair (i, j) in a lower triangle read by rows, shape (size, size)."""
    i, j = np.indices((size, size))
    i, j = np.maximum(i, j), np.minimum(i, j)
    return i * (i + 1) // 2 + j


def _blocks(hidden: int, outputs: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows (r, s), r >= s, whose block of the matrix is not zero: all but two different outputs."""
    first, second = np.tril_indices(hidden)
    own = hidden + np.arange(outputs)
    mixed = np.repeat(own, hidden), np.tile(np.arange(hidden), outputs)
    return np.concatenate([first, mixed[0], own]), np.concatenate([second, mixed[1], own])
