"""Networks on the real arm's cases: by descent as in 1988, and with weight decay."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from ddlib.learning import TorqueModel, TrainingSet, Weights, train_ensemble
from workshop.beyond.studies.tx40 import Windowed

_HIDDEN = 10  # as in 1988

# Per sample of a window: one of six joints has three times the inputs of one of two.
_DESCENT = {"rate": 22.0, "momentum": 0.995, "warm_up": 300}
_SCALING = (-1.0, 1.0)  # of the inputs
_EPOCHS = 2000  # of all networks but the longest


def trained(x, y, members: int, seed: int, width: int, snapshots=(), targets=None, hidden=_HIDDEN,
            epochs: int = _EPOCHS) -> tuple[TorqueModel, dict, TrainingSet]:  # fmt: skip
    """Networks by descent on windows ``(cases, 6, width)`` and currents ``(cases, outputs)``.

    ``targets`` ``(members, cases, outputs)`` are currents of each network in place of `y`. With
    the model come models of the epochs in ``snapshots``, and the data.
    """
    data = TrainingSet.from_arrays(x, y, scaling=_SCALING)
    start = Weights.random(members, width, hidden, x.shape[1], y.shape[1], seed=seed)
    scaled = None if targets is None else data.outputs.scale(targets)
    model, _, kept = train_ensemble(
        start, data, targets=scaled, rate=_DESCENT["rate"] / width, momentum=_DESCENT["momentum"],
        warm_up=_DESCENT["warm_up"], epochs=epochs, snapshots=snapshots, progress=False,
    )  # fmt: skip
    models = {e: TorqueModel(w, data.inputs, data.outputs) for e, w in kept.items()}
    return model, models, data


def wrong(predicted, data: Windowed, cases) -> np.ndarray:
    """Mean squared error of each output over the whole recording's variance, ``(..., 6)``."""
    error = predicted - data.current[cases]
    return (error**2).mean(-2) / data.current.var(0)


def _both(model: TorqueModel, data: Windowed, fold) -> list[np.ndarray]:
    """Errors of a fold: on what was learnt, and on the block left out."""
    return [wrong(model.torque(data.x[part]), data, part) for part in fold]


def _decayed(x, y, start: Weights, decay: float, steps: int = 300) -> TorqueModel:
    """One network by quasi-Newton steps on half the mean squared error with weight decay.

    Half of the decay times the sum of squared weights, biases left out, is added.
    """
    data = TrainingSet.from_arrays(x, y, scaling=_SCALING)
    flat = data.x.reshape(len(data.x), -1)
    names = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")
    shapes = [getattr(start, name).shape for name in names]
    ends = np.cumsum([np.prod(shape) for shape in shapes])

    def parts(vector):
        return [v.reshape(s) for v, s in zip(np.split(vector, ends[:-1]), shapes)]

    def objective(vector):
        w1, b1, w2, w3, b2 = parts(vector)
        first, direct = w1.reshape(len(b1), -1), w3.reshape(len(b2), -1)
        hidden = 1 / (1 + np.exp(-np.clip(flat @ first.T + b1, -500, 500)))
        out = 1 / (1 + np.exp(-np.clip(flat @ direct.T + hidden @ w2.T + b2, -500, 500)))
        error = out - data.y
        delta = error * out * (1 - out) / len(flat)
        back = (delta @ w2) * hidden * (1 - hidden)
        slopes = [
            back.T @ flat + decay * first, back.sum(0), delta.T @ hidden + decay * w2,
            delta.T @ flat + decay * direct, delta.sum(0),
        ]  # fmt: skip
        value = (error**2).sum() / len(flat) + decay * sum((w**2).sum() for w in (w1, w2, w3))
        return value / 2, np.concatenate([s.ravel() for s in slopes])

    begin = np.concatenate([getattr(start, name).ravel() for name in names])
    found = minimize(objective, begin, jac=True, method="L-BFGS-B", options={"maxiter": steps})
    return TorqueModel(Weights(*parts(found.x)), data.inputs, data.outputs)
