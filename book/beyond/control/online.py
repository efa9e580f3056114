"""The window network inside the controller: its weights change while the arm moves.

The controller runs every 2 ms, the network's samples are 10 ms apart. At each sample it learns
once, from measured windows and the torque applied there, or from desired windows and what the
feedback had to add; then it gives the torques of the next control periods. What it has learnt stays
in the learner after a run. Several runs may be simulated at once: leading axes of windows, torques
and weights count them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from beyond.control.windowed import reference_windows
from ddlib._check import integer, non_negative, number, one_of
from ddlib.control.controllers import ControlLaw, Controller, as_controller
from ddlib.trajectories import Trajectory

_TEACHERS = ("torque", "feedback", "nobody")  # see `OnlineFeedforward`
_MARGIN = 0.02  # of a wanted activity from 0 and 1, where the inverse of the sigmoid is infinite


def _sigmoid(x):
    return 0.5 * (1 + np.tanh(0.5 * x))


def _with_one(x):
    """Inputs with a last one that is always 1, whose weight is the bias."""
    return np.concatenate([x, np.ones((*x.shape[:-1], 1))], -1)


class _OnlineNetwork:
    """The window network in plain arrays that a learner replaces; leading axes are runs.

    A row of `hidden` has a hidden unit's weights of the window's values and its bias; a row of
    `output` has an output unit's weights of the hidden units, of the window's values, and its bias.
    """

    def __init__(self, model):
        weights = model.weights
        self.inputs, self.outputs = model.inputs, model.outputs
        self._low, self._gain = (x[:, None] for x in (self.inputs.low, self.inputs.gain))
        units = weights.hidden_bias.shape[-1]
        self.hidden = weights.rows[..., :units, :]
        self.output = np.concatenate([weights.output_weights, weights.rows[..., units:, :]], -1)

    def features(self, windows) -> tuple[np.ndarray, np.ndarray]:
        """What the hidden units and the output units see of windows, a row for each case.

        Windows are ``(..., cases, joint, width)``, rad.
        """
        x = self.inputs.target[0] + (windows - self._low) * self._gain
        seen = _with_one(x.reshape(*x.shape[:-2], -1))
        hidden = _sigmoid(seen @ np.swapaxes(self.hidden, -1, -2))
        direct = np.broadcast_to(seen, (*hidden.shape[:-1], seen.shape[-1]))  # the same in all runs
        return seen, np.concatenate([hidden, direct], -1)

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
        """Downhill directions of the hidden and output weights, by backpropagation.

        They are minus the gradient of half the squared error of scaled torques, a mean over cases.
        Give the wanted `torque`, or the `error`: by how much it exceeds the network's, both N m.
        """
        seen, features = self.features(windows)
        activity = self.activity(features)
        error = self.scaled(torque) - activity if error is None else error * self.outputs.gain
        output_delta = error * activity * (1 - activity)
        cases, units = output_delta.shape[-2], self.hidden.shape[-2]
        hidden = features[..., :units]
        hidden_delta = output_delta @ self.output[..., :units] * hidden * (1 - hidden)
        hidden_delta, output_delta = (
            np.swapaxes(hidden_delta, -1, -2),
            np.swapaxes(output_delta, -1, -2),
        )
        return hidden_delta @ seen / cases, output_delta @ features / cases


class OnlineDescent(_OnlineNetwork):
    """All weights learn by gradient descent, a step for each sample."""

    def __init__(
        self,
        model,  # what it begins with, a `TorqueModel`
        rate,  # of a step along `gradient`; one number, or one for each run
        momentum=0.0,  # share of the last step that is made again
        replay=0,  # earlier samples that are drawn and learnt again in each step of `learn`
        memory=3000,  # the youngest samples, so many, from which they are drawn
        seed=0,  # of the drawing, which is the same for all runs
    ):
        super().__init__(model)
        self.rate = non_negative("rate", np.asarray(rate, float))[..., None, None]
        self.momentum = number("momentum", momentum, 0.0, 0.999)
        self.replay, self.memory = integer("replay", replay, 0), integer("memory", memory, 1)
        self._rng, self._kept, self._steps = np.random.default_rng(seed), [], (0.0, 0.0)

    def learn(self, windows, torque) -> None:
        """A step from windows ``(..., joint, width)`` with torques (N m), and from kept samples."""
        cases = [(windows, torque)]
        if self.replay:
            drawn = self._rng.integers(0, len(self._kept), self.replay) if self._kept else ()
            cases += [self._kept[k] for k in drawn]
            self._kept = [*self._kept[1 - self.memory :], (windows, torque)]
        windows = np.stack([window for window, _ in cases], -3)
        self._step(self.gradient(windows, torque=np.stack([wanted for _, wanted in cases], -2)))

    def correct(self, windows, feedback) -> None:
        """Learn that the torque of windows was short by what the feedback added, N m."""
        self._step(self.gradient(windows[..., None, :, :], feedback[..., None, :]))

    def _step(self, gradients):
        """Move the hidden and output weights downhill, with momentum."""
        self._steps = tuple(
            self.momentum * last + self.rate * new for last, new in zip(self._steps, gradients)
        )
        self.hidden, self.output = self.hidden + self._steps[0], self.output + self._steps[1]


class LastLayer(_OnlineNetwork):
    """The output units' weights learn by recursive least squares; the hidden units stay.

    What a unit is to learn is the net input at which it would give the wanted torque: that depends
    linearly on its weights. ``recursion(weights)`` makes the estimate that begins with these
    weights: a `ddlib.identification.RecursiveLeastSquares`.
    """

    def __init__(self, model, recursion):
        super().__init__(model)
        self.estimate = recursion(self.output)

    def learn(self, windows, torque) -> None:
        """Learn that windows ``(..., joint, width)`` go with torques ``(..., 2)``, N m."""
        features = self.features(windows[..., None, :, :])[1][..., 0, :]
        wanted = np.clip(self.scaled(torque), _MARGIN, 1 - _MARGIN)
        self.estimate.update(features, np.log(wanted / (1 - wanted)))  # the sigmoid's inverse
        self.output = self.estimate.weights


class LinearFilter:
    """Torques (N m) as a linear function of scaled windows, by recursive least squares.

    `inputs` is the scaler of a network's windows; `weights`, a row for each joint, end with a bias.
    ``recursion(weights)`` is that of `LastLayer`.
    """

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
        """Learn that windows ``(..., joint, width)`` go with torques ``(..., 2)``, N m."""
        self.estimate.update(self._features(windows), torque)
        self.weights = self.estimate.weights


@dataclass(frozen=True)
class OnlineFeedforward:
    """A learner of windows as feedforward that goes on learning while it controls.

    The learner (`OnlineDescent`, `LastLayer`, `LinearFilter`) has ``torque(windows)``. What else it
    needs depends on the `teacher`, and takes one window for each run:

    - "torque": ``learn(windows, torque)``, of measured windows and the torque applied at their
      centres, half a window later
    - "feedback": ``correct(windows, feedback)``, of desired windows and the feedback's torque
    - "nobody": nothing; it does not learn

    It learns only from samples at which the reference moves. Before its first and after its last
    sample the reference is taken to rest.
    """

    learner: object
    feedback: Controller
    width: int = 21  # samples of a window, odd
    teacher: str = "torque"  # or "feedback" or "nobody"
    every: int = 5  # control periods from a window's sample to the next
    limit: Sequence[float] = (np.inf, np.inf)  # of the motors, N m: no more counts as applied

    def __post_init__(self):
        if integer("width", self.width, 3) % 2 == 0:
            raise ValueError(f"width must be odd, so that a window has a centre, got {self.width}")
        integer("every", self.every, 1)
        one_of("teacher", self.teacher, _TEACHERS)

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        return _Law(self, reference, as_controller(self.feedback).start(reference, step))


class _Law:
    """One run of `OnlineFeedforward`: torques of the learner and of the feedback."""

    def __init__(self, controller: OnlineFeedforward, reference: Trajectory, feedback):
        self._feedback, self._every, self._limit = feedback, controller.every, controller.limit
        self._teacher, learner = controller.teacher, controller.learner
        self._learner, half = learner, controller.width // 2
        moving = (reference.qd != 0) | (reference.qdd != 0)
        self._moving = moving.any(axis=(*range(moving.ndim - 2), -1))  # in any run, any joint
        self._half, self._read, self._applied = half, [], []  # angles and torques at each sample
        self._windows = reference_windows(reference.q, controller.width, self._every)
        if self._teacher == "nobody":
            self._ahead = learner.torque(self._windows)  # of the whole motion

    def __call__(self, k, q, qd):
        correction = self._feedback(k, q, qd)
        if self._teacher == "nobody":
            return self._ahead[..., k, :] + correction
        since_sample = k % self._every  # control periods
        if since_sample == 0:
            self._read.append(q)
            self._teach(k, correction)
            # Torques of the control periods until the next sample
            self._ahead = self._learner.torque(self._windows[..., k : k + self._every, :, :])
        torque = self._ahead[..., since_sample, :] + correction
        if since_sample == 0:
            self._applied.append(np.clip(torque, -np.asarray(self._limit), self._limit))
        return torque

    def _teach(self, k, correction):
        """Let the learner learn at control period k, a sample, what its teacher tells."""
        if self._teacher == "feedback" and self._moving[k]:
            self._learner.correct(self._windows[..., k, :, :], correction)
        centre = len(self._read) - 1 - self._half  # of the newest whole window, in samples
        if self._teacher == "torque" and centre >= self._half:
            if self._moving[centre * self._every]:
                window = np.stack(self._read[centre - self._half :], -1)
                self._learner.learn(window, self._applied[centre])


@dataclass(frozen=True)
class Abreast:
    """Several controllers in one simulation, each with runs of its own.

    The first axis of the runs is cut up in the controllers' order.
    """

    controllers: Sequence[Controller]
    rows: Sequence[int]  # of the first axis of runs, how many each controller has

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that asks each controller's law about its own rows, every `step` s."""
        return _AbreastLaw(self, reference, step)


class _AbreastLaw:
    """The laws of several controllers, each called with its rows of the state."""

    def __init__(self, controller: Abreast, reference: Trajectory, step: float):
        ends = np.cumsum(controller.rows)
        self._parts = [slice(end - n, end) for end, n in zip(ends, controller.rows)]
        self.laws = [
            as_controller(c).start(Trajectory(*(x[part] for x in reference)), step)
            for c, part in zip(controller.controllers, self._parts)
        ]

    def __call__(self, k, q, qd):
        parts = zip(self.laws, self._parts)
        return np.concatenate([law(k, q[part], qd[part]) for law, part in parts])
