"""Sections 3 to 5: what windows, hidden units, states as inputs and acceleration decide."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import CLASSES, classify, roughness, savitzky_golay
from ddlib.learning import TrainingSet, Weights, cases, default_rate, solve, train_ensemble
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK, WINDOWS, split, train_windows
from ddlib.simulation import LOG_STEP, Recording
from workshop.report.code_hash import study
from workshop.report.parity import learn
from workshop.report.studies.table import errors_and_weights

# Window sizes from the smallest that can see an acceleration up to 0.8 s
_SIZES = (3, 5, 7, 11, 15, 21, 31, 41, 61, 81)


def acceleration_error(recording, width) -> float:
    """RMS error of the least-squares acceleration over that of the true one, all joints."""
    taps = savitzky_golay(width, 2, LOG_STEP, degree=2)
    windows, _ = cases(recording, width)
    true = np.gradient(recording.qd_true, LOG_STEP, axis=-2)[..., recording.motion, :].reshape(
        -1, 2
    )
    wrong = windows @ taps - true
    return float(np.sqrt((wrong**2).mean() / true.var(0).mean()))


@study
def _window_sizes(members=6) -> dict:
    """Training and test error against the size of the window, far beyond the paper's three."""
    recording = STATE_FEEDBACK.record()
    rows = []
    for width in _SIZES:
        model, history, _ = train_windows(STATE_FEEDBACK, recording, width, members)
        weights = model.weights
        cell = {**errors_and_weights(model, history, recording), "derailed": history.derailed}
        if width >= 5:
            cell["roughness, hidden"] = np.median(roughness(weights.hidden_weights), (-2, -1))
            cell["roughness, direct"] = np.median(roughness(weights.direct_weights), (-2, -1))
        cell["acceleration error"] = acceleration_error(split(recording)[0], width)
        rows.append({"width": width, **cell})
    return {"members": members, "rows": rows}


@study
def _hidden_units(members=6, width=21, units=(1, 2, 5, 10, 20, 40)) -> dict:
    """Training and test error of `members` networks of one `width` for each number of `units`."""
    recording = STATE_FEEDBACK.record()
    rows = []
    for hidden in units:
        setup = replace(STATE_FEEDBACK, hidden=hidden, name=f"{hidden} hidden units")
        model, history, _ = train_windows(setup, recording, width, members)
        cell = {**errors_and_weights(model, history, recording), "derailed": history.derailed}
        rows.append({"units": hidden, **cell})
    return {"members": members, "width": width, "rows": rows}


# Steps of Levenberg-Marquardt on shuffled torques: not enough to converge, and said so
_MEMORY_STEPS = 40

_MEMORY_DECAY = 1e-3  # Weight decay with which weights stay about as large as the printed ones


@study
def _memory(members=5) -> dict:
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
    solution = solve(weights, shuffled, decay=decay, steps=_MEMORY_STEPS, label=f"decay {decay:g}")
    return {
        "training": solution.history.training[-1],
        "course": np.median(solution.history.training, 1),
        "largest weight": solution.model.weights.largest,
        "gradient": solution.gradient,
        "converged": solution.converged,
    }


# --- sections 3.1 and 3.3: states in place of windows; with and without acceleration

_RACED = 0.9  # Acceleration in a race at one step size: the share of the last step that is repeated

# Epochs of the race by acceleration; on parity it may take twice as many
_LENGTHS = {0.0: 2200, _RACED: 500}

# Step sizes to choose from, as multiples of the usual one: twice it derails
_STEPS = (0.5, 1.0, 1.5)


