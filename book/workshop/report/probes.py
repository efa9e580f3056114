"""What the trial of the filters asks of units: linear probes, cancellation, other filters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib._check import finite_array
from ddlib.analysis import basis, content
from ddlib.learning import TorqueModel
from ddlib.simulation import LOG_STEP


def with_jerk(states) -> np.ndarray:
    """States ``(..., time, joint, 3)`` with the acceleration's central differences as a fourth."""
    states = finite_array("states", states, 3)
    jerk = np.gradient(states[..., 2], LOG_STEP, axis=-2)
    return np.concatenate([states, jerk[..., None]], -1)


def pure_part(f) -> np.ndarray:
    """Projection of weight functions onto parabolas: position, velocity and acceleration."""
    return content(f)[..., :3] @ basis(np.shape(f)[-1])[:3]


def with_filters(model: TorqueModel, hidden_weights) -> TorqueModel:
    """Networks whose hidden units have other weights from the window, all else as it was."""
    return replace(model, weights=replace(model.weights, hidden_weights=hidden_weights))


def cancellation(model: TorqueModel, windows) -> np.ndarray:
    """How much of the hidden units' influence on each output cancels, ``(..., output)``.

    One minus the deviation of their sum over the sum of their deviations: 0 if all push alike.
    """
    hidden, _ = model.weights.activity(model.scaled(windows))
    parts = hidden[..., None, :] * model.weights.output_weights[..., None, :, :]
    return 1 - parts.sum(-1).std(-2) / parts.std(-3).sum(-1)


def decoded(features, target, held_out, answer, ridge: float = 1e-6) -> np.ndarray:
    """R² with which a linear probe of features reads quantities in cases it was not fitted on.

    Fitted to `features` and `target`, with a `ridge` on the squared factors of standardised
    features as a share of the cases; `held_out` and `answer` are others. Negative: worse than their
    mean.
    """
    target, answer = finite_array("target", target), finite_array("answer", answer)
    read = _probe(features, target, held_out, ridge)
    return 1 - ((answer - read) ** 2).sum(0) / ((answer - answer.mean(0)) ** 2).sum(0)


def decoded_sign(features, target, held_out, answer, ridge: float = 1e-6) -> np.ndarray:
    """How often a linear probe tells the sign of quantities (balanced accuracy, chance 0.5)."""
    target, answer = finite_array("target", target), finite_array("answer", answer)
    read = _probe(features, np.where(target > 0, 1.0, -1.0), held_out, ridge) > 0
    up = answer > 0
    return 0.5 * ((read & up).sum(0) / up.sum(0) + (~read & ~up).sum(0) / (~up).sum(0))


def _probe(features, target, held_out, ridge):
    features, held_out = (
        finite_array(name, x) for name, x in (("features", features), ("held_out", held_out))
    )
    centre, size = features.mean(0), features.std(0)
    size = np.where(size > 0, size, 1)
    x, new = (features - centre) / size, (held_out - centre) / size
    square = x.T @ x + ridge * len(x) * np.eye(x.shape[1])
    return target.mean(0) + new @ np.linalg.solve(square, x.T @ (target - target.mean(0)))


def zero_crossings(filters, shift: float = 0.5) -> tuple[np.ndarray, np.ndarray]:
    """Which filters have two zero crossings, and whose middle then is off the centre."""
    two, off = (np.zeros(filters.shape[:-1], bool) for _ in range(2))
    for at in np.ndindex(two.shape):
        f = filters[at]
        k = np.flatnonzero(np.diff(np.sign(f)))
        if k.size == 2:
            crossings = k + f[k] / (f[k] - f[k + 1]) - f.size // 2
            two[at], off[at] = True, abs(crossings.mean()) >= shift
    return two, off
