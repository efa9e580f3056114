"""Albus's CMAC: a table in several overlapping layers, hashed, trained by the delta rule."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.linalg import solve_triangular

from beyond.rivals.tables import Bounded

_BLOCK = 300  # cases whose updates are solved at once, by one triangular system
_WORSE = 1e3  # a training error that has grown this many times has diverged


class Diverged(RuntimeError):
    """The delta rule ran away; the error before each pass is kept in `CMAC.history`."""


class CMAC(Bounded):
    """A cerebellar model articulation controller (Albus 1975; Miller, Glanz & Kraft 1987).

    Each of `layers` layers cuts the box of states into cubes of the same width, and each is
    shifted against the one before by an equal part of that width along all axes. So a state lies
    in one cube of every layer, and its torque is the sum of their weights. A near state shares
    most of the cubes: that is how it generalises.

    The delta rule takes the cases in their order, again and again, and adds
    ``rate * (torque - sum) / layers`` to every weight of the sum. With weights `slots` fewer than
    cubes, cubes get their weight by a hash of their number, and some share one: they collide.
    An update is a step of Kaczmarz's method: it lands nearer to every solution as long as
    ``rate * overlap < 2``, and else `fit` may raise `Diverged`.
    """

    def __init__(
        self,
        layers: int = 32,  # C of the papers: cubes that a state lies in
        width: float = 0.5,  # edge of a cube as a share of the box's: how far it generalises
        slots: int | None = None,  # weights for each joint; default: one for each visited cube
        rate: float = 1.0,  # beta of the papers
        epochs: int = 100,  # passes through the cases
        limits=None,  # of the box, as in `_Bounded`
        beyond: str = "refuse",  # or "edge"
    ):
        super().__init__(limits, beyond)
        self.layers, self.width, self.slots = layers, width, slots
        self.rate, self.epochs = rate, epochs

    def _fit(self, x, torque):
        cubes = self._cubes(self._bound(x))
        self.known = np.unique(cubes)
        rows = self._rows(cubes)
        visited = self.known
        slot = np.arange(len(visited)) if self.slots is None else _hashed(visited, self.slots)
        _, where, users = np.unique(slot, return_inverse=True, return_counts=True)
        self.visited, self.occupied = len(visited), len(users)  # cubes, and weights that are theirs
        self.sharing = float((users[where] > 1).mean())  # of the visited cubes
        # largest squared length of a case's row: 1 if all its cubes have weights of their own
        self.overlap = float(rows.power(2).sum(1).max() / self.layers)
        self.weights = np.zeros((rows.shape[1], torque.shape[1]))
        self.history = []  # error in deviations of the torque, before training and after each pass
        self._train(rows, torque)

    @np.errstate(over="ignore", invalid="ignore")  # divergence is told below
    def _train(self, rows, torque):
        # In a block of rows A, let L be what is below the diagonal of A A' and r the errors before
        # it: then (layers / rate + L) d = r gives the sum of its updates, A' d, exactly.
        blocks = []
        for start in range(0, len(torque), _BLOCK):
            a, y = rows[start : start + _BLOCK], torque[start : start + _BLOCK]
            gram = np.tril((a @ a.T).toarray(), -1)
            gram[np.diag_indices_from(gram)] = self.layers / self.rate
            blocks.append((a, a.T.tocsr(), gram, y))
        deviation = torque.std(0)
        deviation = np.where(deviation > 0, deviation, 1.0)
        for epoch in range(self.epochs + 1):
            self.history.append(_error(rows @ self.weights - torque, deviation))
            if not self.history[-1] < _WORSE * self.history[0] + 1e-300:
                raise Diverged(
                    f"{self!r} diverges: after {epoch} passes the error is {self.history[-1]:.3g} "
                    f"deviations of the torque; rate x overlap is {self.rate * self.overlap:.3g}, "
                    f"which must be below 2: take more slots than {self.slots} or a lower rate"
                )
            if epoch < self.epochs:
                for a, transposed, gram, y in blocks:
                    change = solve_triangular(
                        gram, y - a @ self.weights, lower=True, check_finite=False
                    )
                    self.weights += transposed @ change

    def _torque(self, x):
        return self._rows(self._cubes(self._scaled(x))) @ self.weights

    def _cubes(self, u) -> np.ndarray:
        """Numbers of the cubes that states lie in, shape (cases, layers); u from 0 to 1."""
        u = u.reshape(len(u), -1)
        edge = int(np.ceil(1 / self.width - 1e-9)) + 1
        shift = np.arange(self.layers) / self.layers
        place = np.floor(u[:, None] / self.width + shift[:, None]).astype(np.int64)
        number = np.broadcast_to(np.arange(self.layers), place.shape[:2]).copy()
        for k in range(u.shape[1]):
            number = number * edge + np.minimum(place[..., k], edge - 1)
        return number

    def _rows(self, cubes) -> sparse.csr_array:
        """How often a state adds each weight, shape (cases, weights)."""
        cases = np.repeat(np.arange(len(cubes)), self.layers)
        if self.slots is None:
            place = np.minimum(np.searchsorted(self.known, cubes), len(self.known) - 1).ravel()
            ones = (self.known[place] == cubes.ravel()).astype(float)
            size = len(self.known)
        else:
            place, size = _hashed(cubes.ravel(), self.slots), self.slots
            ones = np.ones(place.size)
        return sparse.csr_array((ones, (cases, place)), shape=(len(cubes), size))

    def count(self):
        """Numbers kept."""
        addresses = len(self.known) if self.slots is None else 0
        return self.weights.size + addresses + self.low.size + self.high.size


def _error(left, deviation) -> float:
    """Root mean square of what is left, in deviations; infinite if it is no number."""
    error = np.sqrt(np.mean((left / deviation) ** 2))
    return float(error) if np.isfinite(error) else np.inf


def _hashed(numbers, slots: int) -> np.ndarray:
    """Slots of whole numbers by the finaliser of SplitMix64 (Steele, Lea & Flood 2014)."""
    mixed = np.asarray(numbers, dtype=np.uint64) + np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        mixed = (mixed ^ (mixed >> np.uint64(shift))) * np.uint64(factor)
    mixed ^= mixed >> np.uint64(31)
    return (mixed % np.uint64(slots)).astype(np.int64)
