"""Section 6: Table 6-1 with many networks, draws and choices; samples, units and epochs."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.learning import TorqueModel, TrainingSet, Weights, solve, train_ensemble
from ddlib.metrics import rmss
from workshop.report import results
from workshop.report.code_hash import study
from workshop.report.exact_states import (
    DESCENT,
    EPOCHS,
    INITIAL,
    MOMENTUM,
    RATE,
    SAMPLES,
    random_states,
    states_along,
    torque,
)


def _train(states, members, label="", **options):
    data = TrainingSet.from_arrays(states, torque(states))
    weights = Weights.random(members, 3, initial=options.pop("initial", INITIAL))
    return train_ensemble(weights, data, label=f"state space{label}", **(DESCENT | options))


def _errors(model: TorqueModel, sets: dict) -> dict:
    """Pooled RMSS on each set, by its own deviation and by random set A's."""
    own = torque(sets["random set A"]).std(0)
    return {
        name: {
            "own deviation": rmss(model.torque(states), torque(states)),
            "deviation of set A": rmss(model.torque(states), torque(states), scale=own),
        }
        for name, states in sets.items()
    }


def _sets(seed: int = 0) -> dict:
    extents = paper.APPENDIX_I_EXTENTS_DEG[paper.TEST_TRAJECTORY - 1]
    names = ("random set A", "random set B", "trajectory 6")
    states = (random_states(seed=2 * seed), random_states(seed=2 * seed + 1), states_along(extents))
    return dict(zip(names, states, strict=True))


@study
def _table_6_1(members=25, draws=8) -> dict:
    """Table 6-1 over initial weights and over draws of the sets; the networks are kept."""
    sets = _sets()
    model, history, _ = _train(sets["random set A"], members)
    model.save(results.FOLDER / "networks-state-space.npz")
    other = []
    for seed in range(1, draws + 1):
        drawn = _sets(seed)
        some, *_ = _train(drawn["random set A"], 4, label=f", draw {seed} of {draws}")
        other.append({"seed": seed, "errors": _errors(some, drawn)})
    return {
        "members": members,
        "errors": _errors(model, sets),
        "largest weight": model.weights.largest,
        "slope": history.slope(),
        "history": {"epochs": history.epochs, "training": history.training.T},
        "draws": other,
    }


@study
def _state_space_choices(members=8) -> dict:
    """What step size, momentum and initial weights decide in Table 6-1."""
    rows = []
    for rate, momentum, initial in (
        (RATE, MOMENTUM, INITIAL),
        (RATE, MOMENTUM, 0.1),
        (RATE / 2, MOMENTUM, INITIAL),
        (5.0, 0.98, 0.3),
        (5.0, 0.95, 0.3),
    ):
        sets = _sets()
        options = {"rate": rate, "momentum": momentum, "initial": initial}
        model, *_ = _train(sets["random set A"], members, label=f" {options}", **options)
        rows.append({**options, "errors": _errors(model, sets), "largest": model.weights.largest})
    return {"members": members, "rows": rows}


# --- how the error depends on samples, hidden units and the length of training

# Size and seed of the random set on which every error is measured
_TEST_SAMPLES, _TEST_SEED = 5000, 1000

_STEPS = 80  # Steps of Levenberg-Marquardt: the same for all sizes; most of the way, not to the end

# Samples of a training set, and draws of it that are solved (one network each)
_DRAWS = {100: 8, SAMPLES: 8, 1000: 6, 3000: 6, 10_000: 4, 30_000: 3, 100_000: 2}

# The same for momentum descent, with `_DESCENT_MEMBERS` networks each
_DESCENT_DRAWS = {100: 2, SAMPLES: 2, 1000: 2, 3000: 1}

_DESCENT_MEMBERS = 4  # Networks that descend together on one draw

_UNITS = (5, 10, 20, 40, 80)  # Hidden units of the networks that descend on set A

# Hidden units that are solved, samples of their training sets, draws of each
_SOLVED_UNITS, _SOLVED_SAMPLES, _SOLVED_DRAWS = (5, 10, 20, 40), 1000, 3


def _data(samples, seed):
    states = random_states(samples, seed)
    data = TrainingSet.from_arrays(states, torque(states))
    test = random_states(_TEST_SAMPLES, _TEST_SEED)
    return data, data.transform(test, torque(test))


def _ends(histories) -> dict:
    """Last training and test errors and the best test error on the way, all networks."""
    return {
        "training": np.concatenate([h.training[-1] for h in histories]),
        "test": np.concatenate([h.test[-1] for h in histories]),
        "best test": np.concatenate([h.best_test for h in histories]),
    }


def _descend(samples, draws, hidden=paper.HIDDEN_UNITS, epochs=EPOCHS, first=100):
    histories = []
    for draw in range(draws):
        data, test = _data(samples, first + draw)
        weights = Weights.random(_DESCENT_MEMBERS, 3, hidden, initial=INITIAL, seed=10 * draw)
        label = f"{samples:,} samples, {hidden} units, descent {draw + 1} of {draws}"
        options = DESCENT | {"epochs": epochs}
        histories.append(train_ensemble(weights, data, test=test, label=label, **options)[1])
    return histories


def _solve(samples, draws, hidden=paper.HIDDEN_UNITS) -> dict:
    """Errors after `_STEPS` steps of the solver, and the gradients that it stopped with."""
    solutions = []
    for draw in range(draws):
        data, test = _data(samples, 100 + draw)
        weights = Weights.random(1, 3, hidden, initial=INITIAL, seed=draw)
        label = f"{samples:,} samples, {hidden} units, solver {draw + 1} of {draws}"
        solutions.append(solve(weights, data, test=test, steps=_STEPS, label=label))
    errors = _ends([solution.history for solution in solutions])
    return {**errors, "gradient": np.concatenate([solution.gradient for solution in solutions])}


@study
def _state_space_sizes() -> dict:
    """Errors by number of samples, by number of hidden units, and over five times the epochs."""
    samples = [
        {
            "samples": n,
            "solver": _solve(n, draws),
            "descent": _ends(_descend(n, _DESCENT_DRAWS[n])) if n in _DESCENT_DRAWS else None,
        }
        for n, draws in _DRAWS.items()
    ]
    units = [
        {
            "units": hidden,
            "descent": _ends(_descend(SAMPLES, 1, hidden, first=0)),
            "solver": _solve(_SOLVED_SAMPLES, _SOLVED_DRAWS, hidden)
            if hidden in _SOLVED_UNITS
            else None,
        }
        for hidden in _UNITS
    ]
    (longer,) = _descend(SAMPLES, 1, epochs=5 * EPOCHS, first=0)
    return {
        "test samples": _TEST_SAMPLES,
        "steps": _STEPS,
        "samples": samples,
        "units": units,
        "solver's samples in units": _SOLVED_SAMPLES,
        "longer": {
            "epochs": longer.epochs,
            "training": longer.training.T,
            "test": longer.test.T,
            "slope": longer.slope(),
        },
    }
