"""What every rival learns from, what it must answer, and how it is tried.

A rival sees states, unless it sets ``kind = "windows"``; `Estimating` lets one of states see
windows. `Rival` checks what goes in and what comes out, and `trial` measures the rest.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ddlib._check import number, one_of, shaped
from ddlib.analysis import savitzky_golay
from ddlib.learning import cases
from ddlib.metrics import rmss
from ddlib.simulation import Recording
from ddlib.trajectories import OutsideFamilyWarning

INPUTS = ("windows", "states")
OUTSIDE_MARGIN = 0.1  # share of the training box's edge by which inputs leave it unwarned


class NotFitted(RuntimeError):
    """A rival was asked before it had learnt anything."""


@dataclass(frozen=True)
class Cases:
    """What a rival learns from, or is asked: windows or states, and torques.

    Windows of positions are of shape (cases, joint, width), rad, oldest sample first; states of
    shape (cases, joint, 3): position (rad), velocity (rad/s) and acceleration (rad/s^2).
    """

    x: np.ndarray
    torque: np.ndarray  # (cases, joint), N m, or whatever unit the drive has
    kind: str  # "windows" or "states"
    step: float  # sampling period of the windows, s

    def __post_init__(self):
        one_of("kind", self.kind, INPUTS)
        number("step", self.step, 0.0, open_low=True)
        x = shaped("x", self.x, "(cases, joint, rows)")
        if self.kind == "states" and x.shape[-1] != 3:
            raise ValueError(f"x must have shape (cases, joint, 3) for states, got {x.shape}")
        object.__setattr__(self, "x", x)
        object.__setattr__(self, "torque", shaped("torque", self.torque, f"({len(x)}, joint)"))

    def __len__(self):
        return len(self.x)

    def __getitem__(self, rows) -> Cases:
        """Some of the cases: a slice, a mask or an array of indices."""
        return Cases(self.x[rows], self.torque[rows], self.kind, self.step)

    @classmethod
    def windows(cls, recording: Recording, width: int) -> Cases:
        """All windows of `width` measured positions in the motions of a recording, runs joined."""
        return cls(*cases(recording, width), "windows", recording.step)

    @classmethod
    def states(cls, recording: Recording, states) -> Cases:
        """Exact states ``(..., samples, joint, 3)`` of a recording's motions, runs joined."""
        tau = recording.tau[..., recording.motion, :]
        states = shaped("states", states, (*tau.shape, 3))
        joints = tau.shape[-1]
        return cls(states.reshape(-1, joints, 3), tau.reshape(-1, joints), "states", recording.step)

    def estimated(self, degree: int = 3) -> Cases:
        """The states that a polynomial of this degree through each window gives at its centre."""
        if self.kind != "windows":
            raise ValueError(f"kind must be 'windows' to estimate states, got {self.kind!r}")
        filters = derivative_filters(self.x.shape[-1], self.step, degree)
        return Cases(self.x @ filters.T, self.torque, "states", self.step)


def derivative_filters(width: int, step: float, degree: int = 3) -> np.ndarray:
    """Filters of a window for position, velocity and acceleration at its centre, (3, width)."""
    return np.stack([savitzky_golay(width, k, step, degree) for k in range(3)])


class Rival(ABC):
    """Something that learns torques and predicts them.

    A subclass defines `_fit`, `_torque` and `count`. One whose answer makes no
    sense beyond its training inputs raises a ValueError in `_torque`; all others warn.
    """

    kind = "states"

    def fit(self, data: Cases) -> Rival:
        """Learn from cases, all at once; what was learnt before is forgotten."""
        if data.kind != self.kind:
            raise ValueError(f"data must be {self.kind} for {self!r}, got {data.kind}")
        self.step = data.step
        self._fit(data.x, data.torque)
        self._shape, self._joints = data.x.shape[1:], data.torque.shape[1]
        self._box = data.x.min(0), data.x.max(0)
        return self

    def torque(self, x) -> np.ndarray:
        """Predicted torque, shape (cases, joint), of inputs as in `Cases`.

        Where the rival has no answer it raises a ValueError; inputs that lie outside the box of the
        training inputs by more than `OUTSIDE_MARGIN` are answered with an `OutsideFamilyWarning`.
        """
        if not hasattr(self, "_shape"):
            raise NotFitted(f"{self!r} has learnt nothing: call fit first")
        joints, rows = self._shape
        x = shaped("x", x, f"(cases, {joints}, {rows})")
        outside = self.outside(x)
        predicted = self._torque(x)
        if outside.any():
            warnings.warn(
                f"{outside.sum()} of {len(x)} inputs lie outside what {self!r} was trained on",
                OutsideFamilyWarning,
                stacklevel=2,
            )
        return predicted

    def outside(self, x) -> np.ndarray:
        """Whether inputs ``(cases, joint, rows)`` leave the training box by `OUTSIDE_MARGIN`."""
        low, high = self._box
        slack = OUTSIDE_MARGIN * (high - low)
        return ((x < low - slack) | (x > high + slack)).any((-2, -1))

    def __repr__(self):
        return type(self).__name__

    @abstractmethod
    def _fit(self, x, torque) -> None:
        """Learn from ``(cases, joint, rows)`` and ``(cases, joint)``."""

    @abstractmethod
    def _torque(self, x) -> np.ndarray:
        """Predict ``(cases, joint)`` from ``(cases, joint, rows)``."""

    @abstractmethod
    def count(self) -> int:
        """Stored numbers: all that must be kept to predict."""


class Estimating(Rival):
    """A rival of states that sees windows: a polynomial in each window gives the states."""

    kind = "windows"

    def __init__(self, rival: Rival, degree: int = 3):
        self.rival, self.degree = rival, degree

    def _fit(self, x, torque):
        self.filters = derivative_filters(x.shape[-1], self.step, self.degree)
        self.rival.fit(Cases(x @ self.filters.T, torque, "states", self.step))

    def _torque(self, x):
        return self.rival._torque(x @ self.filters.T)

    def count(self):
        """Stored numbers: the rival's own and the three filters."""
        return self.rival.count() + self.filters.size


class _Trial(NamedTuple):
    """How a rival fared; errors are by set, pooled over joints, over the set's own deviation."""

    rmss: dict[str, float]
    count: int  # stored numbers


def trial(rival: Rival, training: Cases, tests: Mapping[str, Cases]) -> _Trial:
    """Train a rival and test it on named sets; a test beyond its training inputs is no warning."""
    rival.fit(training)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideFamilyWarning)
        errors = {name: float(rmss(rival.torque(c.x), c.torque)) for name, c in tests.items()}
    return _Trial(errors, rival.count())
