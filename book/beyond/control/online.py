"""The window network inside the controller: its weights change while the arm moves.

The controller runs every 2 ms, the network's samples are 10 ms apart. At each sample it learns
once, from measured windows and the torque applied there, or from desired windows and what the
feedback had to add; then it gives the torques of the next control periods. A learner outlives the
run; leading axes of its weights are runs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beyond.control.windowed import _reference_windows
from ddlib._check import integer, non_negative, number, one_of
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory

_TEACHERS = ("torque", "feedback", "nobody")
_NEAREST = 0.02  # least distance of a scaled torque from the ends of the output unit


def _sigmoid(x):
    return 0.5 * (1 + np.tanh(0.5 * x))


def _with_one(x):
    return np.concatenate([x, np.ones((*x.shape[:-1], 1))], -1)


class _OnlineNetwork:
    """The window network in plain arrays that a learner replaces; leading axes are runs."""

    def __init__(self, model):
        w = model.weights
        self.inputs, self.outputs = model.inputs, model.outputs
        self._low, self._gain = (x[:, None] for x in (self.inputs.low, self.inputs.gain))
        flat = [x.reshape(*x.shape[:-2], -1) for x in (w.hidden_weights, w.direct_weights)]
        self.hidden = np.concatenate([flat[0], w.hidden_bias[..., None]], -1)
        self.output = np.concatenate([w.output_weights, flat[1], w.output_bias[..., None]], -1)

    def features(self, windows) -> tuple[np.ndarray, np.ndarray]:
        """What the hidden units and the output units see of windows (rad), a row for each case."""
        x = self.inputs.target[0] + (windows - self._low) * self._gain
        seen = _with_one(x.reshape(*x.shape[:-2], -1))
        hidden = _sigmoid(seen @ np.swapaxes(self.hidden, -1, -2))
        passed = np.broadcast_to(seen, (*hidden.shape[:-1], seen.shape[-1]))
        return seen, np.concatenate([hidden, passed], -1)

    def activity(self, features) -> np.ndarray:
        """Output activities of features, shape (..., cases, 2)."""
        return _sigmoid(features @ np.swapaxes(self.output, -1, -2))

    def torque(self, windows) -> np.ndarray:
        """Torques, shape (..., cases, 2), N m, of windows as in `features`."""
        return self.newton_metres(self.activity(self.features(windows)[1]))

    def scaled(self, torque) -> np.ndarray:
        """Torques (N m) in the output units' range, last axis the joints."""
        return self.outputs.target[0] + (torque - self.outputs.low) * self.outputs.gain

    def newton_metres(self, activity) -> np.ndarray:
        """Output activities as torques, N m."""
        return self.outputs.low + (activity - self.outputs.target[0]) / self.outputs.gain

    def gradient(self, windows, error=None, torque=None) -> tuple[np.ndarray, np.ndarray]:
        """Backpropagation of the wanted torque, or of what it is beyond the network's (`error`)."""
        seen, features = self.features(windows)
        o = self.activity(features)
        error = self.scaled(torque) - o if error is None else error * self.outputs.gain
        delta = error * o * (1 - o)
        count, units = delta.shape[-2], self.hidden.shape[-2]
        h = features[..., :units]
        back = delta @ self.output[..., :units] * h * (1 - h)
        back, delta = np.swapaxes(back, -1, -2), np.swapaxes(delta, -1, -2)
        return back @ seen / count, delta @ features / count


class _OnlineDescent(_OnlineNetwork):
    """All weights learn by gradient descent, a step for each sample."""

    def __init__(
        self,
        model,  # what it begins with, a `TorqueModel`
        rate,  # of a step, in scaled units; one number, or one for each run
        momentum=0.0,
        replay=0,  # earlier samples that are drawn and learnt again in each step
        memory=3000,  # samples that are kept for it, the youngest
        seed=0,  # of the drawing, which is the same for all runs
    ):
        super().__init__(model)
        self.rate = non_negative("rate", np.asarray(rate, float))[..., None, None]
        self.momentum = number("momentum", momentum, 0.0, 0.999)
        self.replay, self.memory = integer("replay", replay, 0), integer("memory", memory, 1)
        self._rng, self._kept, self._steps = np.random.default_rng(seed), [], (0.0, 0.0)

    def learn(self, windows, torque) -> None:
        cases = [(windows, torque)]
        if self.replay:
            drawn = self._rng.integers(0, len(self._kept), self.replay) if self._kept else ()
            cases += [self._kept[k] for k in drawn]
            self._kept = [*self._kept[1 - self.memory :], (windows, torque)]
        windows = np.stack([w for w, _ in cases], -3)
        self._step(self.gradient(windows, torque=np.stack([t for _, t in cases], -2)))

    def correct(self, windows, feedback) -> None:
        """Learn that the torque of windows was short by what the feedback added, N m."""
        self._step(self.gradient(windows[..., None, :, :], feedback[..., None, :]))

    def _step(self, gradients):
        self._steps = tuple(
            self.momentum * last + self.rate * new for last, new in zip(self._steps, gradients)
        )
        self.hidden, self.output = self.hidden + self._steps[0], self.output + self._steps[1]


