"""Table 6-1 with many networks, many draws of the sets, and other choices in training."""

from __future__ import annotations

from ddlib import paper
from ddlib.learning import TorqueModel, TrainingSet, Weights, train_ensemble
from ddlib.metrics import rmss
from workshop.report import results
from workshop.report.code_hash import study
from workshop.report.exact_states import (
    _DESCENT,
    INITIAL,
    MOMENTUM,
    RATE,
    random_states,
    states_along,
    torque,
)


def _train(states, members, label="", **options):
    data = TrainingSet.from_arrays(states, torque(states))
    weights = Weights.random(members, 3, initial=options.pop("initial", INITIAL))
    return train_ensemble(weights, data, label=f"state space{label}", **(_DESCENT | options))


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
def table_6_1(members=25, draws=8) -> dict:
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
def state_space_choices(members=8) -> dict:
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
