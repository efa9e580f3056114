"""Table 4-1 by joint damping: which knobs decide it, and what its numbers speak for."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from ddlib import paper
from ddlib.setups import WINDOWS
from workshop.report import results
from workshop.report.knobs import _Emulator, _left_out, _shares, _spread_evenly, _weigh, knobs_of

# The six cells of Table 4-1
CELLS = tuple((column, width) for column in ("training", "test") for width in WINDOWS)

# The largest weights that Figures 5-1 to 5-3 print
WEIGHTS = tuple(("largest weight", width) for width in WINDOWS)


def printed(wanted=CELLS) -> np.ndarray:
    """Logarithms of printed numbers, as `CELLS` and `WEIGHTS` name them."""
    tables = {"largest weight": paper.LARGEST_WEIGHT}
    for column in ("training", "test"):
        tables[column] = {w: getattr(row, column) for w, row in paper.TABLE_4_1.items()}
    return np.log([tables[column][width] for column, width in wanted])


class _Screen(NamedTuple):
    """What the design says of the six cells."""

    names: tuple[str, ...]  # of the knobs
    places: np.ndarray  # (runs, knobs)
    values: np.ndarray  # logarithms of errors, (runs, networks, cells)
    covariance: np.ndarray  # of one network on one recording around the mean of its run
    emulators: tuple[_Emulator, ...]
    scores: np.ndarray  # each run less what the others predict, in deviations, (cells, runs)

    def predict(self, places) -> tuple[np.ndarray, np.ndarray]:
        """Means and their variances at some places, ``(places, cells)``."""
        pairs = [emulator.predict(places) for emulator in self.emulators]
        wider = np.maximum(1.0, (self.scores**2).mean(1))
        return np.stack([m for m, _ in pairs], -1), np.stack([v for _, v in pairs], -1) * wider


def _screen_of(places, values, names) -> _Screen:
    """Emulators of some cells."""
    places, values = np.asarray(places, dtype=float), np.asarray(values, dtype=float)
    runs, networks, cells = values.shape
    means = values.mean(1)
    apart = (values - means[:, None]).reshape(-1, cells)
    covariance = apart.T @ apart / (runs * (networks - 1))
    variances = np.diag(covariance) / networks
    emulators = [_Emulator.fit(places, means[:, k], variances[k]) for k in range(cells)]
    scores = [_left_out(places, means[:, k], variances[k]) for k in range(cells)]
    return _Screen(tuple(names), places, values, covariance, tuple(emulators), np.array(scores))


def logarithms(method: str, wanted=CELLS) -> np.ndarray:
    """Logarithms of what the design's runs gave, ``(runs, networks, wanted)``."""
    rows = results.read("screened")["methods"][method]
    found = [[row["windows"][str(w)][column] for column, w in wanted] for row in rows]
    return np.log(found).transpose(0, 2, 1)


@cache
def screen(method: str, wanted=CELLS) -> _Screen:
    """The emulators of some numbers by a method, from the committed design."""
    rows = results.read("screened")["methods"][method]
    return _screen_of([row["places"] for row in rows], logarithms(method, wanted), knobs_of(method))


def knob_shares(method: str, column: str, draws: int = 200) -> dict[str, tuple]:
    """Share of the variance that each knob makes in a column of Table 4-1 (training, test).

    Products with others included, a mean over three windows; 10 %, 50 % and 90 % of the draws.
    """
    here = screen(method)
    total = [
        _shares(emulator.draws(draws, seed=k), len(here.names))[:, 1]
        for k, (emulator, cell) in enumerate(zip(here.emulators, CELLS))
        if cell[0] == column
    ]
    levels = np.quantile(np.mean(total, 0), (0.1, 0.5, 0.9), axis=0)
    return dict(zip(here.names, map(tuple, levels.T)))


class _Posterior(NamedTuple):
    """Places of the knobs, spread evenly, and what the printed numbers make of them."""

    places: np.ndarray  # (places, knobs)
    weights: np.ndarray
    evidence: float  # logarithm of the mean likelihood

    @property
    def effective(self) -> float:
        """How many places of equal weight would count as much."""
        return float(1 / (self.weights**2).sum())

    def quantiles(self, levels=(0.1, 0.5, 0.9)) -> np.ndarray:
        """Places below which some share of the weight lies, ``(levels, knobs)``."""
        order = np.argsort(self.places, axis=0)
        total = np.cumsum(self.weights[order], axis=0)
        placed = np.take_along_axis(self.places, order, 0)
        at = [(total < level).sum(0).clip(max=len(placed) - 1) for level in levels]
        return np.array([placed[k, np.arange(placed.shape[1])] for k in at])


@cache
def posterior(method: str, wanted=CELLS, count: int = 2**14) -> _Posterior:
    """Posterior of the knobs of a method, given printed numbers; default: the six errors.

    One network on one recording was printed, so an observation scatters as ours do.
    """
    here = screen(method, wanted)
    places = _spread_evenly(count, len(here.names))
    weights, evidence = _weigh(*here.predict(places), here.covariance, printed(wanted))
    return _Posterior(places, weights, evidence)
