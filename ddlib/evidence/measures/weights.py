"""Sections 5 and 7: further claims on weights and hidden units of the committed networks."""

from __future__ import annotations

import numpy as np
from scipy.stats import rankdata

from ddlib.analysis import classify, saturated, shares
from ddlib.evidence import committed
from ddlib.evidence.verdicts import Measured, mean, median, over_members
from ddlib.experiments import STATE_FEEDBACK, WINDOWS
from ddlib.learning import TrainingSet, Weights, cases, train_ensemble
from ddlib.metrics import rmss
from ddlib.simulation import LOG_STEP
from ddlib.tables import scientific, significant

NAMED = ("velocity", "acceleration", "velocity + acceleration")
"""Classes of filters that control theory uses."""


def explained(layer: str = "direct") -> Measured:
    """Median share of position, velocity and acceleration in filters, the least of three windows.

    Parameters
    ----------
    layer : {"direct", "hidden"}
        Direct weights, or those of hidden units.
    """
    cells = [shares(committed.filters(w, layer))[..., :3].sum(-1) for w in WINDOWS]
    text = ", ".join(f"{100 * np.median(c):.0f} % at {w}" for c, w in zip(cells, WINDOWS))
    before = [
        np.median(shares(committed.filters(w, layer, committed.untrained))[..., :3].sum(-1))
        for w in WINDOWS
    ]
    text += f" of the energy; before training at most {100 * max(before):.0f} %"

    def least(*cells):
        return np.min([median(cell) for cell in cells], axis=0)

    value, replicates = over_members(least, *cells)
    return Measured(value, text, replicates)


