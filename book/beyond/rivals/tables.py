"""Tables of torques: by cell, by nearest sample, multilinear; over states or configurations."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial import cKDTree

from beyond.rivals.protocol import OUTSIDE_MARGIN, Rival
from ddlib.identification import SIGN_SPEED

_OVER = {"states": 3, "motions": 2, "configurations": 1}  # quantities of a joint that are axes
_QUANTITIES = (("position", "rad"), ("velocity", "rad/s"), ("acceleration", "rad/s^2"))


class _TableSize(NamedTuple):
    """What a full table takes: its cells, the numbers in them, and bytes."""

    cells: int
    numbers: int
    bytes: int


def table_size(
    cells: int,  # of each axis
    axes: int = 6,  # for the states of two joints
    numbers: int = 2,  # kept in a cell: two torques
    width: int = 4,  # bytes of a number
) -> _TableSize:
    """Cells and memory of a table with every cell."""
    all_cells = int(cells) ** axes
    return _TableSize(all_cells, all_cells * numbers, all_cells * numbers * width)


def _cube_corners(u, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes around points ``(points, axes)`` of the unit cube, and their multilinear weights."""
    low = np.clip(np.floor(u * cells).astype(int), 0, cells - 1)
    part = u * cells - low
    nodes, weights = np.zeros((len(u), 1, 0), dtype=int), np.ones((len(u), 1))
    for k in range(u.shape[1]):
        both = np.stack([low[:, k], low[:, k] + 1], -1)
        share = np.stack([1 - part[:, k], part[:, k]], -1)
        corners = weights.shape[1]
        nodes = np.concatenate(
            [np.repeat(nodes, 2, 1), np.tile(both, corners)[..., None]], -1
        )  # the last axis changes fastest
        weights = (weights[..., None] * share[:, None]).reshape(len(u), -1)
    return nodes, weights


