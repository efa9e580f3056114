"""Section 5.1 with motions in which position and acceleration differ: what becomes of filters?"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import (
    CLASSES,
    LAYERS,
    QUANTITIES,
    classify,
    filter_responses,
    gains,
    mean_gradient,
)
from ddlib.learning import TorqueModel, cases
from ddlib.setups import STATE_FEEDBACK, WINDOWS, errors, split, train_windows, true_states
from ddlib.simulation import LOG_STEP
from workshop.report import results
from workshop.report.code_hash import study
from workshop.report.two_harmonics import ORDER, record_two_harmonics

_NAME = "two harmonics"  # Name of the setup, under which its networks are kept

# Orders of the second sine and seeds of its amplitudes that are tried besides
_VARIED = ((ORDER, 1), (3, 0))


def _summary(model: TorqueModel, windows, states) -> dict:
    """Names of an ensemble's filters and what they follow, network by network.

    For each of `LAYERS` the shares of its filters by class and by the quantity that they follow
    best, and medians of the unique shares, ``(members, 3)``; then the whole networks' gains.
    """
    layers: dict = {}
    for layer, attribute in LAYERS.items():
        f = getattr(model.weights, attribute)
        names, follows = classify(f), filter_responses(f, windows, states)
        layers[layer] = {
            "classes": {name: (names == name).mean((1, 2)) for name in CLASSES},
            "follow": {q: (follows.strongest == k).mean((1, 2)) for k, q in enumerate(QUANTITIES)},
            "unique": np.median(follows.unique, (1, 2)),
        }
    return {**layers, "gains": gains(mean_gradient(model, windows), LOG_STEP)}


def _cell(order, seed, width, members):
    setup = replace(STATE_FEEDBACK, name=_NAME)
    recording = record_two_harmonics(setup, order, seed)
    model, history, _ = train_windows(setup, recording, width, members)
    training, _ = split(recording)
    windows, _ = cases(training, width)
    states = true_states(training, setup).reshape(-1, 2, 3)
    own, other = errors(model, recording), errors(model, setup.record())
    cell = {
        "training": own.training,
        "test": own.test,
        "one sine": {"runs 1 to 5": other.training, "trajectory 6": other.test},
        "best test": history.best_test,
        "derailed": history.derailed,
        "largest weight": model.weights.largest,
        **_summary(model, windows, states),
    }
    return cell, model


@study
def _harmonics(members=12, fewer=6) -> dict:
    """Networks of Table 4-1 trained on two harmonics; the networks go into ``.npz`` files.

    The arm, the controller, the noise, the five training runs and the test run, their extents
    and the training are those of Table 4-1. Other draws and another second harmonic are tried
    with `fewer` networks of window 21.
    """
    windows = {}
    for width in WINDOWS:
        windows[str(width)], model = _cell(ORDER, 0, width, members)
        model.save(results._networks_path(_NAME, width))
    varied = [
        {"order": order, "seed": seed, "width": 21, **_cell(order, seed, 21, fewer)[0]}
        for order, seed in _VARIED
    ]
    return {"members": members, "fewer": fewer, "windows": windows, "varied": varied}
