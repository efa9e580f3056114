"""Hidden units at work (section 5.2): saturation, ablation, matching.

Activities are ``(..., cases, hidden)``, leading axes networks; windows hold positions, rad,
``(cases, joint, width)``.
"""

from __future__ import annotations

import numpy as np

from ddlib._check import filled, finite_array, instance, number, shaped
from ddlib.learning import TorqueModel
from ddlib.metrics import rmss


def saturated(activity, margin: float = 0.1) -> np.ndarray:
    """Share of cases in which each unit is nearly off or on: below `margin` or above 1 less it."""
    activity = _activity(activity)
    number("margin", margin, 0.0, 0.5)
    return ((activity < margin) | (activity > 1 - margin)).mean(-2)


def transition_width(net_input, margin: float = 0.1) -> np.ndarray:
    """Width of each unit's transition region, in standard deviations of its net input.

    From `margin` to ``1 - margin`` a sigmoid's net input moves by ``2 ln((1 - margin) / margin)``.
    """
    net_input = finite_array("net_input", net_input)
    if net_input.ndim < 2:
        raise ValueError(f"net_input must have shape (..., cases, hidden), got {net_input.shape}")
    if not net_input.size or (net_input.std(-2) == 0).any():
        raise ValueError("net_input must vary over the cases at each unit")
    number("margin", margin, 0.0, 0.49, open_low=True)
    return 2 * np.log((1 - margin) / margin) / net_input.std(-2)


def net_inputs(model: TorqueModel, windows) -> np.ndarray:
    """Weighted sums of the hidden units, bias included, ``(..., cases, hidden)``."""
    instance("model", model, TorqueModel)
    x, weights = model.scaled(windows), model.weights
    net = np.einsum("...hjw,njw->...nh", weights.hidden_weights, x)
    return net + weights.hidden_bias[..., None, :]


def ablation(model: TorqueModel, windows, torque) -> tuple[list, np.ndarray]:
    """Units of one network, and its RMSS while each of them rests at its mean activity."""
    instance("model", model, TorqueModel)
    shaped("torque", torque, f"({len(model.scaled(windows))}, joint)")
    weights = model.weights
    if weights.hidden_bias.ndim != 1:
        raise ValueError(
            f"model must be a single network, got {weights.hidden_bias.shape[0]} (model[0])"
        )
    hidden, output = weights.activity(model.scaled(windows))
    logit = np.log(output / (1 - output))
    shift = hidden.mean(0) - hidden
    units, errors = list(range(hidden.shape[1])), []
    for unit in units:
        held = logit + shift[:, [unit]] @ weights.output_weights[:, [unit]].T
        errors.append(rmss(model.outputs.unscale(1 / (1 + np.exp(-held))), torque))
    return units, np.array(errors)


def refitted(features, torque, held_out, answer) -> np.ndarray:
    """Pooled RMSS of a linear output layer fitted anew to features: in training and on other cases.

    With hidden activities and windows as features this is what the hidden units are worth when the
    output layer has done its best with them; with windows alone, what a linear filter is.
    `features` and `held_out` are ``(cases, features)``, the torques `torque` and `answer`
    ``(cases, joint)``.
    """
    features, held_out = finite_array("features", features), finite_array("held_out", held_out)
    torque, answer = finite_array("torque", torque), finite_array("answer", answer)
    if features.ndim != 2 or len(features) != len(torque) or len(held_out) != len(answer):
        raise ValueError(
            "features must have a row for each torque, held_out for each answer, got shapes "
            f"{features.shape}, {torque.shape}, {held_out.shape} and {answer.shape}"
        )
    x, new = (np.column_stack([a, np.ones(len(a))]) for a in (features, held_out))
    factors = np.linalg.lstsq(x, torque, rcond=None)[0]
    return np.array([rmss(x @ factors, torque), rmss(new @ factors, answer)])


def matched_units(first, second) -> tuple[np.ndarray, np.ndarray]:
    """Pair the units of two networks by their activities ``(cases, hidden)`` on the same cases.

    The pairs maximise the sum of absolute correlations (Hungarian algorithm): a unit and its mirror
    image, which is on when the other is off, serve the network alike. Returned are the unit of
    `second` for each one of `first`, and the absolute correlations; 0 for units that never change.
    """
    from scipy.optimize import linear_sum_assignment

    shaped("first", first, "(cases, hidden)")
    shaped("second", second, "(cases, hidden)")
    first, second = _activity(first), _activity(second)
    if first.ndim != 2 or first.shape != second.shape:
        raise ValueError(
            "first and second must both have shape (cases, hidden), "
            f"got {first.shape} and {second.shape}"
        )
    a, b = (x - x.mean(0) for x in (first, second))
    size = np.outer(np.linalg.norm(a, axis=0), np.linalg.norm(b, axis=0))
    alike = np.abs(np.divide(a.T @ b, size, out=np.zeros_like(size), where=size > 1e-12))
    rows, partner = linear_sum_assignment(-alike)
    return partner, alike[rows, partner]


def _activity(activity) -> np.ndarray:
    activity = finite_array("activity", activity)
    filled("activity", activity)
    if activity.ndim < 2 or activity.min() < 0 or activity.max() > 1:
        raise ValueError(
            "activity must have shape (..., cases, hidden) and lie between 0 and 1, got shape "
            f"{activity.shape}"
        )
    return activity
