"""Rivals on somebody else's data: characters drawn by an arm with gravity, with a published table.

Errors and a predictor's parts are those of the public code: squared errors of both joints summed.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from beyond.others import Characters, read_characters as data
from beyond.rivals.bases import Fourier, Polynomial
from beyond.rivals.cmac import CMAC
from beyond.rivals.gaussian import GaussianProcess, RandomFeatures
from beyond.rivals.identified import Identified, Linear
from beyond.rivals.lagrangian import AS_PUBLISHED, LagrangianNetwork
from beyond.rivals.networks import ByAdam, BySolver
from beyond.rivals.protocol import Cases, Rival
from beyond.rivals.tables import CellTable, Nearest
from ddlib.dynamics import Arm
from ddlib.identification import GRAVITY, RIGID
from workshop.report.code_hash import study

SPLITS = {"loader": ("e", "q", "v"), "figure": ("a", "d", "e")}  # characters of the test

# Errors in the README of the public code; two of them are the same number.
_PUBLISHED = {"torque": 4.327e-4, "inertial": 7.338e-4, "coriolis": 2.227e-4, "gravity": 7.338e-4}

# The arm that drew; its first angle counts from hanging down.
ARM = Arm("characters", 1.3727291666666667, 0.5, 0.5176145833333333, (1.0, 1.0), (2.625, 1.5))
SEEDS = 5  # of what starts at random
_MARKS = (50, 100, 200, 500, 1000, 1500)  # epochs of tests; the public code takes 10,000
_STARTS = 200  # initial weights asked whether all of the mass matrix can be learnt


class _Entry(NamedTuple):
    """How a rival is made from a seed, and whether the seed matters."""

    make: Callable[[int], Rival]
    random: bool = False


# Rivals with settings near those that their modules give; none was fitted to the test.
_ENTRIES = {
    "equations, identified": _Entry(lambda _: Identified(RIGID + GRAVITY)),
    "Lagrangian network": _Entry(lambda k: LagrangianNetwork(epochs=100, finish=150, seed=k), True),
    "Gaussian process": _Entry(lambda k: GaussianProcess("states", restarts=0, seed=k), True),
    "random features": _Entry(lambda k: RandomFeatures("states", seed=k), True),
    "network, by solver": _Entry(lambda k: BySolver(kind="states", steps=40, seed=k), True),
    "network, by Adam": _Entry(lambda k: ByAdam(kind="states", epochs=1000, seed=k), True),
    "polynomial": _Entry(lambda _: Polynomial(4, ridge=1e-6)),
    "Fourier series": _Entry(lambda _: Fourier(3, ridge=1e-6)),
    "CMAC": _Entry(lambda _: CMAC(beyond="edge")),
    "table of states": _Entry(lambda _: CellTable(beyond="edge")),
    "table of configurations": _Entry(lambda _: CellTable(over="configurations", beyond="edge")),
    "nearest case": _Entry(lambda _: Nearest(beyond="edge")),
    "linear": _Entry(lambda _: Linear("states")),
}


def states(drawn: Characters, turned: float = np.pi / 2) -> Cases:
    """States and torques of characters, the first angle turned to count from hanging down."""
    q = drawn.q + np.array([turned, 0.0])
    return Cases(np.stack([q, drawn.qd, drawn.qdd], -1), drawn.tau, "states", drawn.STEP)


def _parts(torque: Callable, x) -> dict[str, np.ndarray]:
    """Torque, its parts (N m) and mass matrix (kg m^2) that a predictor gives for states."""
    rest, moving, pushed = x.copy(), x.copy(), x.copy()
    rest[..., 1:], moving[..., 2], pushed[..., 1] = 0.0, 0.0, 0.0
    gravity = torque(rest)
    columns = []
    for j in range(x.shape[1]):
        unit = rest.copy()
        unit[:, j, 2] = 1.0
        columns.append(torque(unit) - gravity)
    return {
        "torque": torque(x),
        "inertial": torque(pushed) - gravity,
        "coriolis": torque(moving) - gravity,
        "gravity": gravity,
        "mass_matrix": np.stack(columns, -1),
    }


def _errors(found: dict, drawn: Characters) -> dict[str, float]:
    """Errors as in the public code; that of the mass matrix is relative (root mean square)."""
    truth = {"torque": drawn.tau, "mass_matrix": drawn.mass_matrix}
    result = {}
    for name, value in found.items():
        wanted = truth.get(name, getattr(drawn, name, None))
        squared = (value - wanted) ** 2
        result[name] = float(squared.sum(-1).mean())
        if name == "mass_matrix":
            result[name] = float(np.sqrt(squared.mean() / (wanted**2).mean()))
    return result


def _exact(x) -> np.ndarray:
    return ARM.inverse_dynamics(*np.moveaxis(x, -1, 0))


def _hurried(torque: Callable, x) -> float:
    """RMS error of both joints at twice the speed, over the deviation of these torques."""
    fast = x * [1.0, 2.0, 4.0]
    truth = _exact(fast)
    return float(np.sqrt(((torque(fast) - truth) ** 2).sum(-1).mean() / truth.var(0).sum()))


def tested(torque: Callable, drawn: Characters) -> dict:
    """Errors of a predictor on characters, also when they are drawn faster."""
    x = states(drawn).x
    return {**_errors(_parts(torque, x), drawn), "hurried": _hurried(torque, x)}


def _entry(entry: _Entry, split) -> dict:
    training, test = data().split(split)
    row: dict = {"test": [], "training": []}
    for seed in range(SEEDS if entry.random else 1):
        rival = entry.make(seed).fit(states(training))
        row["test"].append(tested(rival._torque, test))
        row["training"].append(tested(rival._torque, training)["torque"])
    return row | {"count": rival.count()}


def _dead(rival: LagrangianNetwork, q) -> list[bool]:
    """For each joint, whether its entry on L's diagonal is the floor at every position."""
    lower = rival.triangle(q)
    return [not lower[..., j, j].any() for j in range(lower.shape[-1])]


def _as_published() -> dict:
    """Networks with the public code's settings: their errors on the way, and dead joints."""
    training, test = data().split()
    cases, asked = states(training, 0.0), states(test, 0.0).x

    def untrained(seed):
        return LagrangianNetwork(**AS_PUBLISHED, epochs=0, seed=seed).fit(cases)

    rows = []
    for seed in range(SEEDS):
        row: dict = {"dead at start": _dead(untrained(seed), training.q), "course": []}

        def watch(epoch, rival, row=row):
            if epoch in _MARKS:
                row["course"].append(_errors(_parts(rival._torque, asked), test))

        rival = LagrangianNetwork(**AS_PUBLISHED, epochs=_MARKS[-1], seed=seed, watch=watch)
        rival.fit(cases)
        row["dead at end"] = _dead(rival, training.q)
        rows.append(row)
    starts = [any(_dead(untrained(seed), training.q)) for seed in range(_STARTS)]
    return {"marks": list(_MARKS), "networks": rows, "dead starts": starts}


@study
def _characters() -> dict:
    """Every rival on both splits; the Lagrangian network also as published, on the loader's."""
    by_split = {}
    for split, test in SPLITS.items():
        by_split[split] = {name: _entry(entry, test) for name, entry in _ENTRIES.items()}
        drawn = data().of(test)
        by_split[split]["exact equations"] = {"test": [tested(_exact, drawn)]}
        by_split[split]["variance"] = float(drawn.tau.var(0).sum())
    return {
        "splits": SPLITS,
        "published": _PUBLISHED,
        "seeds": SEEDS,
        "rivals": by_split,
        "as published": _as_published(),
    }
