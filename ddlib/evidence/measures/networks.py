"""Tables 4-1 and 6-1 (sections 4 and 6): what networks reach, from ``book/results``."""

from __future__ import annotations

import itertools

import numpy as np

from ddlib import paper
from ddlib.analysis import shuffled, transition_range
from ddlib.evidence.verdicts import Measured, mean, median, over_members
from ddlib.experiments import (
    STATE_FEEDBACK,
    WINDOWS,
    random_states,
    results,
    states_along,
    torque,
)
from ddlib.learning import TorqueModel, Weights
from ddlib.metrics import rmss
from ddlib.tables import significant, spread


def _cells(setup: str = STATE_FEEDBACK.name) -> dict[int, dict]:
    table = results.read("table-4-1")["setups"][setup]
    return {width: table[str(width)] for width in WINDOWS}


def _errors(column: str, setup: str = STATE_FEEDBACK.name) -> dict[int, np.ndarray]:
    return {width: np.array(cell["errors"][column]) for width, cell in _cells(setup).items()}


def _medians(errors: dict) -> str:
    return ", ".join(significant(np.median(e), 2) for e in errors.values())


def table_4_1(width: int, column: str, setup: str = STATE_FEEDBACK.name) -> Measured:
    """A cell of Table 4-1, median over all networks: `width`, `column` of the errors, `setup`."""
    cell = _errors(column, setup)[width]
    value, replicates = over_members(median, cell)
    return Measured(value, spread(cell), replicates)


