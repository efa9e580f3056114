"""Tables 4-1 and 6-1, sections 5 to 7: what networks reach, and what their weights show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib import paper
from ddlib.analysis import classify, saturated, shares, shuffled, transition_range
from ddlib.learning import TorqueModel, TrainingSet, Weights, cases, train_ensemble
from ddlib.metrics import rmss
from ddlib.setups import STATE_FEEDBACK, WINDOWS
from ddlib.tables import scientific, spread
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured, judged, mean, median, rank_correlation
from workshop.report.exact_states import random_states, states_along, torque


def multiplications(width: int = 21) -> Measured:
    """Weights of a network times the cases of an epoch."""
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    count = Weights.random(1, width)[0].count() * cases
    return Measured(float(count), f"{count:,} at window {width}")


def weights_against_nwh(widths=WINDOWS) -> Measured:
    """Weights of a network over ``n w h``, two joints and ten hidden units; furthest from 1."""
    counts = {w: (Weights.random(1, w)[0].count(), 2 * w * paper.HIDDEN_UNITS) for w in widths}
    ratios = [count / product for count, product in counts.values()]
    text = ", ".join(f"{count} for {product} at {w}" for w, (count, product) in counts.items())
    return Measured(max(ratios, key=lambda r: abs(np.log(r))), f"weights for n w h: {text}")


def training_error_falls() -> Measured:
    """Share of steps to the next larger window at which the median training error falls."""
    rows = results.read("window-sizes")["rows"]
    sizes = {row["width"]: np.array(row["training"]) for row in rows}
    steps = len(sizes) - 1

    def falls(*cells):
        return (np.diff([median(cell) for cell in cells], axis=0) < 0).mean(0)

    text = f"of {steps} steps from {min(sizes)} to {max(sizes)} samples"
    return judged(falls, *sizes.values(), text=lambda value: f"{value * steps:.0f} {text}")


# --- section 6: networks of exact states


def trajectory_shoulder() -> Measured:
    """Error of the shoulder's torque on trajectory 6, by its own deviation: the median."""
    states = states_along(paper.APPENDIX_I_EXTENTS_DEG[paper.TEST_TRAJECTORY - 1])
    errors = rmss(_networks().torque(states), torque(states), pooled=False)[:, 0]
    return judged(median, errors, text=f"RMSS {spread(errors)}")


def shoulder_position() -> Measured:
    """Change of the torque when q1 is shuffled over the mean change for the other inputs."""
    states = random_states(2000, seed=77)
    scale = torque(states).std(0)
    changes = shuffled(_networks().torque, states, scale).reshape(6, -1)
    ratio = changes[0] / changes[1:].mean(0)
    text = f"RMSS of the change {spread(changes[0])}, other inputs {spread(changes[1:].mean(0))}"
    return judged(median, ratio, text=text)


def velocity_ranges() -> Measured:
    """Share of hidden units with a transition region within the range of shoulder velocity."""
    along = transition_range(_networks().weights)
    within = {name: along[..., j, k] < 1 for name, j, k in (("v1", 0, 1), ("q2", 1, 0))}
    found, elbow = (f"{100 * share.mean():.0f} %" for share in within.values())
    return judged(mean, within["v1"], text=f"{found} of the units; of elbow position {elbow}")


def best_of_sizes() -> Measured:
    """Least median error on 5,000 random states over all numbers of hidden units.

    There are three networks of each, too few to draw from: no replicates.
    """
    found = results.read("state-space-sizes")
    rows = {row["units"]: row["solver"]["test"] for row in found["units"] if row["solver"]}
    best = min(rows, key=lambda units: np.median(rows[units]))
    samples = found["solver's samples in units"]
    text = f"RMSS {spread(rows[best])} with {best} units, {samples:,} samples"
    return Measured(float(np.median(rows[best])), text)


def _networks() -> TorqueModel:
    return TorqueModel.load(results.FOLDER / "networks-state-space.npz")


# --- sections 5 and 7: weights and hidden units of the committed networks


def explained(layer: str = "direct") -> Measured:
    """Median share of position, velocity and acceleration in filters; the least of 3 windows."""
    cells, before = (
        [shares(committed.filters(w, layer, model))[..., :3].sum(-1) for w in WINDOWS]
        for model in (committed.networks, committed._untrained)
    )
    text = ", ".join(f"{100 * np.median(c):.0f} % at {w}" for c, w in zip(cells, WINDOWS))
    text += f" of the energy; before training at most {100 * max(map(np.median, before)):.0f} %"

    return judged(lambda *cells: np.min(list(map(median, cells)), axis=0), *cells, text=text)


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
    """Share of direct filters with two zero crossings whose middle is `shift` samples off."""
    two, off = _crossings(committed.filters(width, "direct"), shift)
    before = _crossings(committed.filters(width, "direct", committed._untrained), shift)[0]

    def share(pair):
        return mean(pair[0]) / np.maximum(mean(pair[1]), 1 / two.size)

    text = f"{off.sum()} of {two.sum()} filters with two crossings; before training {before.sum()} "
    return judged(share, (off, two), text=f"{text}have two")


def adjacency(width: int = 11, epochs: int = 100) -> Measured:
    """Change of the trained weights when the samples of all windows are shuffled alike.

    Initial weights are shuffled in the same way and the trained ones put back in order;
    the largest difference relative to the largest weight.
    """
    data = TrainingSet.from_recording(committed.training(), width)
    order = np.random.default_rng(0).permutation(width)
    start = Weights.random(1, width, initial=STATE_FEEDBACK.initial)

    def trained(places):
        weights = replace(start, **{name: getattr(start, name)[..., places] for name in along})
        mixed = replace(data, x=data.x[..., places])
        return train_ensemble(weights, mixed, momentum=0.9, epochs=epochs, progress=False)[
            0
        ].weights

    along = ("hidden_weights", "direct_weights")
    plain, mixed, back = trained(np.arange(width)), trained(order), np.argsort(order)
    gaps = (np.abs(getattr(mixed, n)[..., back] - getattr(plain, n)).max() for n in along)
    relative = float(max(gaps) / plain.largest.max())
    return Measured(relative, f"the weights differ by {scientific(relative)} after {epochs} epochs")


def untrained(width: int = 41) -> Measured:
    """Share of random weight functions that the rule calls not analysable."""
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
        return rank_correlation(x, y)

    units = f"over {sum(largest.size for largest, _ in cells)} units"
    return judged(correlation, *cells, text=lambda value: f"rank correlation {value:.2f} {units}")
