"""Sections 4 and 5.3: what the size of the window and the number of hidden units decide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import CLASSES, classify, roughness, savitzky_golay
from ddlib.learning import TrainingSet, Weights, cases, solve, train_ensemble
from ddlib.setups import STATE_FEEDBACK, WINDOWS, split, train_windows
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import study
from workshop.report.studies.table import _row

# Window sizes from the smallest that can see an acceleration up to 0.8 s
_SIZES = (3, 5, 7, 11, 15, 21, 31, 41, 61, 81)


def _acceleration_error(recording, width) -> float:
    """RMS error of the least-squares acceleration over that of the true one, all joints."""
    taps = savitzky_golay(width, 2, LOG_STEP, degree=2)
    windows, _ = cases(recording, width)
    true = np.gradient(recording.qd_true, LOG_STEP, axis=-2)[..., recording.motion, :].reshape(
        -1, 2
    )
    wrong = windows @ taps - true
    return float(np.sqrt((wrong**2).mean() / true.var(0).mean()))


@study
def window_sizes(members=6) -> dict:
    """Training and test error against the size of the window, far beyond the paper's three."""
    recording = STATE_FEEDBACK.record()
    rows = []
    for width in _SIZES:
        model, history, _ = train_windows(STATE_FEEDBACK, recording, width, members)
        weights = model.weights
        cell = {**_row(model, history, recording), "derailed": history.derailed}
        if width >= 5:
            cell["roughness, hidden"] = np.median(roughness(weights.hidden_weights), (-2, -1))
            cell["roughness, direct"] = np.median(roughness(weights.direct_weights), (-2, -1))
        cell["acceleration error"] = _acceleration_error(split(recording)[0], width)
        rows.append({"width": width, **cell})
    return {"members": members, "rows": rows}


@study
def hidden_units(members=6, width=21, units=(1, 2, 5, 10, 20, 40)) -> dict:
    """Training and test error of `members` networks of one `width` for each number of `units`."""
    recording = STATE_FEEDBACK.record()
    rows = []
    for hidden in units:
        setup = replace(STATE_FEEDBACK, hidden=hidden, name=f"{hidden} hidden units")
        model, history, _ = train_windows(setup, recording, width, members)
        cell = {**_row(model, history, recording), "derailed": history.derailed}
        rows.append({"units": hidden, **cell})
    return {"members": members, "width": width, "rows": rows}


# Steps of Levenberg-Marquardt on shuffled torques: not enough to converge, and said so
_MEMORY_STEPS = 40

_MEMORY_DECAY = 1e-3  # Weight decay with which weights stay about as large as the printed ones


@study
def memory(members=5) -> dict:
    """Networks that have nothing to learn but noise: how much of it do they memorise?

    The targets are the torques in shuffled order, so that no window says anything about its
    torque; what the training error falls below 1 is memory. By descent as usual, which tells what
    these networks do memorise, and by Levenberg-Marquardt, with and without weight decay, which
    tells what they could. The solver is stopped after `_MEMORY_STEPS`; its gradients are kept.
    """
    training = split(STATE_FEEDBACK.record())[0]
    rows = []
    for width in WINDOWS:
        data = TrainingSet.from_recording(training, width)
        order = np.random.default_rng(0).permutation(len(data.y))
        shuffled = replace(data, y=data.y[order])
        weights = Weights.random(members, width, initial=STATE_FEEDBACK.initial)
        model, history, _ = train_ensemble(
            weights,
            shuffled,
            momentum=STATE_FEEDBACK.momentum,
            warm_up=STATE_FEEDBACK.warm_up,
            epochs=STATE_FEEDBACK.epochs,
            label=f"shuffled torques, window {width}",
        )
        classes = classify(model.weights.hidden_weights)
        rows.append(
            {
                "width": width,
                "weights": weights.count(biases=True),
                "targets": shuffled.y.size,
                "training": history.training[-1],
                "largest weight": model.weights.largest,
                "roughness, hidden": np.median(roughness(model.weights.hidden_weights), (-2, -1)),
                "classes": {name: (classes == name).mean((-2, -1)) for name in CLASSES},
                "solver": _capacity(weights, shuffled, 0.0),
                "solver, decay": _capacity(weights, shuffled, _MEMORY_DECAY),
            }
        )
    return {"members": members, "steps": _MEMORY_STEPS, "decay": _MEMORY_DECAY, "rows": rows}


def _capacity(weights, shuffled, decay) -> dict:
    """What the solver memorises in `_MEMORY_STEPS`, and how far from an optimum it was left."""
    found = solve(weights, shuffled, decay=decay, steps=_MEMORY_STEPS, label=f"decay {decay:g}")
    return {
        "training": found.history.training[-1],
        "course": np.median(found.history.training, 1),
        "largest weight": found.model.weights.largest,
        "gradient": found.gradient,
        "converged": found.converged,
    }
