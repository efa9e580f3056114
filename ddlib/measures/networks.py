"""Section 4 and Table 4-1: window networks on the six recordings, from ``book/results``."""

from __future__ import annotations

import itertools

import numpy as np

from ddlib import paper, results
from ddlib.experiment import STATE_FEEDBACK, WINDOWS
from ddlib.network import Weights
from ddlib.tables import number, spread
from ddlib.verdicts import Measured


def _cells(setup: str = STATE_FEEDBACK.name) -> dict[int, dict]:
    table = results.read("table-4-1")["setups"][setup]
    return {width: table[str(width)] for width in WINDOWS}


def _errors(column: str, setup: str = STATE_FEEDBACK.name) -> dict[int, np.ndarray]:
    return {width: np.array(cell["errors"][column]) for width, cell in _cells(setup).items()}


def _medians(errors: dict) -> str:
    return ", ".join(number(np.median(e), 2) for e in errors.values())


def table_4_1(width: int, column: str, setup: str = STATE_FEEDBACK.name) -> Measured:
    """A cell of Table 4-1, median over all networks: `width`, `column` of the errors, `setup`."""
    cell = _errors(column, setup)[width]
    return Measured(float(np.median(cell)), spread(cell))


def share_in_order(column: str, order: list, setup: str = STATE_FEEDBACK.name) -> Measured:
    """Share of bootstrap draws of the networks in which the medians rise in this order.

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
    rng = np.random.default_rng(0)
    drawn = {
        width: np.median(e[rng.integers(0, e.size, (2000, e.size))], -1)
        for width, e in errors.items()
    }
    ranks = [[drawn[w] for w in np.atleast_1d(level)] for level in order]
    holds = np.ones(2000, bool)
    for low, high in itertools.pairwise(ranks):
        holds &= np.max(low, 0) < np.min(high, 0)
    return Measured(
        float(holds.mean()), f"medians {_medians(errors)}; in {100 * holds.mean():.0f} % of draws"
    )


def worse_on_test(setup: str = STATE_FEEDBACK.name) -> Measured:
    """Smallest ratio of median test to median training error over the windows."""
    training, test = _errors("training", setup), _errors("test", setup)
    ratios = [float(np.median(test[w]) / np.median(training[w])) for w in WINDOWS]
    return Measured(min(ratios), "test / training " + ", ".join(number(r, 2) for r in ratios))


def multiplications(width: int = 21) -> Measured:
    """Weights of a network times the cases of an epoch."""
    cases = len(paper.TRAINING_TRAJECTORIES) * paper.SAMPLES_PER_TRAJECTORY
    count = Weights.random(1, width)[0].count() * cases
    return Measured(float(count), f"{count:,} at window {width}")


def weights_against_nwh(width: int = 21) -> Measured:
    """Weights of the network over ``n w h`` for two joints and ten hidden units."""
    network = Weights.random(1, width)[0]
    product = 2 * width * paper.HIDDEN_UNITS
    return Measured(
        network.count() / product, f"{network.count()} weights, n w h = {product} at window {width}"
    )


def largest_weight(width: int) -> Measured:
    """Magnitude of the largest weight, the median over all networks."""
    largest = _cells()[width]["largest weight"]
    return Measured(float(np.median(largest)), spread(largest, 3))


def slope() -> Measured:
    """Largest median steepness of the error at the end of training, over the windows."""
    slopes = {w: float(np.median(np.abs(cell["slope"]))) for w, cell in _cells().items()}
    text = ", ".join(number(s, 2) for s in slopes.values())
    return Measured(max(slopes.values()), f"d ln(error) / d ln(epoch) {text}")


def best_window() -> Measured:
    """Window with the lowest median test error, over sizes from 3 to 81."""
    rows = results.read("window-sizes")["rows"]
    medians = {row["width"]: float(np.median(row["test"])) for row in rows}
    best = min(medians, key=medians.get)
    return Measured(float(best), f"{best} samples ({number(medians[best], 2)})")


def training_error_falls() -> Measured:
    """Share of steps to the next larger window at which the median training error falls."""
    rows = results.read("window-sizes")["rows"]
    medians = [np.median(row["training"]) for row in rows]
    falls = np.diff(medians) < 0
    return Measured(
        float(falls.mean()), f"{falls.sum()} of {falls.size} steps from 3 to 81 samples"
    )


def memory(width: int) -> Measured:
    """Training error on shuffled torques: what falls below 1 was memorised."""
    rows = {row["width"]: row for row in results.read("memory")["rows"]}
    errors = rows[width]["training"]
    return Measured(float(np.median(errors)), spread(errors, 3))
