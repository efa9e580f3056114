"""Section 4 and Table 4-1: window networks on the six recordings, from ``book/results``."""

from __future__ import annotations

import itertools

import numpy as np

from ddlib import paper
from ddlib.evidence.verdicts import Measured, median, over_members
from ddlib.experiments import STATE_FEEDBACK, WINDOWS, results
from ddlib.learning import Weights
from ddlib.tables import number, spread


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

    ratios = [number(np.median(test) / np.median(training), 2) for training, test in cells]
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
    text = ", ".join(number(np.median(s), 2) for s in slopes)
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
    least = number(np.median(sizes[int(value)]), 2)
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
