"""The experiment of section 4, as this book repeats it: one place for every choice made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib import paper
from ddlib._check import finite_array, integer
from ddlib.control import Controller, pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II, Arm
from ddlib.effects import CMU_DD_ARM_II_EFFECTS, Effects
from ddlib.learning import (
    History,
    TorqueModel,
    TrainingSet,
    Weights,
    cases,
    sliding_windows,
    train_ensemble,
)
from ddlib.metrics import rmss
from ddlib.simulation import Recording, record
from ddlib.trajectories import APPENDIX_I

KP = (300.0, 90.0)
"""Gains on the position error of shoulder and elbow, N m/rad. Assumed: stiff enough to follow
the family within a few degrees. Softer and stiffer ones are compared in the book."""

KD = (35.0, 10.0)
"""Gains on the velocity error, N m s/rad. Assumed: damping ratios of about 0.4 and 0.6."""

WINDOWS = tuple(paper.TABLE_4_1)
"""Window sizes of Table 4-1."""

MOMENTUM = 0.98
"""Acceleration factor. Assumed; Lang (1988) used 0.95, which leaves the training error far
from its asymptote after the paper's 20,000 epochs."""

WARM_UP = 1000
"""Epochs at the start with a momentum of 0.5. Assumed; Lang (1988) raised it from .5 to .95.
Without them a few networks in a hundred saturate early and never recover."""

COURSE = (*sorted({0, *(round(10 ** (k / 14)) for k in range(61))}), paper.EPOCHS)
"""Epochs after which the weights of the first networks are kept: 14 in each decade."""

INITIAL = 0.3
"""Initial weights are uniform in plus or minus this (Rumelhart, Hinton & Williams 1986)."""


@dataclass(frozen=True)
class Setup:
    """Arm, effects, controller and training: everything that decides Table 4-1.

    Parameters
    ----------
    name : str
        What tables call it.
    controller : Controller
    arm : Arm
    effects : Effects
    epochs, warm_up : int
    momentum, initial : float
    rate : float
        Step size per case times the width of the window (`ddlib.learning.training.default_rate`).
    scaling : tuple of float
        Range that the network's inputs are scaled to.
    hidden : int
        Number of hidden units.
    seed : int
        Seed of the sensor noise of the recording.
    """

    name: str
    controller: Controller
    arm: Arm = CMU_DD_ARM_II
    effects: Effects = CMU_DD_ARM_II_EFFECTS
    epochs: int = paper.EPOCHS
    momentum: float = MOMENTUM
    warm_up: int = WARM_UP
    initial: float = INITIAL
    rate: float = 33.0
    scaling: tuple[float, float] = (0.0, 1.0)
    hidden: int = paper.HIDDEN_UNITS
    seed: int = 0

    def record(self, extents_deg=APPENDIX_I, **options) -> Recording:
        """The recording of all runs, noise included; default: the six of Appendix I.

        Parameters
        ----------
        extents_deg : array_like, shape (2,) or (runs, 2)
            Extents in degrees.
        **options
            Duration, rests and periods, as in `ddlib.simulation.simulate.record`.
        """
        options = {"effects": self.effects, "seed": self.seed, **options}
        return record(self.arm, self.controller, extents_deg, **options)


POSITION_FEEDBACK = Setup("position feedback", proportional(KP))
"""First reading of "a proportional controller": torque proportional to the position error."""

STATE_FEEDBACK = Setup("state feedback", pd(KP, KD))
"""Second reading: the reference is "position and velocity" (section 2), so the torque is
proportional to the errors in both. The arm follows without ringing."""

SETUPS = {setup.name: setup for setup in (POSITION_FEEDBACK, STATE_FEEDBACK)}
"""The two readings by name."""


def split(recording: Recording) -> tuple[Recording, Recording]:
    """Training runs 1 to 5 and test run 6 of an Appendix I recording: split by trajectory."""
    if recording.q.ndim != 3 or len(recording.q) != len(APPENDIX_I):
        raise ValueError(
            f"recording must hold the six runs of Appendix I, got shape {recording.q.shape}"
        )
    return recording[:5], recording[5]


def train_windows(
    setup: Setup,
    recording: Recording,
    width: int,
    members: int,
    *,
    seed=0,
    snapshots=(),
    progress=True,
) -> tuple[TorqueModel, History, dict[int, Weights]]:
    """Train `members` networks of one window size on runs 1 to 5, following run 6.

    Parameters
    ----------
    setup : Setup
    recording : Recording
        The six runs of Appendix I.
    width, members, seed : int
        Window size, number of networks, seed of the first one's weights.
    snapshots, progress
        As in `ddlib.learning.training.train_ensemble`.

    Returns
    -------
    model, history, snapshots
        As from `ddlib.learning.training.train_ensemble`.
    """
    integer("members", members, 1)
    training, test = split(recording)
    data = TrainingSet.from_recording(training, width, scaling=setup.scaling)
    weights = Weights.random(members, width, setup.hidden, initial=setup.initial, seed=seed)
    return train_ensemble(
        weights,
        data,
        test=data.transform(*cases(test, width)),
        rate=setup.rate / width,
        momentum=setup.momentum,
        epochs=setup.epochs,
        warm_up=setup.warm_up,
        snapshots=snapshots,
        progress=progress,
        label=f"{setup.name}, window {width}",
    )


def errors(model: TorqueModel, recording: Recording) -> dict[str, np.ndarray]:
    """RMSS of a model on an Appendix I recording, in each way the paper may have meant.

    Returns
    -------
    dict
        ``training`` and ``test`` (pooled, own standard deviation), ``test by training
        deviation``, ``test shoulder``, ``test elbow`` and ``test, desired positions`` (the
        network sees the reference in place of the measured positions); one value per
        member each.
    """
    width = model.weights.width
    training, test = split(recording)
    (x, y), (x6, y6) = cases(training, width), cases(test, width)
    desired = sliding_windows(test.reference.q, width, test.motion)
    predicted = model.torque(x6)
    by_joint = rmss(predicted, y6, pooled=False)
    return {
        "training": rmss(model.torque(x), y),
        "test": rmss(predicted, y6),
        "test by training deviation": rmss(predicted, y6, scale=y.std(0)),
        "test shoulder": by_joint[..., 0],
        "test elbow": by_joint[..., 1],
        "test, desired positions": rmss(model.torque(desired), y6),
    }


def predict(model: TorqueModel, recording: Recording) -> np.ndarray:
    """Torque that a model gives along the motion of a recording, ``(..., time, joint)``, N m.

    A model that knows its sampling period refuses a recording with another one.
    """
    finite_array("recording.q", recording.q, 2)
    if model.step is not None and abs(recording.step / model.step - 1) > 1e-6:
        raise ValueError(
            f"recording must have the model's sampling period of {model.step:g} s, "
            f"got {recording.step:g} s"
        )
    return model.torque(sliding_windows(recording.q, model.weights.width, recording.motion))
