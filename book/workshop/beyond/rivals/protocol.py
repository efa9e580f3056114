"""What every rival learns from, what it must answer, and how it is tried.

A new rival is a class with four short methods::

    class Mean(Rival):
        def _fit(self, x, torque):
            self.mean = torque.mean(0)

        def _torque(self, x):
            return np.tile(self.mean, (len(x), 1))

        def count(self):
            return self.mean.size

        def operations(self):
            return Operations(0, 0)

It sees states, unless it sets ``kind = "windows"``; `Estimating` lets a rival of states see
windows. `Rival` checks what goes in and what comes out, and `trial` measures the rest.
"""

from __future__ import annotations

import time
import warnings
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ddlib._check import number, one_of, shaped
from ddlib.analysis import savitzky_golay
from ddlib.dynamics import Operations
from ddlib.learning import cases
from ddlib.metrics import rmss
from ddlib.simulation import Recording
from ddlib.trajectories import OutsideFamilyWarning

KINDS = ("windows", "states")
"""What a rival may see: windows of positions, or positions, velocities and accelerations."""

MARGIN = 0.1
"""How far inputs may lie outside the box of the training inputs before a rival warns, as a share of
the box's edge."""


class NotFitted(RuntimeError):
    """A rival was asked before it had learnt anything."""


@dataclass(frozen=True)
class Cases:
    """What a rival learns from, or is asked.

    Attributes
    ----------
    x : ndarray, shape (cases, joint, rows)
        Windows of positions, oldest sample first (rad); or states: position (rad), velocity
        (rad/s) and acceleration (rad/s^2).
    torque : ndarray, shape (cases, joint)
        N m, or whatever unit the drive has.
    kind : {"windows", "states"}
        Which of the two `x` is.
    step : float
        Sampling period of the windows, s.

    Raises
    ------
    TypeError, ValueError
        If an array has another shape or is not finite, or another argument is out of range.
    """

    x: np.ndarray
    torque: np.ndarray
    kind: str
    step: float

    def __post_init__(self):
        one_of("kind", self.kind, KINDS)
        number("step", self.step, 0.0, open_low=True)
        x = shaped("x", self.x, "(cases, joint, rows)")
        if self.kind == "states" and x.shape[-1] != 3:
            raise ValueError(f"x must have shape (cases, joint, 3) for states, got {x.shape}")
        object.__setattr__(self, "x", x)
        object.__setattr__(self, "torque", shaped("torque", self.torque, f"({len(x)}, joint)"))

    def __len__(self):
        return len(self.x)

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
        """The states that a polynomial through each window gives at its centre.

        Parameters
        ----------
        degree : int
            Of the polynomial, fitted by least squares: 2 or more, less than the width.
        """
        if self.kind != "windows":
            raise ValueError(f"kind must be 'windows' to estimate states, got {self.kind!r}")
        filters = derivative_filters(self.x.shape[-1], self.step, degree)
        return Cases(self.x @ filters.T, self.torque, "states", self.step)


def derivative_filters(width: int, step: float, degree: int = 3) -> np.ndarray:
    """Filters that estimate position, velocity and acceleration, shape (3, width).

    Parameters
    ----------
    width : int
        Samples of a window, odd.
    step : float
        Sampling period, s.
    degree : int
        Of the polynomial that is fitted to a window.
    """
    return np.stack([savitzky_golay(width, k, step, degree) for k in range(3)])