class LastLayer(_OnlineNetwork):
    """The output units' weights learn by recursive least squares; the hidden units stay.

    The target of a unit is the net input that would give the wanted torque. ``recursion(weights)``
    gives what learns from these weights on: a `ddlib.identification.RecursiveLeastSquares`.
    """

    def __init__(self, model, recursion):
        super().__init__(model)
        self.estimate = recursion(self.output)

    def learn(self, windows, torque) -> None:
        """Learn that windows ``(..., joint, width)`` go with torques ``(..., 2)``, N m."""
        features = self.features(windows[..., None, :, :])[1][..., 0, :]
        wanted = np.clip(self.scaled(torque), _NEAREST, 1 - _NEAREST)
        self.estimate.update(features, np.log(wanted / (1 - wanted)))
        self.output = self.estimate.weights


class _LinearFilter:
    """A linear filter of scaled windows, without hidden units, by recursive least squares."""

    def __init__(self, inputs, weights, recursion):
        self._target, self._low, self._gain = (
            inputs.target,
            *(x[:, None] for x in (inputs.low, inputs.gain)),
        )
        self.estimate = recursion(np.asarray(weights, float))
        self.weights = self.estimate.weights

    def _features(self, windows):
        x = self._target[0] + (windows - self._low) * self._gain
        return _with_one(x.reshape(*x.shape[:-2], -1))

    def torque(self, windows) -> np.ndarray:
        """Torques, shape (..., cases, 2), N m, of windows ``(..., cases, joint, width)``."""
        return self._features(windows) @ np.swapaxes(self.weights, -1, -2)

    def learn(self, windows, torque) -> None:
        self.estimate.update(self._features(windows), torque)
        self.weights = self.estimate.weights


@dataclass(frozen=True)
class OnlineFeedforward:
    """A learner of windows as feedforward that goes on learning while it controls.

    The learner, `LastLayer` or the like, has ``torque(windows)`` and, by what teaches it,
    ``learn(windows, torque)`` or ``correct(windows, feedback)`` of one window for each run.
    Measured windows are learnt half a window late; outside its samples the reference rests.
    """

    learner: object
    feedback: Controller
    width: int = 21  # odd
    teacher: str = "torque"  # or "feedback" or "nobody"
    every: int = 5  # control periods between two samples of a window
    limit: Sequence[float] = (np.inf, np.inf)  # largest torques of the motors that are learnt, N m

    def __post_init__(self):
        if integer("width", self.width, 3) % 2 == 0:
            raise ValueError(f"width must be odd, so that a window has a centre, got {self.width}")
        integer("every", self.every, 1)
        one_of("teacher", self.teacher, _TEACHERS)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        return _Law(self, reference, as_controller(self.feedback).start(reference, step))


class _Law:
    def __init__(self, controller: OnlineFeedforward, reference: Trajectory, feedback):
        self._feedback, self._every, self._limit = feedback, controller.every, controller.limit
        self._teacher, learner = controller.teacher, controller.learner
        self._learner, half = learner, controller.width // 2
        moving = (reference.qd != 0) | (reference.qdd != 0)
        self._moving = moving.any(axis=(*range(moving.ndim - 2), -1))
        self._half, self._read, self._applied = half, [], []
        self._windows = _reference_windows(reference.q, controller.width, self._every)
        if self._teacher == "nobody":
            self._ahead = learner.torque(self._windows)

    def __call__(self, k, q, qd):
        correction = self._feedback(k, q, qd)
        if self._teacher == "nobody":
            return self._ahead[..., k, :] + correction
        part = k % self._every
        if part == 0:
            self._read.append(q)
            self._teach(k, correction)
            self._ahead = self._learner.torque(self._windows[..., k : k + self._every, :, :])
        torque = self._ahead[..., part, :] + correction
        if part == 0:
            self._applied.append(np.clip(torque, -np.asarray(self._limit), self._limit))
        return torque

    def _teach(self, k, correction):
        if self._teacher == "feedback" and self._moving[k]:
            self._learner.correct(self._windows[..., k, :, :], correction)
        centre = len(self._read) - 1 - self._half
        if self._teacher == "torque" and centre >= self._half:
            if self._moving[centre * self._every]:
                window = np.stack(self._read[centre - self._half :], -1)
                self._learner.learn(window, self._applied[centre])


@dataclass(frozen=True)
class _Abreast:
    """Several controllers in one batch, each for so many rows of the first axis of runs."""

    controllers: Sequence[Controller]
    rows: Sequence[int]

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        return _AbreastLaw(self, reference, step)


class _AbreastLaw:
    def __init__(self, controller: _Abreast, reference: Trajectory, step: float):
        ends = np.cumsum(controller.rows)
        self._parts = [slice(end - n, end) for end, n in zip(ends, controller.rows)]
        self.laws = [
            as_controller(c).start(Trajectory(*(x[part] for x in reference)), step)
            for c, part in zip(controller.controllers, self._parts)
        ]

    def __call__(self, k, q, qd):
        parts = zip(self.laws, self._parts)
        return np.concatenate([law(k, q[part], qd[part]) for law, part in parts])
