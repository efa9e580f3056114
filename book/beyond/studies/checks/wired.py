"""The real arm: a model of all six windows for all currents, or one of its own for each joint."""

from collections.abc import Callable
from functools import partial
from itertools import combinations, product

import numpy as np

from beyond.studies import tx40
from ddlib.learning import Weights
from workshop.report.code_hash import study

_WIDTHS, _DECAYS = (5, 11, 21), (1e-5, 1e-4)  # to choose from, at 100 samples a second
_SEEDS = 3
_STILL = 0.05  # rad/s: slower is at rest


def _network(x, y, training, decay: float, seed: int) -> np.ndarray:
    """Currents at all cases by a network with two hidden units for each joint that it sees."""
    joints, width = x.shape[1:]
    start = Weights.random(1, width, 2 * joints, joints, joints, seed=seed)[0]
    return tx40.decayed_network(x[training], y[training], start, decay).torque(x)


def _linear(x, y, training, penalty: float, seed: int) -> np.ndarray:
    flat = x.reshape(len(x), -1)
    return tx40.Ridge(flat[training], y[training]).predict(flat, penalty)


def _apart(model: Callable, x, y, *options) -> np.ndarray:
    return np.hstack([model(x[:, [j]], y[:, [j]], *options) for j in range(x.shape[1])])


_MODELS = {
    "network": (_network, _DECAYS),
    "network, by joint": (partial(_apart, _network), _DECAYS),
    "linear filter": (_linear, tx40.RIDGES[::2]),
    "linear filter, by joint": (partial(_apart, _linear), tx40.RIDGES[::2]),
    "equations": (None, (0.0,)),
}


def _tried(name: str, width: int, penalty: float, out: tuple, seed: int = 0) -> list[float]:
    """Errors on blocks that are left out together, of a model trained on all others."""
    data, model = tx40.Windowed.of(100, width), _MODELS[name][0]
    training = np.all([data.fold(block)[0] for block in out], axis=0)
    if model is None:
        states = data.states
        predicted = tx40.known_structure(states[training], data.current[training], states)
    else:
        predicted = model(data.x, data.current, training, penalty, seed)
    tests = (data.fold(block)[1] for block in out)
    return [float(tx40.wrong(predicted[test], data, test).mean()) for test in tests]


def _chosen(name: str) -> dict:
    """Errors ``(blocks, seeds)``; window and penalty chosen by leaving out another block, too."""
    options = list(product(_WIDTHS, _MODELS[name][1]))
    left_out = np.zeros((len(options), tx40.BLOCKS))
    for (k, option), (a, b) in product(enumerate(options), combinations(range(tx40.BLOCKS), 2)):
        left_out[k, [b, a]] += _tried(name, *option, (a, b))  # what is learnt without b, tried on a
    best = [options[k] for k in left_out.argmin(0)]
    seeds = range(_SEEDS if "network" in name else 1)
    errors = [[_tried(name, *o, (b,), seed)[0] for seed in seeds] for b, o in enumerate(best)]
    return {"chosen": best, "test": errors}


@study
def _real_arm_wired() -> dict:
    """Errors of all models, chosen alike, and the share of each block's cases at rest."""
    data = tx40.Windowed.of(100, 21)
    speed = np.abs(data.states[..., 1]).max(1)
    rest = [float((speed[test] < _STILL).mean()) for _, test in data.folds()]
    return {"rest": rest, "models": {name: _chosen(name) for name in _MODELS}}
