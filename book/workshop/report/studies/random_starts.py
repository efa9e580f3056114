"""What the range of the initial weights decides: a quantity that the report does not print.

Three studies over `RANGES`, the readings of section 4 and the windows of Table 4-1: networks by
descent as in 1988 (`start`), by the solver (`start_solver`), and networks of window 21 beside those
trained on unrelated torques (`start_nulls`). Every cell is kept as soon as it is finished.

`agreement` is the rule by which the book infers the range from the report's own words and figures.
It was written down before these studies ran, and after a trial on other recordings (five networks,
one recording a reading) had been seen. So were these expectations:

- The smaller the range, the further hidden units turn away from their start, and the more the
  tangent kernel changes.
- At every range tried, real torques give more hidden acceleration filters than 95 % of the
  unrelated ones do; they do not give more velocity filters.
- At window 21 the test error of ranges of 0.1 and less is below that of 0.3, in every reading.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ddlib import learning, paper
from ddlib.analysis import (
    CLASSES,
    LAYERS,
    classify,
    gains,
    mean_gradient,
    roughness,
    saturated,
    shares,
)
from ddlib.learning import TorqueModel, TrainingSet, Weights, cases, surrogates
from ddlib.setups import SETUPS, WINDOWS, Setup, errors, split, train_windows
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import code_hash, study
from workshop.report.probes import cancellation, zero_crossings
from workshop.report.sweeps import _sweep

RANGES = (0.01, 0.03, 0.1, 0.3, 1.0)
"""Initial weights are uniform in plus or minus one of these."""

SCALINGS = {"0 to 1": (0.0, 1.0), "-1 to 1": (-1.0, 1.0)}
"""Ranges of the network's inputs; the report prints the first."""

DAYS = (41, 42, 43, 44)
"""Seeds of `Setup.repeated`: recordings that no trial and no other study has used."""

NETWORKS = 3
"""Networks of each recording: twelve in a cell."""

_SOLVERS = {"solver": False, "solver, white inputs": True}
_STEPS, _DECAY = 60, 1e-6  # of Levenberg-Marquardt
SOLVED = (0.03, 0.3)
"""Ranges from which networks are trained by the solver."""

_NULL_EPOCHS = 5000
_NULL_RANGES = (0.03, 0.1, 0.3)
_NULL_DRAWS = 200  # of each kind, a network for each: p-values down to 1/201
_NULL_NETWORKS = 10  # of the real torques of each recording


# --- what the report saw ----------------------------------------------------------------------

_SMOOTH = 0.05
"""Median roughness up to which filters count as "extremely smooth": a random one has about 1."""


def agreement(cell: Mapping, layer: str = "hidden") -> dict[str, float]:
    """In which share of the networks each of seven remarks of the report comes out.

    Of one reading and range, networks by descent: `cell` has for each window what `described`
    tells, each of shape ``(networks,)`` or more. The rule reads the remarks on filters of the
    hidden units; with `layer` "direct" they are read of the weights past them.

    - *smooth at 21*: "extremely smooth. This is generally the case in the network with window size
      21". The median roughness of hidden filters is at most `_SMOOTH`.
    - *rough at 41*: "some curves with rough edges", some "do not decompose cleanly". The median
      roughness at 41 is at least twice that at 21, and a tenth or more of the hidden filters at 41
      have no name, but not nine tenths.
    - *three kinds at 21*: Figures 5-4 to 5-6. One network of window 21 has hidden filters of
      velocity, of acceleration, and of both.
    - *acceleration at 21*: "most of the units appear to respond almost solely to acceleration".
      Filters of acceleration, or of velocity and acceleration, are more than half of the hidden
      ones.
    - *saturated at 21*: "most units are saturated most of the time". The median unit is, in more
      than half of the cases.
    - *largest weights*: 18.9, 11.7 and 4.2 are each met within a factor of 2.
    - *small constants at 21*: "the constant terms in our filter functions were extremely small":
      in the median at most 5 % of a hidden filter's energy.
    """
    at = {width: cell[str(width)] for width in WINDOWS}
    hidden = {width: at[width][layer] for width in WINDOWS}
    names = {name: np.asarray(share) for name, share in hidden[21]["names"].items()}
    unnamed = np.asarray(hidden[41]["names"]["not analysable"])
    rough = {width: np.asarray(hidden[width]["roughness"]) for width in (21, 41)}
    largest = [np.asarray(at[w]["largest weight"]) / paper.LARGEST_WEIGHT[w] for w in WINDOWS]
    kinds = [names[name] > 0 for name in ("velocity", "acceleration", "velocity + acceleration")]
    met = {
        "smooth at 21": rough[21] <= _SMOOTH,
        "rough at 41": (rough[41] >= 2 * rough[21]) & (unnamed >= 0.1) & (unnamed <= 0.9),
        "three kinds at 21": np.all(kinds, axis=0),
        "acceleration at 21": names["acceleration"] + names["velocity + acceleration"] > 0.5,
        "saturated at 21": np.asarray(at[21]["saturated"]) > 0.5,
        "largest weights": np.all([(0.5 <= x) & (x <= 2) for x in largest], axis=0),
        "small constants at 21": np.asarray(hidden[21]["constant"]) <= 0.05,
    }
    return {remark: float(np.mean(each)) for remark, each in met.items()}


