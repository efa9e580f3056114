"""Why descent learns smooth filters: along which directions of the window, and how fast.

With the windows (a row each, and a one for the bias) as ``X = U S V'``, batch descent changes a
unit's weights within the span of V: along v_k at a rate in proportion to its squared singular
value, as long as the back-propagated error stands still. How the error changes is known for a
network that stays near its tangent ("lazy training", Chizat, Oyallon & Bach 2019): it is a sum of
modes of the neural tangent kernel JJ' (Jacot, Gabriel & Hongler 2018), J being the derivatives of
all outputs by all weights, and each mode follows a recursion of its own, `effective_steps`. For
one linear unit J is X (Widrow & Stearns 1985; LeCun, Kanter & Solla 1991).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array, instance, integer, non_negative, number, shaped
from ddlib.learning.network import Weights, from_rows
from ddlib.learning.training import WARM_UP_MOMENTUM, TrainingSet


def with_ones(x) -> np.ndarray:
    """Windows ``(cases, joint, width)`` as rows, with a one for the bias."""
    x = shaped("x", x, "(cases, joint, width)")
    return np.column_stack([x.reshape(len(x), -1), np.ones(len(x))])


@dataclass(frozen=True)
class Directions:
    """Singular directions of the windows of a training set, the steepest first."""

    values: np.ndarray  # singular values s_k
    axes: np.ndarray  # unit vectors v_k as rows: each joint's window, then the bias
    cases: np.ndarray  # unit vectors u_k as columns: how far cases lie along v_k, over s_k
    joints: int  # in a window

    @classmethod
    def of(cls, data: TrainingSet) -> Directions:
        """Directions with the sign that makes the last sample of their main joint positive."""
        instance("data", data, TrainingSet)
        cases, values, axes = np.linalg.svd(with_ones(data.x), full_matrices=False)
        filters = axes[:, :-1].reshape(len(axes), *data.x.shape[1:])
        main = (filters**2).sum(-1).argmax(-1)
        sign = np.where(filters[np.arange(len(axes)), main, -1] < 0, -1.0, 1.0)
        return cls(values, sign[:, None] * axes, cases * sign, data.x.shape[1])

    @property
    def filters(self) -> np.ndarray:
        """The directions as filters of each joint's window, ``(directions, joint, width)``."""
        return self.axes[:, :-1].reshape(len(self.axes), self.joints, -1)

    def along(self, weights: Weights) -> np.ndarray:
        """Components of every unit's weights and bias, ``(..., unit, directions)``."""
        instance("weights", weights, Weights)
        return weights.rows @ self.axes.T

    def energy(self, weights: Weights, start: Weights | None = None) -> np.ndarray:
        """Squared components summed over units: of weights, or of what they changed by."""
        components = self.along(weights)
        if start is not None:
            components = components - self.along(start)
        return (components**2).sum(-2)


def effective_steps(rates, epochs, momentum: float = 0.0, warm_up: int = 0) -> np.ndarray:
    """How many plain steps against a standing error descent has taken: (epochs, modes).

    For a parameter p that starts at 0 with the slope ``g + curvature p`` of the error, p is
    ``-eps g q(t)`` after t epochs, and the share ``1 - rate q(t)`` of the slope is left. The
    recursion ``step = momentum step + 1 - rate q`` is linear, so that powers of one small matrix
    jump to any epoch.

    Parameters
    ----------
    rates : array_like, shape (modes,)
        Step size times curvature, 0 or more. Descent is stable below ``2 (1 + momentum)``.
    epochs : sequence of int
        When; must not decrease.
    momentum, warm_up
        As in `train_ensemble`.
    """
    shaped("epochs", epochs, "(points,)")
    rates = shaped("rates", non_negative("rates", rates), "(modes,)")
    number("momentum", momentum, 0.0, 0.999)
    integer("warm_up", warm_up, 0)
    epochs = [integer("epochs", epoch, 0) for epoch in epochs]
    if sorted(epochs) != epochs:
        raise ValueError(f"epochs must not decrease, got {epochs}")

    def epoch_matrix(alpha):
        """One epoch of (q, last step, 1)."""
        matrix = np.zeros((rates.size, 3, 3))
        matrix[:, :2, 0], matrix[:, :2, 1], matrix[:, :, 2] = -rates[:, None], alpha, 1.0
        matrix[:, 0, 0] += 1.0
        return matrix

    phases = (epoch_matrix(min(momentum, WARM_UP_MOMENTUM)), epoch_matrix(momentum))
    state, now, steps = np.tile([[0.0], [0.0], [1.0]], (rates.size, 1, 1)), 0, []
    for epoch in epochs:
        for matrix, stop in zip(phases, (min(epoch, warm_up), epoch)):
            if stop > now:
                state, now = np.linalg.matrix_power(matrix, stop - now) @ state, stop
        steps.append(state[:, 0, 0])
    return np.array(steps)


