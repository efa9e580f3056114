"""Where the smooth filters come from: other ends and other starts for the same networks."""

from __future__ import annotations

import warnings

import numpy as np

from ddlib.analysis import CLASSES, classify, roughness
from ddlib.experiments.setups import STATE_FEEDBACK, split
from ddlib.learning import NotConverged, TrainingSet, Weights, cases, solve, train_ensemble

WIDTH = 21


def _described(weights: Weights, history) -> dict:
    """Errors, size and shape of the weights of an ensemble, one value for each member."""
    f = weights.hidden_weights
    names = classify(f)
    return {
        "training": history.training[-1],
        "test": history.test[-1],
        "largest weight": weights.largest,
        "roughness, hidden": np.median(roughness(f), (-2, -1)),
        "classes": {name: (names == name).mean((-2, -1)) for name in CLASSES},
    }


def _data():
    training, test = split(STATE_FEEDBACK.record())
    data = TrainingSet.from_recording(training, WIDTH)
    return data, data.transform(*cases(test, WIDTH))


def null_controls(members=4, steps=120) -> dict:
    """Networks of window 21 that descended from other initial weights, or reached an optimum.

    The optima are those of the error alone, of the error with a penalty on the squared weights
    ("weight decay"), and of the error with one on the second differences along the window.
    """
    data, test = _data()
    rows = []
    for initial in (0.03, 1.0):
        weights = Weights.random(members, WIDTH, initial=initial)
        _, history, kept = train_ensemble(
            weights,
            data,
            test=test,
            momentum=STATE_FEEDBACK.momentum,
            warm_up=STATE_FEEDBACK.warm_up,
            epochs=STATE_FEEDBACK.epochs,
            snapshots=(STATE_FEEDBACK.epochs,),
            label=f"initial weights up to {initial:g}",
        )
        (trained,) = kept.values()
        rows.append({"kind": "descent", "initial": initial, **_described(trained, history)})
    for penalty in ({}, {"decay": 1e-5}, {"decay": 1e-3}, {"smoothness": 1e-4}):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotConverged)  # without a penalty there is no end
            solution = solve(
                Weights.random(members, WIDTH, initial=STATE_FEEDBACK.initial),
                data,
                test=test,
                steps=steps,
                label=f"optimum {penalty or 'without penalty'}",
                **penalty,
            )
        found = _described(solution.model.weights, solution.history)
        rows.append({"kind": "optimum", "penalty": penalty, **found})
    return {"members": members, "steps": steps, "rows": rows}