def chosen(cells: Mapping) -> tuple[float, dict[float, float]]:
    """The range that agrees best with the report, and how many remarks each range meets.

    A range's score is the sum of `agreement` over the seven remarks, inputs from 0 to 1, by
    descent, averaged over the three readings, because the report does not say which is its own.
    The largest score decides; of ranges that are within half a remark of it the largest range,
    which is nearest to the custom of the time (0.3, Rumelhart, Hinton & Williams 1986).
    """
    scores = {
        size: float(np.mean([sum(agreement(cells[name][str(size)]).values()) for name in SETUPS]))
        for size in RANGES
    }
    best = max(scores.values())
    return max(size for size, score in scores.items() if score >= best - 0.5), scores


# --- what is measured on networks -------------------------------------------------------------


def described(model: TorqueModel, start: Weights, recording, setup: Setup) -> dict:
    """What a cell keeps of trained networks, one value or array for each of them.

    Errors, sizes, names, shapes, saturation, cancelling, the inertia that they hold, and how far
    they moved: `turn`, one minus the cosine between a hidden unit's weights before and after, and
    `kernel`, the same of the tangent kernel (median over units, and whole).
    """
    width, weights = model.weights.width, model.weights
    windows, _ = cases(split(recording)[0], width)
    row: dict = errors(model, recording).named()
    row["largest weight"] = weights.largest
    for layer, attribute in LAYERS.items():
        row[layer] = _shapes(getattr(weights, attribute))
    hidden = weights.activity(model.scaled(windows))[0]
    row["saturated"] = np.median(saturated(hidden), -1)
    row["cancelled"] = cancellation(model, windows).mean(-1)
    inertia = gains(mean_gradient(model, windows), LOG_STEP)[..., 2]
    row["M11"], row["M22"] = inertia[..., 0, 0], inertia[..., 1, 1]
    row["turn"] = np.median(_turn(weights, start), -1)
    every = np.linspace(0, len(windows) - 1, 100).round().astype(int)
    x = model.scaled(windows[every])
    pairs = ((start[k], weights[k]) for k in range(len(weights)))
    row["kernel"] = np.array([1 - _alike(*(_kernel(w, x) for w in pair)) for pair in pairs])
    return row


def _shapes(f) -> dict:
    names = classify(f)
    two, off = zero_crossings(f)
    return {
        "names": {name: (names == name).mean((1, 2)) for name in CLASSES},
        "roughness": np.median(roughness(f), (1, 2)),
        "constant": np.median(shares(f)[..., 0], (1, 2)),
        "two crossings": two.sum((1, 2)),
        "asymmetric": off.sum((1, 2)),
        "largest weight": np.abs(f).max((1, 2, 3)),
    }


def _turn(weights: Weights, start: Weights) -> np.ndarray:
    """One minus the cosine between each hidden unit's weights before and after training."""
    before, after = (w.hidden_weights.reshape(*w.hidden_bias.shape, -1) for w in (start, weights))
    size = np.linalg.norm(before, axis=-1) * np.linalg.norm(after, axis=-1)
    return 1 - (before * after).sum(-1) / size


def _kernel(weights: Weights, x) -> np.ndarray:
    """Tangent kernel of the outputs of one network: products of their gradients, case by case."""
    gradient = learning.jacobian(weights, x)
    gradient = gradient.reshape(-1, gradient.shape[-1])
    return gradient @ gradient.T


def _alike(first, second) -> float:
    """Cosine between two kernels."""
    return float((first * second).sum() / np.linalg.norm(first) / np.linalg.norm(second))


def _reading(name: str, scaling: str, initial: float) -> Setup:
    """A reading of section 4 with a range of inputs and of initial weights, by descent."""
    return replace(SETUPS[name], initial=initial, scaling=SCALINGS[scaling], steps=0, decay=0.0)


def _pooled(found: list):
    """Values of several recordings, one after another, all through dictionaries."""
    if isinstance(found[0], dict):
        return {name: _pooled([each[name] for each in found]) for name in found[0]}
    return np.concatenate(found).tolist()