def jacobian(weights: Weights, x) -> np.ndarray:
    """Derivatives of one network's outputs in scaled windows, ``(cases, output, parameter)``.

    Parameters are its `Weights.rows` one after the other, then the hidden-to-output weights.
    """
    instance("weights", weights, Weights)
    hidden, output = weights.activity(x)
    own = np.eye(output.shape[-1])
    shape = (len(hidden), len(own), -1)
    through = weights.output_weights * (hidden * (1 - hidden))[:, None]
    by_net = np.concatenate([through, np.broadcast_to(own, (len(hidden), *own.shape))], 2)
    first = by_net[..., None] * with_ones(x)[:, None, None]
    second = own[:, :, None] * hidden[:, None, None]
    parts = np.concatenate([first.reshape(shape), second.reshape(shape)], 2)
    return (output * (1 - output))[..., None] * parts


def with_change(weights: Weights, change) -> Weights:
    """One network plus changes of its parameters, ``(..., parameter)``, ordered as `jacobian`."""
    instance("weights", weights, Weights)
    start, change = weights.rows, finite_array("change", change)
    shaped("change", change, f"(..., {start.size + weights.output_weights.size})")
    first = start + change[..., : start.size].reshape(*change.shape[:-1], *start.shape)
    second = change[..., start.size :].reshape(*change.shape[:-1], *weights.output_weights.shape)
    return from_rows(first, weights.output_weights + second, weights.hidden_weights.shape[-2:])


class TangentCourse(NamedTuple):
    """What a network does along its training; a leading axis are the epochs."""

    weights: Weights
    error: np.ndarray  # output minus target, scaled, of shape (epochs, cases, output)


class Lazy:
    """A network replaced by its tangent at the initial weights: its training in closed form.

    `curvatures` are the eigenvalues of J'J, falling.
    """

    def __init__(self, weights: Weights, data: TrainingSet):
        instance("weights", weights, Weights)
        instance("data", data, TrainingSet)
        if weights.hidden_bias.ndim != 1:
            raise ValueError(f"weights must be of one network, got {weights}")
        self._start, self._targets = weights, data.y
        self._output = weights.activity(data.x)[1]
        slopes = jacobian(weights, data.x)
        self._slopes = slopes.reshape(-1, slopes.shape[-1])
        curvatures, axes = np.linalg.eigh(self._slopes.T @ self._slopes)
        self.curvatures, self._axes = np.maximum(curvatures[::-1], 0.0), axes[:, ::-1]

    def predict(
        self, rate: float, epochs, momentum: float = 0.0, warm_up: int = 0, targets=None
    ) -> TangentCourse:
        """Weights and errors after some epochs of batch descent with momentum.

        `rate` is per case, as in `train`; scaled `targets` replace the training set's.
        """
        eps = number("rate", rate, 0.0, open_low=True) / len(self._output)
        error = self._output - (self._targets if targets is None else targets)
        gradient = (self._slopes.T @ error.ravel()) @ self._axes
        steps = effective_steps(eps * self.curvatures, epochs, momentum, warm_up)
        change = -eps * (steps * gradient) @ self._axes.T
        after = error.ravel() + change @ self._slopes.T
        return TangentCourse(with_change(self._start, change), after.reshape(-1, *error.shape))
