"""Why the filters are smooth: learning curves along the windows' directions, and predicted ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import roughness
from ddlib.learning import Directions, Lazy, TrainingSet, Weights
from ddlib.paper import EPOCHS
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, WINDOWS, split, train_windows
from workshop.report.code_hash import study

# Epochs of the learning curves: 4 in each decade
_COURSE = (0, *sorted({round(10 ** (k / 4)) for k in range(18)}), EPOCHS)

LAZY = 0.3
"""Range of initial weights from which networks stay near their tangent: ten times the book's."""

_RANGES = (0.03, 0.1, LAZY, 1.0)  # from which networks are compared with their tangents

_PRINTED = replace(STATE_FEEDBACK, initial=LAZY)

# State feedback with inputs around zero, against the printed "0.0 to 1.0"
_CENTRED = replace(_PRINTED, scaling=(-1.0, 1.0))

# The arm with damped joints, learnt by descent: inputs around zero, twice the step and four times
# the memory of `STATE_FEEDBACK`. Tuned so that descent comes near the printed training errors.
_DAMPED = replace(
    JOINT_DAMPING,
    initial=LAZY,
    steps=0,
    decay=0.0,
    scaling=(-1.0, 1.0),
    momentum=0.995,
    rate=66.0,
)

READINGS = (_PRINTED, _CENTRED, _DAMPED)

_SHOWN = 12  # Directions whose curves are kept, the steepest first


def _rmss(error, y) -> np.ndarray:
    """Pooled RMSS of scaled errors ``(..., cases, output)``."""
    return np.sqrt((error**2).mean(-2) / y.var(0)).mean(-1)


def _rough(hidden_weights) -> np.ndarray:
    return np.median(roughness(hidden_weights), (-2, -1))


def _correlation(a, b) -> float:
    return float(np.corrcoef(np.log(a), np.log(b))[0, 1])


def _alike(a, b) -> float:
    return float(np.corrcoef(a, b)[0, 1])


def _seen(along, weights, error, y) -> dict:
    """Changes and errors of one network along its training; directions last."""
    start = weights[0]
    change = weights.hidden_weights - start.hidden_weights
    lengths = [np.sqrt((w**2).sum((-3, -2, -1))) for w in (change, start.hidden_weights)]
    return {
        "change": along.energy(weights, start),
        "error": np.sqrt(((along.cases.T @ error) ** 2 / (len(y) * y.var(0))).mean(-1)),
        "rmss": _rmss(error, y),
        "moved": lengths[0] / lengths[1],
        "roughness, change": _rough(change[-1]),
        "roughness, trained": _rough(weights.hidden_weights[-1]),
    }


def _cell(setup, recording, width, members) -> dict:
    """One window size: measured and predicted courses of its networks, and what follows."""
    data = TrainingSet.from_recording(split(recording)[0], width, scaling=setup.scaling)
    along = Directions.of(data)
    _, _, snapshots = train_windows(setup, recording, width, members, snapshots=_COURSE)
    courses = Weights.stack([snapshots[epoch] for epoch in _COURSE])
    how = (setup.rate / width, _COURSE, setup.momentum, setup.warm_up)
    order = np.random.default_rng(0).permutation(len(data.y))
    seen = {"measured": [], "predicted": [], "shuffled": []}
    for member in range(members):
        weights = courses[:, member]
        lazy = Lazy(weights[0], data)
        error = weights.activity(data.x)[1] - data.y
        seen["measured"].append(_seen(along, weights, error, data.y))
        seen["predicted"].append(_seen(along, *lazy.predict(*how), data.y))
        null = lazy.predict(*how, targets=data.y[order])
        seen["shuffled"].append({"change": along.energy(null.weights, weights[0])})
    correlation = _correlations(seen, along.values**2)
    del seen["shuffled"]
    start = along.energy(snapshots[0])
    row = {
        "setup": setup.name,
        "scaling": setup.scaling,
        "width": width,
        "variance": (along.values / along.values[0]) ** 2,
        "correlation": correlation,
        "roughness, start": _rough(snapshots[0].hidden_weights),
    }
    every = {w: {k: np.array([c[k] for c in each]) for k in each[0]} for w, each in seen.items()}
    for who, courses in every.items():
        change = courses["change"] / start[:, None]
        row[who] = {
            "change over start": np.sqrt(np.median(change[..., :_SHOWN], 0)),
            "last change over start": np.sqrt(np.median(change[:, -1], 0)),
            "learnt": (change[:, -1] > 1).sum(-1),
            "error": np.median(courses["error"][..., :_SHOWN], 0),
            "rmss": courses["rmss"][:, -1],
            "halves": [_halves(each[:, :_SHOWN]) for each in courses["error"]],
            "moved": np.median(courses["moved"], 0),
            **{name: courses[name] for name in ("roughness, change", "roughness, trained")},
        }
    learnt = int(np.median(row["predicted"]["learnt"]))
    ends = [
        along.along(w)[..., learnt:].reshape(members, -1) for w in (snapshots[0], snapshots[EPOCHS])
    ]
    row["start kept"] = [_alike(*pair) for pair in zip(*ends)]
    ratio = every["measured"]["change"] / every["predicted"]["change"]
    apart = np.exp(np.abs(np.log(ratio[:, 1:, :_SHOWN])) / 2)
    return {**row, "factor": np.median(apart, -1)}


def _halves(error) -> np.ndarray:
    """First epoch at which a part of the error ``(epochs, directions)`` is half its first value.

    Between recorded epochs it goes linearly on logarithmic scales; NaN if it never is.
    """
    epochs, halves = np.log(_COURSE[1:]), []
    for course in np.log(2 * error[1:] / error[0]).T:
        k = np.argmax(course <= 0)
        if course[k] > 0:
            halves.append(np.nan)
        else:
            before = max(k - 1, 0)
            halves.append(np.exp(np.interp(0.0, course[[k, before]], epochs[[k, before]])))
    return np.array(halves)


def _correlations(seen, variance) -> dict:
    """How well changes are predicted, on a log scale over all directions, for each network.

    By its own tangent at every epoch but 0; at the end also by the next network's tangent, by
    its own with the torques in shuffled order, and by the windows' spectrum alone.
    """
    true, own, null = ([c["change"] for c in each] for each in seen.values())
    end = [change[-1] for change in true]
    others = {
        "of another": own[1:] + own[:1],
        "of shuffled torques": null,
        "of the spectrum": [variance[None]] * len(end),
    }
    return {
        "own": [[_correlation(a, b) for a, b in zip(t[1:], o[1:])] for t, o in zip(true, own)],
        **{name: [_correlation(a, b[-1]) for a, b in zip(end, o)] for name, o in others.items()},
    }


@study
def _span(members=5) -> dict:
    """Learning curves of `members` networks along the directions of their windows.

    By state feedback with both scalings of the inputs, and on the arm with damped joints; three
    windows each, all from the range `LAZY`. Then window 21 by state feedback from each of
    `_RANGES`: how far networks go from their tangents.
    """
    cells = []
    for setup in READINGS:
        recording = setup.record()
        cells += [_cell(setup, recording, width, members) for width in WINDOWS]
    recording = STATE_FEEDBACK.record()
    by_range = [_cell(replace(_PRINTED, initial=r), recording, 21, members) for r in _RANGES]
    names = ("correlation", "measured", "predicted", "factor", "start kept")
    return {
        "members": members,
        "epochs": _COURSE,
        "cells": cells,
        "ranges": _RANGES,
        "by range": [{name: cell[name] for name in names} for cell in by_range],
    }