def _cell(reading: str, scaling: str, initial: float, width: int, method: str) -> dict:
    setup = _reading(reading, scaling, initial)
    if method != "descent":
        setup = replace(setup, steps=_STEPS, decay=_DECAY)
    parts = []
    for day in DAYS:
        recording = setup.repeated(day).record()
        options = {"seed": 100 * day, "progress": False, "whiten": _SOLVERS.get(method, True)}
        model, history, _ = train_windows(setup, recording, width, NETWORKS, **options)
        start = Weights.random(NETWORKS, width, initial=initial, seed=100 * day)
        parts.append(described(model, start, recording, setup))
        parts[-1]["best test"] = history.best_test
        parts[-1]["derailed"] = history.derailed.astype(int)
        epochs = np.array([*history.epochs, np.inf])
        half = np.vstack([history.training < 0.5, np.full(NETWORKS, True)]).argmax(0)
        parts[-1]["until half"] = epochs[half]  # epochs, or steps, with a training error above 0.5
    return _pooled(parts)


def _grid(methods, name: str, scalings=tuple(SCALINGS), widths=WINDOWS, ranges=RANGES) -> dict:
    """Cells by method, scaling, reading, range and window."""
    settings = [
        {"reading": reading, "scaling": scaling, "initial": size, "width": width, "method": method}
        for method in methods
        for scaling in scalings
        for reading in SETUPS
        for size in ranges
        for width in widths
    ]
    cells = _sweep(_cell, settings, code=code_hash(name), backend="sequential", label=name)
    grid: dict = {}
    for setting, cell in zip(settings, cells):
        place = grid.setdefault(setting["method"], {}).setdefault(setting["scaling"], {})
        place = place.setdefault(setting["reading"], {}).setdefault(str(setting["initial"]), {})
        place[str(setting["width"])] = cell
    return {"ranges": ranges, "days": DAYS, "networks": NETWORKS, "cells": grid}


@study
def _start() -> dict:
    """Networks by descent as in 1988, from each range of initial weights."""
    return _grid(("descent",), "start")


@study
def _start_solver() -> dict:
    """The same by Levenberg-Marquardt, thinner: two ranges, inputs from 0 to 1, window 21."""
    return _grid(_SOLVERS, "start-solver", ("0 to 1",), (21,), SOLVED)


# --- beside unrelated torques -----------------------------------------------------------------


def _against(reading: str, initial: float) -> dict:
    """Shares of names in networks of window 21: real torques, and one network for each null."""
    setup, width = replace(_reading(reading, "0 to 1", initial), epochs=_NULL_EPOCHS), 21
    by_kind: dict = {"real": [], "shifted": [], "phases": []}
    for day in DAYS:
        training, _ = split(setup.repeated(day).record())
        data = TrainingSet.from_recording(training, width, scaling=setup.scaling)
        torques = training.tau[:, training.motion]
        each = _NULL_DRAWS // len(DAYS)
        targets = {
            "real": np.repeat(torques[None], _NULL_NETWORKS, 0),
            "shifted": surrogates("shifted", torques, each, seed=1000 * day),
            "phases": surrogates("phases", torques, each, seed=1000 * day + 500),
        }
        for kind, wanted in targets.items():
            scaled = data.outputs.scale(wanted.reshape(len(wanted), -1, 2))
            start = Weights.random(
                len(wanted), width, setup.hidden, initial=initial, seed=10_000 * day + len(kind)
            )
            model, *_ = learning.train_ensemble(
                start, data, targets=scaled, rate=setup.rate / width, momentum=setup.momentum,
                warm_up=setup.warm_up, epochs=setup.epochs, progress=False,
            )  # fmt: skip
            model = TorqueModel(model.weights, data.inputs, data.outputs, LOG_STEP)
            inertia = gains(mean_gradient(model, cases(training, width)[0]), LOG_STEP)[:, 0, 0, 2]
            shapes = {layer: _shapes(getattr(model.weights, a)) for layer, a in LAYERS.items()}
            by_kind[kind].append({**shapes, "M11": inertia})
    return {kind: _pooled(each) for kind, each in by_kind.items()}


@study
def _start_nulls() -> dict:
    """Names of filters beside 200 shifted and 200 phase-randomised torques, inputs from 0 to 1.

    Thin: window 21, three of the ranges, a quarter of the epochs.
    """
    settings = [{"reading": r, "initial": size} for r in SETUPS for size in _NULL_RANGES]
    rows = _sweep(
        _against, settings, code=code_hash("start-nulls"), backend="sequential", label="nulls"
    )
    by_reading: dict = {}
    for setting, row in zip(settings, rows):
        by_reading.setdefault(setting["reading"], {})[str(setting["initial"])] = row
    counts = {"draws": _NULL_DRAWS, "networks": _NULL_NETWORKS * len(DAYS)}
    return {"ranges": _NULL_RANGES, "epochs": _NULL_EPOCHS, **counts, "rows": by_reading}
