"""Velocity from position readings, up to the newest one: noise against lag.

A causal estimate is a row of weights, oldest reading first.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import filled, finite_array, integer, number, series, shaped
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory


def difference(periods: int, step: float) -> np.ndarray:
    """Weights of ``(q(t) - q(t - periods step)) / (periods step)``, shape ``(periods + 1,)``."""
    span = integer("periods", periods, 1) * number("step", step, 0.0, open_low=True)
    weights = np.zeros(periods + 1)
    weights[[0, -1]] = -1 / span, 1 / span
    return weights


def end_slope(width: int, degree: int, step: float) -> np.ndarray:
    """Weights of the slope, at the newest of `width` readings, of a least-squares polynomial.

    A line gives the velocity half a window ago; a parabola has no lag, and pays in noise.
    """
    integer("degree", degree, 1)
    integer("width", width, degree + 1)
    number("step", step, 0.0, open_low=True)
    x = np.arange(1 - width, 1) / width  # in windows, for the sake of conditioning
    return np.linalg.pinv(np.vander(x, degree + 1, increasing=True))[1] / (width * step)


def stacked(filters) -> np.ndarray:
    """Several weight rows as one array ``(filters, width)``, older readings weighted 0."""
    rows = [shaped("filters", row, "(width,)") for row in series("filters", filters)]
    if not rows:
        raise ValueError("filters must be one or more, got none")
    width = max(map(len, rows))
    return np.stack([np.pad(row, (width - len(row), 0)) for row in rows])


def noise_gain(weights) -> np.ndarray:
    """Noise of the estimate per white noise of the readings, 1/s, shape ``(...)``."""
    return np.linalg.norm(finite_array("weights", weights), axis=-1)


@dataclass(frozen=True)
class EstimatedVelocity:
    """A controller whose velocity comes from readings; before the first the arm is at rest."""

    feedback: Controller  #: What the estimated velocity is for.
    weights: tuple  #: Of the estimate, oldest reading first, (width,) or (runs, width).

    def __post_init__(self):
        as_controller(self.feedback, "feedback")
        filled("weights", self.weights)
        if finite_array("weights", self.weights).ndim == 0:
            raise ValueError(f"weights must have shape (..., width), got {self.weights}")

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        weights = np.asarray(self.weights, dtype=float)[..., None]
        law, past = as_controller(self.feedback).start(reference, step), None

        def estimated(k, q, qd):
            nonlocal past
            if past is None:
                past = np.repeat(q[..., None, :], weights.shape[-2], -2)
            elif past.shape[:-2] != q.shape[:-1]:  # runs may part with the first torque
                past = np.broadcast_to(past, (*q.shape[:-1], *past.shape[-2:])).copy()
            past[..., :-1, :] = past[..., 1:, :]
            past[..., -1, :] = q
            return law(k, q, (weights * past).sum(-2))

        return estimated
