"""Who takes part in the study of rivals, at which sizes; a new rival is a line here."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from beyond.rivals.bases import Polynomial, _Fourier
from beyond.rivals.cmac import CMAC
from beyond.rivals.gaussian import GaussianProcess, _RandomFeatures, _SemiParametric
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.lagrangian import LagrangianNetwork
from beyond.rivals.networks import BySolver, _ByAdam, _ByDescent, _Convolution, _Recurrent
from beyond.rivals.protocol import Rival
from beyond.rivals.tables import CellTable, GridTable, _Nearest
from ddlib.identification import FRICTION, RIGID
from ddlib.setups import INITIAL, JOINT_DAMPING, STATE_FEEDBACK

_DAYS, _FEWER = 8, 5  # recordings of a rival, and of one that takes seconds to train


class _Line(NamedTuple):
    """A rival at several sizes."""

    make: Callable[[object, int], Rival]  # of a size and a seed
    sizes: tuple  # from few to many stored numbers
    varied: str
    family: str  # panel of the figures
    days: int = _DAYS


_REFERENCE = "network of 1988"  # ten hidden units, by descent
_PENALTY = 1e-4  # the one that leaving out trajectories chooses in `rivals_1988`


def _descent(hidden, seed, **options):
    """As `STATE_FEEDBACK` is trained: the book's reading of 1988."""
    here = STATE_FEEDBACK
    options = {"epochs": here.epochs, "rate": here.rate / 21, "initial": INITIAL, **options}
    return _ByDescent(hidden, momentum=here.momentum, warm_up=here.warm_up, seed=seed, **options)


def _solver(hidden, seed, **options):
    """As `JOINT_DAMPING` is trained: what reaches Table 4-1."""
    here = JOINT_DAMPING
    options = {"steps": here.steps, "decay": here.decay, "initial": INITIAL, **options}
    return BySolver(hidden, seed=seed, **options)


def _identified(count, _seed):
    return Identified((RIGID + FRICTION)[:3] if count == 3 else RIGID + FRICTION)


def _lagrangian(units, seed):
    return LagrangianNetwork((units, units), gravity="none", friction=True, epochs=150, seed=seed)


_SEARCH = {"subset": 150, "restarts": 0}  # cases for hyperparameters, further searches


def _table(over):
    return lambda cells, _: CellTable(cells, over, beyond="edge")


_LINES: dict[str, _Line] = {
    # tables
    "nearest case": _Line(lambda *_: _Nearest(beyond="edge"), (1,), "cases", "tables"),
    "table of states": _Line(_table("states"), (3, 10, 40), "cells an axis", "tables"),
    "table of configurations": _Line(
        _table("configurations"), (1, 2, 3, 10), "cells an axis", "tables"
    ),
    "multilinear table": _Line(
        lambda cells, _: GridTable(cells, beyond="edge"), (1, 2), "cells an axis", "tables"
    ),
    "CMAC": _Line(
        lambda width, _: CMAC(width=width, beyond="edge"), (1.0, 0.7, 0.3), "width of a cube",
        "tables",
    ),
    # bases
    "polynomial": _Line(
        lambda degree, _: Polynomial(degree, ridge=_PENALTY), (1, 2, 3, 5), "degree", "polynomials"
    ),
    "Fourier series": _Line(
        lambda order, _: _Fourier(order, ridge=_PENALTY), (1, 2), "order", "polynomials"
    ),
    # known structure
    "identified": _Line(_identified, (3, 7), "parameters", "known structure"),
    "linear filter": _Line(
        lambda width, _: Linear(width=width), (5, 11, 21), "samples", "known structure"
    ),
    "Lagrangian network": _Line(_lagrangian, (8, 16), "units a layer", "known structure", _FEWER),
    # Gaussian processes
    "Gaussian process": _Line(
        lambda directions, seed: GaussianProcess(directions=directions, seed=seed, **_SEARCH),
        (6, 9, 12), "directions", "Gaussian processes", _FEWER,
    ),
    "process on states": _Line(
        lambda _, seed: GaussianProcess("states", seed=seed, **_SEARCH), (6,), "quantities",
        "Gaussian processes", _FEWER,
    ),
    "structure and process": _Line(
        lambda _, seed: _SemiParametric(RIGID + FRICTION, seed=seed, **_SEARCH), (6,),
        "quantities", "Gaussian processes", _FEWER,
    ),
    "random features": _Line(
        lambda features, seed: _RandomFeatures(features=features, directions=9, seed=seed),
        (10, 50, 200), "features", "Gaussian processes", _FEWER,
    ),
    # the paper's network
    _REFERENCE: _Line(_descent, (2, 10), "hidden units", "the paper's network"),
    "second-order steps": _Line(_solver, (1, 2, 5, 10), "hidden units", "the paper's network"),
    "Adam": _Line(
        lambda hidden, seed: _ByAdam(hidden, seed=seed), (2, 10), "hidden units",
        "the paper's network", _FEWER,
    ),
    "on states": _Line(
        lambda hidden, seed: _solver(hidden, seed, kind="states"), (2, 5, 10),
        "hidden units", "the paper's network",
    ),
    # other networks
    "convolutions": _Line(
        lambda channels, seed: _Convolution(channels, seed=seed), (4, 6, 12), "channels",
        "other networks", _FEWER,
    ),
    "recurrent": _Line(
        lambda units, seed: _Recurrent(units, 40, seed=seed), (5, 10), "units", "other networks",
        _FEWER,
    ),
}  # fmt: skip
