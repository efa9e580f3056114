"""Who takes part in the study of rivals, at which sizes; a new rival is a line here."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from beyond.rivals.bases import Fourier, Polynomial
from beyond.rivals.cmac import CMAC
from beyond.rivals.gaussian import GaussianProcess, RandomFeatures, SemiParametric
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.lagrangian import LagrangianNetwork
from beyond.rivals.networks import ByAdam, ByDescent, BySolver, Convolution, Recurrent
from beyond.rivals.protocol import Rival
from beyond.rivals.tables import CellTable, GridTable, Nearest
from ddlib.identification import FRICTION, RIGID
from ddlib.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK

_DAYS, _FEWER = 8, 5  # recordings of a rival, and of one that takes seconds to train


class _Line(NamedTuple):
    """A rival at several sizes."""

    make: Callable[[object, int], Rival]  # of a size and a seed
    sizes: tuple  # from few to many stored numbers
    days: int = _DAYS


REFERENCE = "network of 1988"  # ten hidden units, by descent
_PENALTY = 1e-4  # the one that leaving out trajectories chooses in `rivals_1988`


def by_descent(hidden, seed, **options):
    """As `STATE_FEEDBACK` is trained: the book's reading of 1988."""
    here = STATE_FEEDBACK
    options = {"epochs": here.epochs, "rate": here.rate / 21, "initial": INITIAL, **options}
    return ByDescent(hidden, momentum=here.momentum, warm_up=here.warm_up, seed=seed, **options)


def by_solver(hidden, seed, **options):
    """As `JOINT_DAMPING` is trained: what reaches Table 4-1."""
    here = JOINT_DAMPING
    options = {"steps": here.steps, "decay": here.decay, "initial": INITIAL, **options}
    return BySolver(hidden, seed=seed, **options)


def identified(count, _seed):
    """The arm's equations with three parameters, or with friction."""
    return Identified((RIGID + FRICTION)[:3] if count == 3 else RIGID + FRICTION)


def lagrangian(units, seed):
    """A Lagrangian network with two layers of so many units."""
    return LagrangianNetwork((units, units), gravity="none", friction=True, epochs=150, seed=seed)


GAUSSIAN_SEARCH = {"subset": 150, "restarts": 0}  # cases for hyperparameters, further searches


def _table(over):
    return lambda cells, _: CellTable(cells, over, beyond="edge")


LINES: dict[str, _Line] = {
    # tables
    "nearest case": _Line(lambda *_: Nearest(beyond="edge"), (1,)),
    "table of states": _Line(_table("states"), (3, 10, 40)),
    "table of configurations": _Line(_table("configurations"), (1, 2, 3, 10)),
    "multilinear table": _Line(lambda cells, _: GridTable(cells, beyond="edge"), (1, 2)),
    "CMAC": _Line(lambda width, _: CMAC(width=width, beyond="edge"), (1.0, 0.7, 0.3)),
    # bases
    "polynomial": _Line(lambda degree, _: Polynomial(degree, ridge=_PENALTY), (1, 2, 3, 5)),
    "Fourier series": _Line(lambda order, _: Fourier(order, ridge=_PENALTY), (1, 2)),
    # known structure
    "identified": _Line(identified, (3, 7)),
    "linear filter": _Line(lambda width, _: Linear(width=width), (5, 11, 21)),
    "Lagrangian network": _Line(lagrangian, (8, 16), _FEWER),
    # Gaussian processes
    "Gaussian process": _Line(
        lambda directions, seed: GaussianProcess(
            directions=directions, seed=seed, **GAUSSIAN_SEARCH
        ),
        (6, 9, 12),
        _FEWER,
    ),
    "process on states": _Line(
        lambda _, seed: GaussianProcess("states", seed=seed, **GAUSSIAN_SEARCH), (6,), _FEWER
    ),
    "structure and process": _Line(
        lambda _, seed: SemiParametric(RIGID + FRICTION, seed=seed, **GAUSSIAN_SEARCH), (6,), _FEWER
    ),
    "random features": _Line(
        lambda features, seed: RandomFeatures(features=features, directions=9, seed=seed),
        (10, 50, 200),
        _FEWER,
    ),
    # the paper's network
    REFERENCE: _Line(by_descent, (2, 10)),
    "second-order steps": _Line(by_solver, (1, 2, 5, 10)),
    "Adam": _Line(lambda hidden, seed: ByAdam(hidden, seed=seed), (2, 10), _FEWER),
    "on states": _Line(lambda hidden, seed: by_solver(hidden, seed, kind="states"), (2, 5, 10)),
    # other networks
    "convolutions": _Line(
        lambda channels, seed: Convolution(channels, seed=seed), (4, 6, 12), _FEWER
    ),
    "recurrent": _Line(lambda units, seed: Recurrent(units, 40, seed=seed), (5, 10), _FEWER),
}
