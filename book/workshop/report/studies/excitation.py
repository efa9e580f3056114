"""How strongly a recording swings, and how much regularisation the arm's mass survives in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ddlib import learning
from ddlib.analysis import gains, half_penalty, mean_gradient, ridge_filters
from ddlib.control import pd
from ddlib.learning import TorqueModel, TrainingSet, Weights, cases, effective_steps
from ddlib.metrics import rmss
from ddlib.setups import (
    JOINT_DAMPING,
    JOINT_DAMPING_KP,
    KD,
    STATE_FEEDBACK,
    Setup,
    split,
    true_states,
)
from ddlib.simulation import LOG_STEP, Recording
from workshop.report.code_hash import study
from workshop.report.studies.nulls import TRIAL
from workshop.report.two_harmonics import record_two_harmonics

_WIDTH = 21
_EPOCHS = (100, 300, 1000, 3000, 10_000, 20_000)  # after which networks are read
_PENALTIES = np.geomspace(1e-9, 1.0, 37)


def _stiffer(times: float) -> Setup:
    damping = tuple(times * k for k in KD)
    return replace(STATE_FEEDBACK, controller=pd(JOINT_DAMPING_KP, damping))


# Name of a drive: its set-up, and how it records the six runs
DRIVES: dict[str, tuple[Setup, Callable[[Setup], Recording]]] = {
    "damped joints": (TRIAL, Setup.record),
    "state feedback": (STATE_FEEDBACK, Setup.record),
    "stiffer": (_stiffer(1), Setup.record),
    "stiffer, well damped": (_stiffer(2), Setup.record),
    "state feedback, two sines": (STATE_FEEDBACK, record_two_harmonics),
    "stiffer, well damped, two sines": (_stiffer(2), record_two_harmonics),
}


def later(recording: Recording, seconds: float) -> Recording:
    """The recording with a motion that begins later: its first seconds are left out."""
    return replace(recording, t=recording.t - seconds, duration=recording.span[1] - seconds)


def training_set(recording: Recording) -> TrainingSet:
    """Windows of runs 1 to 5 of a recording, inputs centred."""
    return TrainingSet.from_recording(split(recording)[0], _WIDTH, scaling=TRIAL.scaling)


def _inertia(model: TorqueModel, windows) -> np.ndarray:
    return gains(mean_gradient(model, windows), LOG_STEP)[..., 0, 0, 2]


def _read(weights: Weights, data: TrainingSet, training: Recording) -> dict:
    windows, torque = cases(training, _WIDTH)
    model = TorqueModel(weights, data.inputs, data.outputs, data.step)
    return {"M11": _inertia(model, windows), "error": rmss(model.torque(windows), torque)}


def _networks(recording: Recording, members: int, label: str) -> dict:
    """Networks by descent, after some epochs, and by the solver of the third set-up."""
    training, data = split(recording)[0], training_set(recording)
    start = Weights.random(members, _WIDTH, initial=TRIAL.initial)
    shared = {"momentum": TRIAL.momentum, "warm_up": TRIAL.warm_up}
    *_, weights = learning.train_ensemble(
        start, data, rate=TRIAL.rate / _WIDTH, epochs=_EPOCHS[-1], snapshots=_EPOCHS,
        label=label, **shared,
    )  # fmt: skip
    by_epoch = [_read(weights[epoch], data, training) for epoch in _EPOCHS]
    solved = learning.solve(
        start, data, steps=JOINT_DAMPING.steps, decay=JOINT_DAMPING.decay, label=label
    )
    # a direct weight sees the squared slope of the output's sigmoid
    rate = TRIAL.rate / _WIDTH * ((data.y * (1 - data.y)) ** 2).mean()
    steps = effective_steps([0.0], _EPOCHS, **shared)[:, 0]
    return {
        "penalty of the epochs": 1 / (rate * steps),
        "descent": {key: np.array([row[key] for row in by_epoch]) for key in by_epoch[0]},
        "solver": _read(solved.model.weights, data, training),
    }


def _linear(recording: Recording, setup: Setup) -> dict:
    data = training_set(recording)
    states = true_states(split(recording)[0], setup)
    inertia = setup.arm.mass_matrix(states[..., 0])[..., 0, 0].mean()
    return {
        "M11": gains(ridge_filters(data, _PENALTIES), LOG_STEP)[:, 0, 0, 2],
        "half": half_penalty(data, states.reshape(-1, 2, 3)),
        "arm": inertia,
    }


@study
def _excitation(members: int = 8, days: int = 8, skipped=(0.0, 1.0)) -> dict:
    """Inertia of the shoulder in linear filters and networks, by drive and seconds left out.

    Linear filters by ridge regression on several days, with what the theory of `half_penalty`
    says; networks of window 21 on the set-up's own recording.
    """
    cells = []
    for name, (setup, record) in DRIVES.items():
        whole = record(setup)
        repeats = [setup.repeated(day) for day in range(1, days + 1)]
        recordings = [record(repeat) for repeat in repeats]
        for seconds in skipped:
            linear = [_linear(later(r, seconds), s) for r, s in zip(recordings, repeats)]
            label = f"{name}, {seconds:g} s left out"
            cells.append({
                "drive": name, "left out": seconds, "arm": np.mean([row["arm"] for row in linear]),
                "ridge": [row["M11"] for row in linear], "half": [row["half"] for row in linear],
                **_networks(later(whole, seconds), members, label),
            })  # fmt: skip
    return {
        "members": members, "days": days, "width": _WIDTH, "epochs": _EPOCHS,
        "penalties": _PENALTIES, "cells": cells,
    }  # fmt: skip
