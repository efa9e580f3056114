"""Feedback-error learning: the feedback's torque is the error that a model learns from.

A feedforward model of the desired motion stands beside a feedback controller, as in Figure 2-1.
What the feedback still has to add tells what the model lacks (Kawato, Furukawa & Suzuki 1987).
The model is a weighted sum of terms, or the torque of one motion over time, learnt trial by trial.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import gaussian_filter1d

from beyond.control.adaptive import PARAMETERS, mixed_regressor
from ddlib._check import finite_array, integer, non_negative, number, shaped
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory


@dataclass(frozen=True)
class RigidBodyTerms:
    """Terms of the arm's own equations, whose weights are its parameters.

    With the right weights they are the arm exactly. `names` says whose terms to take: some of
    `beyond.control.adaptive.PARAMETERS`, of inertia and of friction.
    """

    names: Sequence[str] = PARAMETERS[:3]

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Terms of each joint along a motion, shape (..., 2, terms)."""
        return mixed_regressor(q, qd, qd, qdd, self.names)


@dataclass(frozen=True)
class GenericTerms:
    """Products of motions with sines and cosines, without the terms of the arm's own equations.

    The two accelerations, the three products of two velocities and the two velocities, each times
    1, ``sin q1``, ``sin(q2 / 2)`` and ``cos(2 q2)``; each joint has weights of its own. Missing are
    terms that the torque of two links with Coulomb friction has: accelerations times ``cos q2``,
    products of velocities times ``sin q2``, and signs of velocities.
    """

    count: int = field(default=2 * 7 * 4, init=False)  # joints, motions, factors

    def __call__(self, q, qd, qdd) -> np.ndarray:
        """Terms of each joint along a motion, shape (..., 2, terms)."""
        pairs = zip(("q", "qd", "qdd"), (q, qd, qdd))
        q, qd, qdd = (finite_array(name, x, 2) for name, x in pairs)
        (q1, q2), (v1, v2), (a1, a2) = (np.moveaxis(x, -1, 0) for x in (q, qd, qdd))
        motions = np.stack([a1, a2, v1 * v1, v1 * v2, v2 * v2, v1, v2], -1)
        factors = np.stack([np.ones_like(q1), np.sin(q1), np.sin(q2 / 2), np.cos(2 * q2)], -1)
        products = (motions[..., :, None] * factors[..., None, :]).reshape(*q1.shape, -1)
        terms = np.zeros((*q1.shape, 2, self.count))
        terms[..., 0, : self.count // 2] = terms[..., 1, self.count // 2 :] = products
        return terms


@dataclass(frozen=True)
class FeedbackErrorLearning:
    """Learn the weights of given terms while controlling (Kawato, Furukawa & Suzuki 1987).

    The torque is ``terms(desired motion) weights + feedback``; the weights move by
    ``d weights/dt = rate terms' feedback``, where ``terms'`` is the transpose. If the feedback is
    ``gain s``, with one gain for all joints and s the error of velocity plus a multiple of that of
    angle, this is Slotine & Li's law (`beyond.control.adaptive`) at the desired state, with
    ``rate gain`` in place of its rate.
    """

    terms: Callable  # of q, qd, qdd of the desired motion: (..., time, 2, terms)
    rate: Sequence[float]  # of learning, (..., terms)
    weights: Sequence[float]  # what the run begins with, (..., terms)
    feedback: Controller  # corrects, and teaches

    def __post_init__(self):
        rate = shaped("rate", self.rate, "(..., terms)")
        non_negative("rate", rate)
        shaped("weights", self.weights, f"(..., {rate.shape[-1]})")

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it holds its weights."""
        number("step", step, 0.0, open_low=True)
        wanted = f"(..., {reference.q.shape[-2]}, 2, {np.shape(self.rate)[-1]})"
        terms = shaped("terms(q, qd, qdd)", self.terms(*reference), wanted)
        return _Law(self, terms, as_controller(self.feedback).start(reference, step), step)


class _Law:
    """One run of `FeedbackErrorLearning`; it keeps the weights of every call."""

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


class MotionMemory:
    """Iterative learning control (Arimoto, Kawamura & Miyazaki 1984) of one motion.

    It stores a torque over time, which it sends in advance. After a trial, ``learn(law)`` adds at
    each sample ``rate`` times the torque that the feedback gave `lead` samples later, and smooths
    the sum. It knows this motion and no other: for one of another length its torque is stretched.
    """

    def __init__(
        self,
        feedback,
        rate: float,
        lead: int = 0,  # control samples from a wrong torque to the feedback that answers it
        smoothing: float = 0.0,  # deviation of a Gaussian, in control samples; 0: none
    ):
        self.feedback = as_controller(feedback)
        self.rate = number("rate", rate, 0.0)
        self.lead, self.smoothing = integer("lead", lead, 0), number("smoothing", smoothing, 0.0)
        self.torque = np.zeros(())  # N m, shape (..., time, 2) after the first trial

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s; it learns nothing yet."""
        return _MemoryLaw(self._played(reference), self.feedback.start(reference, step))

    def _played(self, reference):
        """The stored torque, stretched to the reference's samples by straight lines."""
        if not self.torque.ndim:
            return np.zeros_like(reference.q)
        samples, time = self.torque.shape[-2], reference.q.shape[-2]
        place = np.arange(time) * ((samples - 1) / (time - 1))  # among the stored samples
        before = np.minimum(place.astype(int), samples - 2)
        fraction = (place - before)[:, None]
        earlier, later = self.torque[..., before, :], self.torque[..., before + 1, :]
        return earlier + fraction * (later - earlier)

    def learn(self, law: ControlLaw) -> None:
        """Learn from a law that `start` gave, once it has run over the whole motion."""
        added = np.roll(law.added, -self.lead, axis=-2)
        added[..., added.shape[-2] - self.lead :, :] = 0.0  # nothing is known after the end
        torque = law.played + self.rate * added
        smooth = self.smoothing > 0
        self.torque = gaussian_filter1d(torque, self.smoothing, -2) if smooth else torque


class _MemoryLaw:
    """One run of `MotionMemory`; it keeps what it played and what the feedback added."""

    def __init__(self, played, feedback):
        self.played, self._feedback, self._added = played, feedback, []

    def __call__(self, k, q, qd):
        self._added.append(self._feedback(k, q, qd))
        return self.played[..., k, :] + self._added[-1]

    @property
    def added(self) -> np.ndarray:
        """What the feedback added, shape (..., calls, 2), N m."""
        return np.stack(np.broadcast_arrays(*self._added), -2)