def full_table(
    function: Callable, x, limits, cells: int, *, interpolated: bool = True
) -> np.ndarray:
    """What a table would answer that has the right torque in every cell, shape (cases, joint)."""
    low, high = limits
    u = _inside(x, low, high, "refuse").reshape(len(x), -1)
    size = (high - low).ravel()
    if not interpolated:
        middle = (np.clip(np.floor(u * cells), 0, cells - 1) + 0.5) / cells
        return function((middle * size + low.ravel()).reshape(x.shape))
    answers = []
    for block in np.array_split(u, max(1, len(u) // 1000)):
        nodes, weights = _cube_corners(block, cells)
        states = (nodes / cells * size + low.ravel()).reshape(-1, *x.shape[1:])
        values = function(states).reshape(*weights.shape, -1)
        answers.append(np.einsum("nc,ncj->nj", weights, values))
    return np.concatenate(answers)


class Bounded(Rival):
    """A rival with room for a box of states alone; one outside is refused, or taken to the edge."""

    def __init__(self, limits=None, beyond: str = "refuse"):
        self.limits, self.beyond = limits, beyond

    def _bound(self, x) -> np.ndarray:
        """The box, decided by training states; they in units of it."""
        if self.limits is None:
            low, high = x.min(0), x.max(0)
            slack = np.where(high > low, OUTSIDE_MARGIN * (high - low), 0.5)
            self.low, self.high = low - slack, high + slack
        else:
            self.low, self.high = self.limits
        return self._scaled(x)

    def _scaled(self, x) -> np.ndarray:
        """States in units of the box, shape (cases, joint, 3): 0 to 1."""
        return _inside(x, self.low, self.high, self.beyond)


def _inside(x, low, high, beyond) -> np.ndarray:
    u = (x - low) / (high - low)
    out = (u < -1e-9) | (u > 1 + 1e-9)
    if beyond == "refuse" and out.any():
        case, joint, which = np.argwhere(out)[0]
        name, unit = _QUANTITIES[which]
        raise ValueError(
            f"x must lie in the table: {name} of joint {joint} from {low[joint, which]:.4g} to "
            f"{high[joint, which]:.4g} {unit}, got {x[case, joint, which]:.4g} "
            f"({out.any((1, 2)).sum()} of {len(x)} states lie outside)"
        )
    return np.clip(u, 0.0, 1.0)


class Nearest(Bounded):
    """All training cases are kept; the torque is that of the nearest, in deviations."""

    def _fit(self, x, torque):
        self._bound(x)
        self.deviation = np.where(x.std(0) > 0, x.std(0), 1.0)
        self._tree = cKDTree((x / self.deviation).reshape(len(x), -1))
        self._torques = torque

    def _torque(self, x):
        x = self.low + self._scaled(x) * (self.high - self.low)
        return self._torques[self._tree.query((x / self.deviation).reshape(len(x), -1))[1]]

    def count(self):
        """Stored numbers: all cases, their torques, and the deviations."""
        return self._tree.data.size + self._torques.size + self.deviation.size


class LocalPlanes(Nearest):
    """All training cases are kept; a plane through the nearest ones gives the torque.

    Atkeson, Moore & Schaal (1997), with neighbours in place of a kernel. Beyond the recorded
    states the plane goes on.
    """

    def __init__(self, neighbours: int = 60):
        super().__init__()
        self.neighbours = neighbours

    def _torque(self, x):
        asked = (x / self.deviation).reshape(len(x), -1)
        near = self._tree.query(asked, self.neighbours)[1]
        away = self._tree.data[near] - asked[:, None]
        rows = np.concatenate([np.ones_like(away[..., :1]), away], -1)
        square = np.swapaxes(rows, 1, 2) @ rows
        square += 1e-6 * self.neighbours * np.eye(square.shape[-1])
        return np.linalg.solve(square, np.swapaxes(rows, 1, 2) @ self._torques[near])[:, 0]


class CellTable(Bounded):
    """Cells over states, motions or configurations; the torque is linear in what remains.

    In a cell of states it is the mean of what was recorded there. Over motions, positions and
    velocities, it is ``c + J q''``. Over configurations (Raibert & Horn 1978) it is a constant, a
    sum over accelerations, and one over products of velocities: inertia, Coriolis and gravity as
    numbers for each cell. The numbers are fitted to the cases of the cell by least squares. A
    cell in which nothing was recorded answers with the numbers of the nearest one, counted in
    cells, that has some.
    """

    def __init__(
        self,
        cells: int = 10,  # of each axis
        over: str = "states",  # or "motions" or "configurations": what the axes are
        friction: bool = True,  # over configurations: torque is linear in velocities and signs, too
        ridge: float = 0.1,  # penalty on squared coefficients: so many cases that say zero
        limits=None,  # as in `Bounded`
        beyond: str = "refuse",  # or "edge"
    ):
        super().__init__(limits, beyond)
        self.cells, self.over, self.friction, self.ridge = cells, over, friction, ridge

    def _fit(self, x, torque):
        place = self._places(self._bound(x))
        self.filled, which = np.unique(place, axis=0, return_inverse=True)
        self._tree, which = cKDTree(self.filled), which.ravel()
        columns = self._columns(x)
        shape = (len(self.filled), columns.shape[1])
        squares, products = np.zeros((*shape, shape[1])), np.zeros((*shape, torque.shape[1]))
        np.add.at(squares, which, columns[..., None] * columns[:, None])
        np.add.at(products, which, columns[..., None] * torque[:, None])
        size = (columns**2).mean(0)
        if self.over == "states":
            size[:] = 0.0  # a mean of one case or more needs no penalty
        squares += self.ridge * np.diag(np.where(size > 0, size, float(self.over != "states")))
        self.coefficients = np.linalg.solve(squares, products)

    def _torque(self, x):
        nearest = self._tree.query(self._places(self._scaled(x)))[1]
        return np.einsum("np,npj->nj", self._columns(x), self.coefficients[nearest])

    def _places(self, u) -> np.ndarray:
        u = u[..., : _OVER[self.over]].reshape(len(u), -1)
        return np.minimum((u * self.cells).astype(int), self.cells - 1)

    def _columns(self, x) -> np.ndarray:
        """What the torque is linear in, shape (cases, coefficients)."""
        velocity, acceleration, one = x[..., 1], x[..., 2], np.ones((len(x), 1))
        if self.over == "states":
            return one
        if self.over == "motions":
            return np.concatenate([one, acceleration], 1)
        first, second = np.triu_indices(x.shape[1])
        parts = [one, acceleration, velocity[:, first] * velocity[:, second]]
        if self.friction:
            parts += [velocity, np.clip(velocity / SIGN_SPEED, -1.0, 1.0)]
        return np.concatenate(parts, 1)

    def empty(self, x) -> np.ndarray:
        """Whether nothing was recorded in the cells of states ``(cases, joint, 3)``."""
        return self._tree.query(self._places(self._scaled(x)))[0] > 0

    def count(self):
        """Numbers kept."""
        return self.filled.size + self.coefficients.size + self.low.size + self.high.size


class GridTable(Bounded):
    """Torques at the nodes of a grid over states, multilinear between them.

    The nodes get the torques that fit all cases best by least squares, with a penalty on their
    distance from the mean torque: `ridge` is so many cases at each node that say it. A node next
    to which nothing was recorded has the mean.
    """

    def __init__(self, cells: int = 4, ridge: float = 1e-3, limits=None, beyond: str = "refuse"):
        super().__init__(limits, beyond)
        self.cells, self.ridge = cells, ridge

    def _fit(self, x, torque):
        index, weights = self._corners(self._bound(x))
        self.known, places = np.unique(index, return_inverse=True)
        rows = np.repeat(np.arange(len(x)), weights.shape[1])
        hats = sparse.csr_array(
            (weights.ravel(), (rows, places.ravel())), shape=(len(x), len(self.known))
        )
        gram = (hats @ hats.T).toarray()
        gram[np.diag_indices_from(gram)] += self.ridge
        self.mean = torque.mean(0)
        self.values = self.mean + hats.T @ cho_solve(cho_factor(gram), torque - self.mean)

    def _torque(self, x):
        answers = []
        for block in np.array_split(self._scaled(x), max(1, len(x) // 1000)):
            index, weights = self._corners(block)
            place = np.minimum(np.searchsorted(self.known, index), len(self.known) - 1)
            known = (self.known[place] == index)[..., None]
            values = np.where(known, self.values[place], self.mean)
            answers.append(np.einsum("nc,ncj->nj", weights, values))
        return np.concatenate(answers)

    def _corners(self, u) -> tuple[np.ndarray, np.ndarray]:
        nodes, weights = _cube_corners(u.reshape(len(u), -1), self.cells)
        shape = (self.cells + 1,) * nodes.shape[-1]
        return np.ravel_multi_index(np.moveaxis(nodes, -1, 0), shape), weights

    def count(self):
        """Numbers kept."""
        return self.known.size + self.values.size + self.mean.size + 2 * self.low.size
