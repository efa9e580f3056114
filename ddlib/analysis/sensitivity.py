"""What a network of states responds to (section 6): which inputs, and which ranges of them.

Position, velocity and acceleration of each joint are the last two axes, ``(joint, width)``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddlib._check import (
    filled,
    finite_array,
    function_of,
    instance,
    number,
    seed_number,
    shaped,
)
from ddlib.learning import TorqueModel, Weights
from ddlib.metrics import rmss


def input_shares(weights: Weights) -> np.ndarray:
    """Share of each input in the variance of each hidden unit's net input, shaped like the weights.

    This holds for inputs that vary independently and equally much, as in a cube of random states.
    """
    instance("weights", weights, Weights)
    square = finite_array("weights.hidden_weights", weights.hidden_weights) ** 2
    total = square.sum((-2, -1), keepdims=True)
    if not (total > 0).all():
        raise ValueError("weights must have an input weight other than zero for each hidden unit")
    return square / total


def transition_range(weights: Weights, margin: float = 0.1) -> np.ndarray:
    """Length of each unit's transition region along each input, ``(..., hidden, joint, width)``.

    Activity goes from `margin` to ``1 - margin`` while an input of weight w moves by
    ``2 ln((1 - margin) / margin) / |w|``; 1 is the whole range of the training set.
    """
    instance("weights", weights, Weights)
    number("margin", margin, 0.0, 0.49, open_low=True)
    size = np.abs(finite_array("weights.hidden_weights", weights.hidden_weights))
    with np.errstate(divide="ignore"):
        return 2 * np.log((1 - margin) / margin) / size


def transition_centre(model: TorqueModel) -> np.ndarray:
    """Value of each input, in its unit, that brings a hidden unit to one half; others zero."""
    instance("model", model, TorqueModel)
    weights = model.weights.hidden_weights
    zero = model.scaled(np.zeros((1, *weights.shape[-2:])))[0]
    net = np.einsum("...hjw,jw->...h", weights, zero) + model.weights.hidden_bias
    with np.errstate(divide="ignore", invalid="ignore"):
        return -net[..., None, None] / (weights * model.inputs.gain[:, None])


def responses(model: TorqueModel, values) -> np.ndarray:
    """Activities, ``(..., joint, width, points, hidden)``, along one input, the others at zero."""
    instance("model", model, TorqueModel)
    values = shaped("values", values, "(points,)")
    filled("values", values)
    shape = model.weights.hidden_weights.shape[-2:]
    states = np.zeros((*shape, values.size, *shape))
    for joint, place in np.ndindex(*shape):
        states[joint, place, :, joint, place] = values
    hidden = model.weights.activity(model.scaled(states.reshape(-1, *shape)))[0]
    return hidden.reshape(*hidden.shape[:-2], *shape, values.size, hidden.shape[-1])


def shuffled(
    predict: Callable[[np.ndarray], np.ndarray], states, scale, seed: int = 0
) -> np.ndarray:
    """RMSS by which torques change when one input is shuffled, ``(joint, width, ...)``.

    `predict` makes torques of states ``(cases, joint, width)``; `scale` are their deviations.
    """
    function_of("predict", predict, "of states (cases, joint, width)")
    states = shaped("states", states, "(cases, joint, width)")
    before = predict(states)
    rng = np.random.default_rng(seed_number("seed", seed))
    order = rng.permutation(len(states))
    changes = []
    for joint, place in np.ndindex(*states.shape[1:]):
        other = states.copy()
        other[:, joint, place] = states[order, joint, place]
        changes.append(rmss(predict(other), before, scale=scale))
    return np.reshape(changes, (*states.shape[1:], *np.shape(changes[0])))