class Rival(ABC):
    """Something that learns torques and predicts them.

    A subclass defines `_fit`, `_torque`, `count` and `operations`. One whose answer makes no
    sense beyond its training inputs raises a ValueError in `_torque`; all others warn.
    """

    kind = "states"
    """What it wants to see, of `KINDS`."""

    def fit(self, data: Cases) -> Rival:
        """Learn from cases, all at once; what was learnt before is forgotten.

        Parameters
        ----------
        data : Cases
            Of the rival's kind.

        Returns
        -------
        Rival
            Itself.

        Raises
        ------
        ValueError
            If there are no cases or they are of another kind.
        """
        if data.kind != self.kind:
            raise ValueError(f"data must be {self.kind} for {self!r}, got {data.kind}")
        if not len(data):
            raise ValueError("data must hold at least one case, got none")
        self.step = data.step
        self._fit(data.x, data.torque)
        self._shape, self._joints = data.x.shape[1:], data.torque.shape[1]
        self._box = data.x.min(0), data.x.max(0)
        return self

    def torque(self, x) -> np.ndarray:
        """Predicted torque.

        Parameters
        ----------
        x : array_like, shape (cases, joint, rows)
            As in `Cases`.

        Returns
        -------
        ndarray, shape (cases, joint)

        Raises
        ------
        NotFitted
            Before `fit`.
        ValueError
            If `x` has another number of joints or rows than the training cases, is not finite,
            or lies where the rival has no answer.

        Warns
        -----
        OutsideFamilyWarning
            If a value lies outside the box of the training inputs by more than `MARGIN`.
        """
        if not hasattr(self, "_shape"):
            raise NotFitted(f"{self!r} has learnt nothing: call fit first")
        joints, rows = self._shape
        x = shaped("x", x, f"(cases, {joints}, {rows})")
        outside = self.outside(x)
        found = self._torque(x)
        if outside.any():
            warnings.warn(
                f"{outside.sum()} of {len(x)} inputs lie outside what {self!r} was trained on",
                OutsideFamilyWarning,
                stacklevel=2,
            )
        return found

    def outside(self, x) -> np.ndarray:
        """Whether inputs ``(cases, joint, rows)`` lie outside the training box by `MARGIN`."""
        low, high = self._box
        slack = MARGIN * (high - low)
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

    @abstractmethod
    def operations(self) -> Operations:
        """Arithmetic of one prediction, all joints; comparisons and look-ups are free."""


class Estimating(Rival):
    """A rival of states that sees windows: a polynomial in each window gives the states.

    Parameters
    ----------
    rival : Rival
        Of kind "states".
    degree : int
        Of the polynomial (`Cases.estimated`).
    """

    kind = "windows"

    def __init__(self, rival: Rival, degree: int = 3):
        if rival.kind != "states":
            raise ValueError(f"rival must be one of states, got {rival!r}, one of {rival.kind}")
        self.rival, self.degree = rival, degree

    def __repr__(self):
        return f"{self.rival!r} on estimated states"

    def _fit(self, x, torque):
        self.filters = derivative_filters(x.shape[-1], self.step, self.degree)
        self.rival.fit(Cases(x @ self.filters.T, torque, "states", self.step))

    def _torque(self, x):
        return self.rival._torque(x @ self.filters.T)

    def count(self):
        """Stored numbers: the rival's own and the three filters."""
        return self.rival.count() + self.filters.size

    def operations(self):
        """Arithmetic: the rival's own and the three filters of each joint."""
        joints, (rows, width) = self._shape[0], self.filters.shape
        own, each = self.rival.operations(), joints * rows
        return own._replace(
            multiplications=own.multiplications + each * width,
            additions=own.additions + each * (width - 1),
        )


class Trial(NamedTuple):
    """How a rival fared.

    Attributes
    ----------
    rmss : dict of float
        Error on each set of cases, by name: pooled over the joints, divided by the set's own
        standard deviation, as in Table 4-1.
    count : int
        Stored numbers.
    operations : Operations
        Of one prediction.
    seconds : float
        Processor time of training, s.
    """

    rmss: dict[str, float]
    count: int
    operations: Operations
    seconds: float


def trial(rival: Rival, training: Cases, tests: Mapping[str, Cases]) -> Trial:
    """Train a rival and test it; a test beyond its training inputs is meant, and no warning.

    Parameters
    ----------
    rival : Rival
        It is trained here.
    training : Cases
    tests : mapping of str to Cases
        Sets to predict, the training set too if it is wanted.
    """
    began = time.process_time()
    rival.fit(training)
    seconds = time.process_time() - began
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutsideFamilyWarning)
        errors = {name: float(rmss(rival.torque(c.x), c.torque)) for name, c in tests.items()}
    return Trial(errors, rival.count(), rival.operations(), seconds)
