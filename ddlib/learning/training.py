"""What networks are trained on, and what a training run says of itself. PyTorch is not needed."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np

from ddlib._check import along, filled, instance, integer, number, pair, shaped, varies
from ddlib.learning.windows import Scaler, sliding_windows
from ddlib.simulation import Recording

# The page Provenance shows constants with the notes below them.
TARGET_RANGE = (0.2, 0.8)
"""Range of the output units that the torques are scaled to (Lang 1988)."""

WARM_UP_MOMENTUM = 0.5
"""Momentum of the first epochs; Lang (1988) began with it."""

_MAX_RATE = 1e38  # step size that single precision can hold


@dataclass(frozen=True)
class TrainingSet:
    """Scaled windows and torques, with the scaling that made them."""

    x: np.ndarray  #: (cases, joint, width): scaled, by default to 0..1 over the cases.
    y: np.ndarray  #: (cases, joint): torques scaled to the output units' range.
    inputs: Scaler  #: Radians to `x`.
    outputs: Scaler  #: N m to `y`.
    step: float | None = None  #: Sampling period of the windows, s, if known.

    def __repr__(self) -> str:
        cases, joints, width = self.x.shape
        period = "" if self.step is None else f", {self.step:g} s apart"
        return f"TrainingSet({cases} cases, {joints} joints, window of {width} samples{period})"

    @classmethod
    def from_arrays(
        cls, windows, torque, target=TARGET_RANGE, scaling=(0.0, 1.0), *, step=None
    ) -> TrainingSet:
        """Scale windows ``(cases, joint, width)``, rad, to `scaling`, torques, N m, to `target`.

        `step` is the windows' sampling period, s: networks trained on the set keep it, and what
        reads masses from weights or draws them over time asks for it.
        """
        pair("target", target, 0.0, 1.0)
        pair("scaling", scaling)
        windows = shaped("windows", windows, "(cases, joint, width)")
        torque = shaped("torque", torque, f"({len(windows)}, joint)")
        filled("windows", windows)
        varies(
            "windows",
            windows.swapaxes(-1, -2).reshape(-1, windows.shape[1]),
            "a joint that stands still shows nothing of its dynamics",
        )
        varies("torque", torque, "identify without a network, or take runs with that torque")
        if step is not None:
            number("step", step, 0.0, open_low=True)
        inputs, outputs = Scaler.fit(windows, scaling, -2), Scaler.fit(torque, target)
        return cls(inputs.scale(windows, -2), outputs.scale(torque), inputs, outputs, step)

    @classmethod
    def from_recording(cls, recording: Recording, width: int, *options, **named) -> TrainingSet:
        """All windows of the motions of a recording, runs joined; options of `from_arrays`."""
        return cls.from_arrays(*cases(recording, width), *options, **named, step=recording.step)

    def transform(self, windows, torque) -> tuple[np.ndarray, np.ndarray]:
        """Other windows (rad) and torques (N m) with this set's scaling."""
        along("windows", windows, -2, self.inputs.low.size)
        along("torque", torque, -1, self.outputs.low.size)
        return self.inputs.scale(windows, -2), self.outputs.scale(torque)


