"""Feedback-error learning: the feedback's torque is the error that a model learns from.

A feedforward model of the desired motion stands beside a feedback controller, as in Figure 2-1.
What the feedback still has to add tells what the model lacks (Kawato, Furukawa & Suzuki 1987).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ddlib._check import non_negative, number, shaped
from ddlib.control.adaptive import PARAMETERS, mixed_regressor
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory


@dataclass(frozen=True)
class RigidBodyTerms:
    """The regressor's columns and friction as the terms of a feedback-error learner.

    The terms of 1987 could not be had; these can represent the arm exactly.

    Parameters
    ----------
    names : sequence of str
        Of `ddlib.control.adaptive.PARAMETERS`.
    """

    names: Sequence[str] = PARAMETERS[:3]

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Terms of each joint along a motion, shape (..., 2, terms)."""
        return mixed_regressor(q, qd, qd, qdd, self.names)


@dataclass(frozen=True)
class FeedbackErrorLearning:
    """Learn the weights of given terms while controlling.

    The torque is ``terms(desired motion) weights + feedback``; the weights move by
    ``d weights/dt = rate terms' feedback``. Where the feedback is ``gain s`` with one gain for all
    joints, this is Slotine & Li's law at the desired state with ``rate gain`` in place of its rate.

    Parameters
    ----------
    terms : callable
        ``terms(q, qd, qdd)`` over the desired motion, ``(..., time, 2)``, gives
        ``(..., time, 2, terms)``.
    rate : array_like, shape (terms,)
        Of learning, 0 or more.
    weights : array_like, shape (terms,) or (..., terms)
        What the run begins with; leading axes are runs.
    feedback : Controller or callable
        What corrects, and teaches.

    Source: Kawato, Furukawa & Suzuki 1987; Miyamoto, Kawato, Setoyama & Suzuki 1988.
    """

    terms: Callable
    rate: Sequence[float]
    weights: Sequence[float]
    feedback: Controller

    def __post_init__(self):
        rate = shaped("rate", self.rate, "(terms,)")
        non_negative("rate", rate)
        shaped("weights", self.weights, f"(..., {len(rate)})")

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it holds its weights."""
        number("step", step, 0.0, open_low=True)
        wanted = f"(..., {reference.q.shape[-2]}, 2, {len(self.rate)})"
        terms = shaped("terms(q, qd, qdd)", self.terms(*reference), wanted)
        return _Law(self, terms, as_controller(self.feedback).start(reference, step), step)


class _Law:
    """A running learner: called once a control period, it remembers its weights."""

    def __init__(self, controller, terms, feedback, step):
        self._terms, self._feedback = terms, feedback
        self._rate = step * np.asarray(controller.rate, float)
        self._kept = [np.asarray(controller.weights, float)]

    def __call__(self, k, q, qd):
        terms, correction = self._terms[..., k, :, :], self._feedback(k, q, qd)
        weights = self._kept[-1]
        change = np.einsum("...jp,...j->...p", terms, correction)
        self._kept.append(weights + self._rate * change)
        return np.einsum("...jp,...p->...j", terms, weights) + correction

    @property
    def weights(self) -> np.ndarray:
        """Weights before each call and after the last, shape (..., calls + 1, terms)."""
        return np.stack(np.broadcast_arrays(*self._kept), -2)
