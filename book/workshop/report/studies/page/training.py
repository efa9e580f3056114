"""What a reader sees who trains a network in the page: when the error goes, and the shapes come."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib import learning
from ddlib.analysis import classify, gains, mean_gradient
from ddlib.learning import TorqueModel, TrainingSet, Weights, cases, default_rate, surrogate
from ddlib.setups import INITIAL, JOINT_DAMPING, split
from ddlib.widgets.engine.trainer import CHECK, EPOCHS, EVERY, LEVEL, MOMENTUM, SHIFTS, WIDTH
from workshop.report.code_hash import study

# What is waited for: the error below `LEVEL`, the first direct filter called "acceleration", and
# the first hidden filter with any name
_EVENTS = ("error", "direct", "hidden")


def _page_set(
    scaling=(-1.0, 1.0), shifted: int | None = None
) -> tuple[TrainingSet, np.ndarray, tuple]:
    """Training set of the page, its windows (rad), and scaled ones and torques of trajectory 6."""
    training, test = split(JOINT_DAMPING.record())
    torque = training.tau[:, training.motion]
    if shifted is not None:
        torque = surrogate("shifted", torque, shifted)
    windows, _ = cases(training, WIDTH)
    whole = TrainingSet.from_arrays(windows, torque.reshape(-1, 2), scaling=scaling)
    samples = torque.shape[1]
    places = np.arange(len(windows)).reshape(-1, samples)[:, ::EVERY].ravel()
    data = replace(whole, x=whole.x[places], y=whole.y[places], step=training.step)
    return data, windows[places], data.transform(*cases(test, WIDTH))


def _events(weights: Weights, training: np.ndarray) -> np.ndarray:
    """Which of `_EVENTS` hold for each network, shape (members, 3)."""
    direct = classify(weights.direct_weights) == "acceleration"
    hidden = classify(weights.hidden_weights) != "not analysable"
    shapes = [x.reshape(len(weights), -1).any(-1) for x in (direct, hidden)]
    return np.stack([training < LEVEL, *shapes], -1)


def _watched(weights: Weights, data: TrainingSet, windows, test: tuple) -> dict:
    """Train, looking every `CHECK` epochs; what was seen of each network."""
    rate = default_rate(WIDTH) / len(data.x)
    descent = learning.Descent(weights, data.x, data.y, rate, MOMENTUM)
    spreads = data.y.std(0), test[1].std(0)
    sets = (descent.inputs, descent.targets), learning.prepare(*test)
    first = np.full((len(weights), len(_EVENTS)), np.nan)
    for epoch in range(0, EPOCHS + 1, CHECK):
        errors = [
            np.sqrt((descent.mean_square(*s) / spread**2).mean(-1))
            for s, spread in zip(sets, spreads)
        ]
        now = descent.weights()
        first[_events(now, errors[0]) & np.isnan(first)] = epoch
        for _ in range(CHECK if epoch < EPOCHS else 0):
            descent.epoch()
    gradient = mean_gradient(TorqueModel(now, data.inputs, data.outputs), windows)
    named = classify(now.hidden_weights) != "not analysable"
    return {
        **dict(zip(_EVENTS, first.T)),
        "training": errors[0],
        "test": errors[1],
        "named": named.reshape(len(weights), -1).mean(-1),
        "inertia": gains(gradient, data.step)[:, 0, 0, 2],
    }


@study
def _page_training(members: int = 25) -> dict:
    """Networks of window 21 trained as the page trains them, on torques real and shifted."""
    rows = {}
    for name, scaling in (("centred", (-1.0, 1.0)), ("as printed", (0.0, 1.0))):
        start = Weights.random(members, WIDTH, initial=INITIAL)
        rows[f"{name}, real"] = _watched(start, *_page_set(scaling))
        shares = np.array_split(np.arange(members), SHIFTS)
        runs = [
            _watched(start[share], *_page_set(scaling, shifted=k)) for k, share in enumerate(shares)
        ]
        rows[f"{name}, shifted"] = {
            key: np.concatenate([run[key] for run in runs]) for key in runs[0]
        }
    return {"members": members, "epochs": EPOCHS, "every": EVERY, "level": LEVEL, "rows": rows}