def cases(recording: Recording, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Windows, rad, and torques, N m, of a recording's motions, ``cases`` being the first axis."""
    instance("recording", recording, Recording)
    recording = recording.for_windows(width)
    windows = sliding_windows(recording.q, width, recording.motion)
    torque = recording.tau[..., recording.motion, :]
    return windows.reshape(-1, *windows.shape[-2:]), torque.reshape(-1, torque.shape[-1])


@dataclass
class History:
    """Errors along a training run: pooled RMSS, ``(points, members)``, at its `epochs`.

    `test` is by the test set's own standard deviation, and empty if there is no test set.
    """

    epochs: np.ndarray = field(default_factory=lambda: np.zeros(0, int))
    training: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    test: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))

    def __repr__(self) -> str:
        if not len(self.epochs):
            return "History: empty"
        last = {name: getattr(self, name)[-1:] for name in ("training", "test")}
        errors = (f"{name} RMSS {np.median(x):.2f}" for name, x in last.items() if x.size)
        median = ", median of networks" if np.size(last["training"]) > 1 else ""
        return f"History: {self.epochs[-1]} epochs, {', '.join(errors)}{median}"

    def append(self, epoch: int, training, test=None) -> None:
        """Add one point."""
        self.epochs = np.append(self.epochs, epoch)
        for name, errors in (("training", training), ("test", test)):
            if errors is not None:
                before = getattr(self, name).reshape(-1, np.size(errors))
                setattr(self, name, np.vstack([before, np.atleast_1d(errors)]))

    @property
    def best_test(self) -> np.ndarray:
        """Smallest test error on the way, per member; NaN if none is finite."""
        if not self.test.size:
            raise ValueError("history has no test errors: give `test` to train_ensemble")
        return np.fmin.reduce(self.test, axis=0)

    @property
    def derailed(self) -> np.ndarray:
        """Members that end worse than a constant guess (RMSS over 1) or not finite."""
        return ~(self.training[-1] < 1.0)

    def slope(self) -> np.ndarray:
        """``d ln(error) / d ln(epoch)`` from half the epochs to the end, per member.

        The paper trains "to the point where the derivative of the error was nearly zero".
        """
        if len(self.epochs) < 2:
            raise ValueError(f"history must hold two points or more, got {len(self.epochs)}")
        half = int(np.argmin(np.abs(self.epochs - self.epochs[-1] / 2)))
        ratio = np.log(self.training[-1] / self.training[half])
        return ratio / np.log(self.epochs[-1] / self.epochs[half])

    def settled(self, steepest: float = 0.1) -> np.ndarray:
        """Members whose error over epochs is no steeper than `steepest`, on a log-log scale.

        With 0.1, twice the epochs would lower it by less than 7 %. A derailed member may rest, too.
        """
        number("steepest", steepest, 0.0)
        return np.abs(self.slope()) <= steepest


class TrainingDiverged(RuntimeError):
    """Descent blew up; `history` keeps what was recorded until then."""

    def __init__(self, message: str, history: History):
        super().__init__(message)
        self.history = history


class TrainingInterrupted(KeyboardInterrupt):
    """Ctrl-C, or the kernel's stop, cut a training short; what was reached is kept.

    Attributes
    ----------
    model : TorqueModel
        The networks as they were; those that had not begun have their initial weights.
    history : History
        Errors until then. The last ones are those of `model`; NaN if they were not computed.
    epochs : ndarray, shape (members,)
        Epochs of descent, or steps of `solve`, that each network had taken.
    snapshots : dict
        Weights by epoch, of those epochs that all networks had reached.
    """

    def __init__(self, model, history: History, epochs: np.ndarray, wanted: int, snapshots=None):
        least, most = int(np.min(epochs)), int(np.max(epochs))
        reached = f"{most:,}" if least == most else f"{least:,} to {most:,}"
        super().__init__(
            f"interrupted after {reached} of {wanted:,} steps; the networks so far are this "
            "error's `model` (in a notebook: import sys; model = sys.last_value.model)"
        )
        self.model, self.history, self.epochs = model, history, epochs
        self.snapshots = snapshots or {}


class WorseThanMean(UserWarning):
    """All networks of a run ended worse than a guess of the mean, which has an RMSS of 1."""


def _warn_if_worse_than_mean(history: History, rate: float) -> None:
    """Name rate and error where every network ended with a training RMSS above 1."""
    least = np.nanmin(history.training[-1])
    if least > 1:
        warnings.warn(
            f"training ended with an RMSS of {least:.2g}, worse than a guess of the mean (1): "
            f"the rate ({rate:g}) is too large, or {history.epochs[-1]} epochs are too few",
            WorseThanMean,
            stacklevel=3,
        )


def default_rate(width: int) -> float:
    """Step size per case for a window of `width` samples: 33 / width (the paper prints no rates).

    More inputs that rise and fall together mean a steeper error surface.
    """
    return 33.0 / integer("width", width, 1)


def recorded_epochs(epochs: int, points: int = 60) -> np.ndarray:
    """Epochs at which errors are recorded: about `points`, equally spaced on a log scale."""
    return np.unique(np.round(np.geomspace(1, epochs, points)).astype(int))


def check_descent(rate: float, momentum: float, epochs: int) -> None:
    """Refuse options of descent that are out of range."""
    number("rate", rate, 0.0, _MAX_RATE, open_low=True)
    number("momentum", momentum, 0.0, 0.999)
    integer("epochs", epochs, 1)