def in_order(column: str, order: list, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Whether the median errors of the windows rise in this order.

    Parameters
    ----------
    column : str
        Column of the errors, like "test".
    order : sequence of int
        Windows from the lowest to the highest median error; those of equal rank in a list.
    setup : str
        Which reading of the controller.
    """
    errors = _errors(column, setup)

    def holds(*cells):
        medians = dict(zip(errors, map(median, cells)))
        ranks = [[medians[w] for w in np.atleast_1d(level)] for level in order]
        pairs = itertools.pairwise(ranks)
        return np.all([np.max(low, 0) < np.min(high, 0) for low, high in pairs], axis=0)

    value, replicates = over_members(holds, *errors.values())
    text = f"medians {_medians(errors)}; in {100 * replicates.mean():.0f} % of draws"
    return Measured(bool(value), text, replicates)


def worse_on_test(setup: str = STATE_FEEDBACK.name) -> Measured:
    """Smallest ratio of median test to median training error over the windows."""
    training, test = _errors("training", setup), _errors("test", setup)
    cells = [(training[w], test[w]) for w in WINDOWS]

    def least(*cells):
        return np.min([median(test) / median(training) for training, test in cells], axis=0)

    ratios = [significant(np.median(test) / np.median(training), 2) for training, test in cells]
    value, replicates = over_members(least, *cells)
    return Measured(value, "test / training " + ", ".join(ratios), replicates)


def multiplications(width: int = 21) -> Measured:
    """Weights of a network times the cases of an epoch."""
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    count = Weights.random(1, width)[0].count() * cases
    return Measured(float(count), f"{count:,} at window {width}")


def weights_against_nwh(widths=WINDOWS) -> Measured:
    """Weights of a network over ``n w h``, two joints and ten hidden units; furthest from 1.

    Parameters
    ----------
    widths : sequence of int
        Window sizes.
    """
    counts = {w: (Weights.random(1, w)[0].count(), 2 * w * paper.HIDDEN_UNITS) for w in widths}
    ratios = [count / product for count, product in counts.values()]
    text = ", ".join(f"{count} for {product} at {w}" for w, (count, product) in counts.items())
    return Measured(max(ratios, key=lambda r: abs(np.log(r))), f"weights for n w h: {text}")


def largest_weight(width: int, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Magnitude of the largest weight, the median over all networks."""
    largest = _cells(setup)[width]["largest weight"]
    value, replicates = over_members(median, largest)
    return Measured(value, spread(largest, 3), replicates)


def slope() -> Measured:
    """Largest median steepness of the error at the end of training, over the windows."""
    slopes = [np.abs(cell["slope"]) for cell in _cells().values()]
    text = ", ".join(significant(np.median(s), 2) for s in slopes)
    value, replicates = over_members(_largest_median, *slopes)
    return Measured(value, f"d ln(error) / d ln(epoch) {text}", replicates)


def _largest_median(*cells) -> np.ndarray:
    return np.max([median(cell) for cell in cells], axis=0)


def _sizes(column: str) -> dict[int, np.ndarray]:
    """Errors of the networks of ten window sizes, narrow ones first."""
    rows = results.read("window-sizes")["rows"]
    return {row["width"]: np.array(row[column]) for row in sorted(rows, key=lambda r: r["width"])}


def best_window() -> Measured:
    """Window with the lowest median test error, over sizes from 3 to 81."""
    sizes = _sizes("test")
    widths = np.array(list(sizes))

    def best(*cells):
        return widths[np.argmin([median(cell) for cell in cells], axis=0)]

    value, replicates = over_members(best, *sizes.values())
    least = significant(np.median(sizes[int(value)]), 2)
    return Measured(value, f"{value:.0f} samples ({least})", replicates)


def training_error_falls() -> Measured:
    """Share of steps to the next larger window at which the median training error falls."""
    sizes = _sizes("training")
    steps = len(sizes) - 1

    def falls(*cells):
        return (np.diff([median(cell) for cell in cells], axis=0) < 0).mean(0)

    value, replicates = over_members(falls, *sizes.values())
    text = f"{value * steps:.0f} of {steps} steps from {min(sizes)} to {max(sizes)} samples"
    return Measured(value, text, replicates)


def memory(width: int) -> Measured:
    """Training error on shuffled torques: what falls below 1 was memorised."""
    rows = {row["width"]: row for row in results.read("memory")["rows"]}
    errors = rows[width]["training"]
    value, replicates = over_members(median, errors)
    return Measured(value, spread(errors, 3), replicates)


# --- section 6: networks of exact states


def _median(values, text: str) -> Measured:
    value, replicates = over_members(median, values)
    return Measured(value, text, replicates)


def table_6_1(set_name: str, deviation: str = "own deviation") -> Measured:
    """A row of Table 6-1: the median over all networks."""
    errors = results.read("table-6-1")["errors"][set_name][deviation]
    return _median(errors, spread(errors))


def largest_state_weight() -> Measured:
    """Magnitude of the largest weight (Figure 6-1), the median over all networks."""
    largest = results.read("table-6-1")["largest weight"]
    return _median(largest, spread(largest, 3))


def state_slope() -> Measured:
    """Median steepness of the error at the end of training."""
    slopes = np.abs(results.read("table-6-1")["slope"])
    return _median(slopes, f"d ln(error) / d ln(epoch) {spread(slopes)}")


def generalisation() -> Measured:
    """Error on random set B over that on random set A, network by network: the median."""
    errors = results.read("table-6-1")["errors"]
    a, b = (np.array(errors[f"random set {name}"]["own deviation"]) for name in "AB")
    return _median(b / a, f"B / A {spread(b / a)}")


def trajectory_shoulder() -> Measured:
    """Error of the shoulder's torque on trajectory 6, by its own deviation: the median."""
    states = states_along(paper.APPENDIX_I_EXTENTS_DEG[paper.TEST_TRAJECTORY - 1])
    errors = rmss(_networks().torque(states), torque(states), pooled=False)[:, 0]
    return _median(errors, f"RMSS {spread(errors)}")


def shoulder_position() -> Measured:
    """Change of the torque when q1 is shuffled over the mean change for the other inputs."""
    states = random_states(2000, seed=77)
    scale = torque(states).std(0)
    changes = shuffled(_networks().torque, states, scale).reshape(6, -1)
    ratio = changes[0] / changes[1:].mean(0)
    text = f"RMSS of the change {spread(changes[0])}, other inputs {spread(changes[1:].mean(0))}"
    return _median(ratio, text)


def velocity_ranges() -> Measured:
    """Share of hidden units with a transition region within the range of shoulder velocity."""
    along = transition_range(_networks().weights)
    within = {name: along[..., j, k] < 1 for name, j, k in (("v1", 0, 1), ("q2", 1, 0))}
    value, replicates = over_members(mean, within["v1"])
    text = f"{100 * value:.0f} % of the units; of elbow position {100 * within['q2'].mean():.0f} %"
    return Measured(value, text, replicates)


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