def _states(recording: Recording, kind: str) -> np.ndarray:
    """Position, velocity and acceleration of both joints at every sample, ``(cases, 2, 3)``.

    "exact" is what a perfect sensor reads, its acceleration by central differences of the true
    velocity; "differences" are those of neighbouring measured positions; "least squares" fits
    parabolas to 21 of them.
    """
    if kind == "exact":
        acceleration = np.gradient(recording.qd_true, LOG_STEP, axis=-2)
        whole = np.stack([recording.q_true, recording.qd_true, acceleration], -1)
        return whole[..., recording.motion, :, :].reshape(-1, 2, 3)
    width = {"differences": 3, "least squares": 21}[kind]
    taps = np.stack([savitzky_golay(width, k, LOG_STEP, degree=2) for k in range(3)], -1)
    taps[:, 0] = np.eye(width)[width // 2]  # the position itself, unsmoothed
    return cases(recording, width)[0] @ taps


@study
def _state_inputs(members=6) -> dict:
    """Networks that get the state at one moment: exact, by differences, by least squares.

    Each of the three quantities is scaled to its own range, and the training is the one of
    Table 4-1.
    """
    training, test = split(STATE_FEEDBACK.record())
    (_, tau), (_, tau6) = cases(training, 3), cases(test, 3)
    rows = []
    for kind in ("exact", "differences", "least squares"):
        x, x6 = _states(training, kind), _states(test, kind)
        low, high = x.min(0), x.max(0)
        x, x6 = (x - low) / (high - low), (x6 - low) / (high - low)
        data = TrainingSet.from_arrays(x, tau)
        model, history, _ = train_ensemble(
            Weights.random(members, 3, initial=STATE_FEEDBACK.initial),
            data,
            test=data.transform(x6, tau6),
            momentum=STATE_FEEDBACK.momentum,
            warm_up=STATE_FEEDBACK.warm_up,
            epochs=STATE_FEEDBACK.epochs,
            label=f"states, {kind}",
        )
        rows.append(
            {
                "kind": kind,
                "training": rmss(model.torque(x), tau),
                "test": rmss(model.torque(x6), tau6),
                "best test": history.best_test,
                "largest weight": model.weights.largest,
            }
        )
    return {"members": members, "rows": rows}


@study
def _acceleration(members=25, epochs=2000, bits=3) -> dict:
    """With and without acceleration: errors by window and step size, and a race at window 21.

    Errors are those of `members` networks after `epochs`, with the table's acceleration. The race
    has `_RACED` and one step size, and is run on another task, too: parity of `bits` bits, with
    twice as many networks.
    """
    training = split(STATE_FEEDBACK.record())[0]
    return {
        "members": members,
        "epochs": epochs,
        "steps": _STEPS,
        "errors": {str(width): _by_step(training, width, members, epochs) for width in WINDOWS},
        "bits": bits,
        "race": _race(training, members),
        "parity": _race_on_parity(bits, 2 * members),
    }


def _data_and_start(training: Recording, width: int, members: int) -> tuple[TrainingSet, Weights]:
    data = TrainingSet.from_recording(training, width)
    return data, Weights.random(members, width, initial=STATE_FEEDBACK.initial)


def _by_step(training: Recording, width: int, members: int, epochs: int) -> dict:
    """Training errors without and with acceleration, each ``(members, step sizes)``."""
    data, start = _data_and_start(training, width, members)
    errors = {}
    for name, momentum in (("without", 0.0), ("with", STATE_FEEDBACK.momentum)):
        _, history, _ = train_ensemble(
            Weights.concatenate([start] * len(_STEPS)),
            data,
            rate=np.repeat([factor * default_rate(width) for factor in _STEPS], members),
            momentum=momentum,
            epochs=epochs,
            label=f"window {width}, {name} acceleration",
        )
        errors[name] = history.training[-1].reshape(len(_STEPS), members).T
    return errors


def _race(training: Recording, members: int, width: int = 21) -> dict:
    """Training errors along the epochs, ``(points, members)``, without and with acceleration."""
    data, start = _data_and_start(training, width, members)
    run = {}
    for name, (momentum, length) in zip(("without", "with"), _LENGTHS.items()):
        _, history, _ = train_ensemble(
            start,
            data,
            rate=default_rate(width),
            momentum=momentum,
            epochs=length,
            label=f"{name} acceleration, race",
        )
        run[name] = {"epochs": history.epochs, "training": history.training}
    return run


def _race_on_parity(bits: int, members: int) -> dict:
    """Epochs until parity is learnt, or all there are if it never is, without and with it."""
    learned = {}
    for name, (momentum, length) in zip(("without", "with"), _LENGTHS.items()):
        _, epochs = learn(
            bits, bits, members=members, momentum=momentum, epochs=2 * length, every=10
        )
        learned[name] = np.minimum(epochs, 2 * length)  # infinite if never
    return learned