def _crossings(filters, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Which filters have two zero crossings, and whose middle then is off the centre."""
    two, off = (np.zeros(filters.shape[:-1], bool) for _ in range(2))
    for at in np.ndindex(two.shape):
        f = filters[at]
        k = np.flatnonzero(np.diff(np.sign(f)))
        if k.size == 2:
            crossings = k + f[k] / (f[k] - f[k + 1]) - f.size // 2
            two[at], off[at] = True, abs(crossings.mean()) >= shift
    return two, off


def asymmetric(width: int = 21, shift: float = 0.5) -> Measured:
    """Share of direct filters with two zero crossings whose middle is off the centre.

    Parameters
    ----------
    width : int
        Window size.
    shift : float
        Off the centre: by this many samples or more.
    """
    two, off = _crossings(committed.filters(width, "direct"), shift)
    before = _crossings(committed.filters(width, "direct", committed.untrained), shift)[0]

    def share(pair):
        return mean(pair[0]) / np.maximum(mean(pair[1]), 1 / two.size)

    value, replicates = over_members(share, (off, two))
    text = f"{off.sum()} of {two.sum()} filters with two crossings; before training {before.sum()} "
    return Measured(value, f"{text}have two", replicates)


def adjacency(width: int = 11, epochs: int = 100) -> Measured:
    """Change of the trained weights when the samples of all windows are shuffled alike.

    Initial weights are shuffled in the same way and the trained ones put back in order;
    the largest difference relative to the largest weight.

    Parameters
    ----------
    width : int
        Window size.
    epochs : int
        Length of training.
    """
    data = TrainingSet.from_recording(committed.training(), width)
    order = np.random.default_rng(0).permutation(width)
    start = Weights.random(1, width, initial=STATE_FEEDBACK.initial)
    trained = []
    for places in (np.arange(width), order):
        mixed = TrainingSet(data.x[..., places], data.y, data.inputs, data.outputs)
        weights = Weights(
            start.hidden_weights[..., places], start.hidden_bias, start.output_weights,
            start.direct_weights[..., places], start.output_bias,
        )  # fmt: skip
        model, *_ = train_ensemble(weights, mixed, momentum=0.9, epochs=epochs, progress=False)
        trained.append(model.weights)
    plain, shuffled = trained
    back = np.argsort(order)
    gap = max(
        float(np.abs(getattr(shuffled, name)[..., back] - getattr(plain, name)).max())
        for name in ("hidden_weights", "direct_weights")
    )
    relative = gap / float(plain.largest.max())
    return Measured(relative, f"the weights differ by {scientific(relative)} after {epochs} epochs")


def untrained(width: int = 41) -> Measured:
    """Share of random weight functions that the rule calls not analysable.

    Parameters
    ----------
    width : int
        Window size.
    """
    found = classify(Weights.random(25, width).hidden_weights.reshape(-1, width))
    rough = found == "not analysable"
    return Measured(float(rough.mean()), f"{rough.sum()} of {rough.size} random functions")


def weights_and_saturation() -> Measured:
    """Rank correlation of a unit's largest weight and the time it is saturated, all windows."""
    cells = []
    for width in WINDOWS:
        model, (windows, _) = committed.networks(width), cases(committed.training(), width)
        activity = model.weights.activity(model.scaled(windows))[0]
        largest = np.abs(model.weights.hidden_weights).max((-2, -1))
        cells.append((largest, saturated(activity)))

    def correlation(*drawn):
        x, y = (np.concatenate([c[k].reshape(len(c[k]), -1) for c in drawn], -1) for k in (0, 1))
        ranks = [rankdata(values, axis=-1) for values in (x, y)]
        x, y = (r - r.mean(-1, keepdims=True) for r in ranks)
        return (x * y).sum(-1) / np.sqrt((x**2).sum(-1) * (y**2).sum(-1))

    value, replicates = over_members(correlation, *cells)
    units = sum(largest.size for largest, _ in cells)
    return Measured(value, f"rank correlation {value:.2f} over {units} units", replicates)


def interpretable(width: int = 21, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Share of filters that are velocity, acceleration or a sum of both, less the untrained's.

    Parameters
    ----------
    width : int
        Window size.
    setup : str
        Which reading of the controller.
    """
    found, before = (
        {
            layer: np.isin(classify(committed.filters(width, layer, model, setup)), NAMED)
            for layer in ("hidden", "direct")
        }
        for model in (committed.networks, committed.untrained)
    )
    text = f"{found['hidden'].sum()} of {found['hidden'].size} hidden, "
    text += f"{found['direct'].sum()} of {found['direct'].size} direct filters; before training "
    text += f"{before['hidden'].sum()} and {before['direct'].sum()}"
    both = tuple(np.concatenate(list(named.values()), -1) for named in (found, before))
    value, replicates = over_members(lambda pair: mean(pair[0]) - mean(pair[1]), both)
    return Measured(value, text, replicates)


def _held_still(width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque of the networks, torque with all hidden units at their mean, measured torque."""
    model, (windows, torque) = committed.networks(width), cases(committed.training(), width)
    hidden, output = model.weights.activity(model.scaled(windows))
    shift = (hidden.mean(-2, keepdims=True) - hidden) @ np.swapaxes(
        model.weights.output_weights, -1, -2
    )
    logit = np.log(output / (1 - output)) + shift
    still = model.outputs.unscale(1 / (1 + np.exp(-logit)))
    return model.outputs.unscale(output), still, torque


def without_hidden_units(width: int = 21) -> Measured:
    """Training error with all hidden units held at their mean over that of the whole network.

    Parameters
    ----------
    width : int
        Window size.
    """
    whole, still, torque = _held_still(width)
    ratio = rmss(still, torque) / rmss(whole, torque)
    value, replicates = over_members(median, ratio)
    return Measured(value, f"error {significant(value, 2)} times as large without them", replicates)


def compensate_friction(width: int = 21) -> Measured:
    """Share of the hidden units' non-linear part that friction explains, better of two joints.

    The direct weights add a linear function of the window to the net input of an output unit;
    whatever is not linear in it comes from the hidden units. Least squares takes the linear
    part out of the hidden units' sum, of the true friction torque and of the rigid body's
    torque; R² is the squared correlation of what is left, its median over networks.

    Parameters
    ----------
    width : int
        Window size.
    """
    model, run = committed.networks(width), committed.training()
    windows = cases(run, width)[0]
    hidden = model.weights.activity(model.scaled(windows))[0]
    sums = np.einsum("mnh,moh->mno", hidden, model.weights.output_weights)
    speed = run.qd_true[..., run.motion, :]
    acceleration = np.gradient(run.qd_true, LOG_STEP, axis=-2)[..., run.motion, :]
    torques = {
        "friction": STATE_FEEDBACK.effects.friction_torque(speed),
        "rigid body": STATE_FEEDBACK.arm.inverse_dynamics(
            run.q_true[..., run.motion, :], speed, acceleration
        ),
    }
    linear = np.column_stack([windows.reshape(len(windows), -1), np.ones(len(windows))])

    def curved(y):
        return y - linear @ np.linalg.lstsq(linear, y, rcond=None)[0]

    parts = [curved(y) for y in sums]
    fits = {}
    for name, torque in torques.items():
        left = curved(torque.reshape(-1, 2))
        each = [[np.corrcoef(p[:, j], left[:, j])[0, 1] ** 2 for j in (0, 1)] for p in parts]
        fits[name] = np.array(each)
    text = "; ".join(
        f"{name}: R² {a:.2f} and {b:.2f}"
        for name, (a, b) in ((name, np.median(each, axis=0)) for name, each in fits.items())
    )

    def better(each):
        return np.median(each, axis=1).max(-1)

    value, replicates = over_members(better, fits["friction"])
    return Measured(value, f"{text}, shoulder and elbow", replicates)
