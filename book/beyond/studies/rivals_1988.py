"""Section 1.1: tables, CMAC, polynomials and Fourier series on the recordings of Table 4-1."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import cache

import numpy as np

from beyond.rivals.bases import Fourier, Polynomial
from beyond.rivals.cmac import CMAC, Diverged
from beyond.rivals.identified import Identified
from beyond.rivals.protocol import Cases, Rival
from beyond.rivals.tables import CellTable, GridTable, Nearest, full_table
from beyond.studies.loop.feedforwards import exact as equations, square_extents
from beyond.studies.rivals import square_recordings
from ddlib.analysis import inside_hull
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, Setup, true_states
from ddlib.simulation import Recording
from ddlib.trajectories import OutsideFamilyWarning, random_extents
from workshop.report.code_hash import study

_DAYS = (1, 2, 3, 4, 5)
_LATER = 100  # days until the same is recorded again; twice that: to choose settings
_WIDTH = 21  # from which states are estimated: the best of Table 4-1
KINDS = ("exact", "positions only")
POINTS, _STRIDE = 9, 5  # of each joint in the square; of its samples every fifth


def _cases(setup: Setup, recording: Recording, kind: str, stride: int = 1) -> Cases:
    if kind == "exact":
        return Cases.states(recording, true_states(recording, setup))[::stride]
    return Cases.windows(recording, _WIDTH).estimated()[::stride]


@cache
def _recorded(day: int, what: str) -> Recording:
    """The six runs, the square, or the practised trajectory again and again, on some day."""
    setup = JOINT_DAMPING.repeated(day)
    if what == "square":
        return square_recordings(setup, POINTS).recording
    return setup.record(*([[PRACTISED] * REPEATED[-1]] if what == "practised" else []))


def _joined(parts: list) -> Cases:
    x, torque = (np.concatenate([getattr(p, name) for p in parts]) for name in ("x", "torque"))
    return Cases(x, torque, "states", parts[0].step)


def _day(day: int, kind: str) -> dict[str, Cases]:
    """Training cases of a day and what it is tested on."""
    today, later = (JOINT_DAMPING.repeated(d) for d in (day, day + _LATER))
    recording, motions = _recorded(day, "six"), _recorded(day, "square")
    inside = inside_hull(square_extents(POINTS))
    return {
        "training": _cases(today, recording[:5], kind),
        "again": _cases(later, _recorded(day + _LATER, "six")[:5], kind),
        "trajectory 6": _cases(today, recording[5:], kind),
        "inside": _cases(today, motions[inside], kind, _STRIDE),
        "outside": _cases(today, motions[~inside], kind, _STRIDE),
    }


def _floor(day: int) -> float:
    """Error of the noise-free torque of trajectory 6: nothing can be better."""
    run = _recorded(day, "six")[5]
    return float(rmss(run.tau_true[run.motion], run.tau[run.motion]))


def _errors(rival: Rival, sets: dict[str, Cases]) -> dict[str, float]:
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        return {name: float(rmss(rival.torque(c.x), c.torque)) for name, c in sets.items()}


def _over_days(rows: list[dict]) -> dict:
    """Numbers of several days as lists under their names."""
    return {name: [row[name] for row in rows] for name in rows[0]}


# Tables

# Of each axis.
_CELLS = {
    "states": (5, 10, 20, 40, 80),
    "motions": (2, 3, 5, 10, 20),
    "configurations": (1, 2, 3, 5, 10, 20),
    "multilinear": (1, 2, 4, 8),
}

PRACTISED = (25.0, 25.0)  # extents of the one trajectory of the map, degrees: a point of the square
PRACTICE, REPEATED = 3, (1, 3, 10)  # days of its training; how often on each
_VARIED, _PENALTY = ("states", "configurations"), 1e-4  # of a plane beside these tables
_FULL = (2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 40, 48)  # cells of an axis


def _table(over: str, cells: int) -> Rival:
    if over == "nearest":
        return Nearest(beyond="edge")
    if over == "multilinear":
        return GridTable(cells, beyond="edge")
    return CellTable(cells, over, beyond="edge")


@study
def _rivals_tables(days=_DAYS) -> dict:
    """Errors of tables on all sets and days; maps around one trajectory; full tables."""
    rows = []
    for kind in KINDS:
        sets = {day: _day(day, kind) for day in days}
        for over, cells in [("nearest", 0), *((o, n) for o, some in _CELLS.items() for n in some)]:
            by_day = []
            for day in days:
                rival = _table(over, cells).fit(sets[day]["training"])
                by_day.append(_errors(rival, sets[day]) | {"count": rival.count()})
            rows.append({"kind": kind, "over": over, "cells": cells, **_over_days(by_day)})
    return {
        "days": list(days),
        "floor": [_floor(day) for day in days],
        "rows": rows,
        "around": {kind: _around(kind, days) for kind in KINDS},
        "full": _full(),
    }


def _families() -> dict[str, list[Rival]]:
    """Who learns one trajectory, by name: some of each that differ in cells."""
    return {
        "nearest": [_table("nearest", 0)],
        **{
            over: [_table(over, cells) for cells in _CELLS[over]]
            for over in ("states", "motions", "configurations")
        },
        "one cell": [_table("configurations", 1)],
        "plane": [Polynomial(1)],
        "plane, penalty": [Polynomial(1, ridge=_PENALTY)],
        "structure": [Identified()],
    }


def _around(kind: str, days) -> dict:
    """What learnt one trajectory: its error there by repetitions, and all over the square."""
    names = (*_families(), *(f"{name}, varied" for name in _VARIED))
    by_name, floor = {name: [] for name in names}, []
    for day in days:
        numbers = [1000 * day + k for k in range(PRACTICE + 2)]
        setups = [JOINT_DAMPING.repeated(number) for number in numbers]
        runs = [_recorded(number, "practised") for number in numbers[:-1]]
        later, recording = setups[-1], _recorded(numbers[-1], "square")
        practised = practised_distance() == 0
        everywhere = _cases(later, recording, kind, _STRIDE)
        choice = _cases(setups[-2], runs[-1][0], kind)
        by_amount = [
            _joined([_cases(s, run[:n], kind) for s, run in zip(setups, runs[:-1])])
            for n in REPEATED
        ]
        drawn = setups[0].record(random_extents(REPEATED[-1] * PRACTICE, seed=day))
        varied = _cases(setups[0], drawn, kind)
        scale = by_amount[-1].torque.std(0)
        noise = (recording.tau - recording.tau_true)[practised][0, recording.motion] / scale
        floor.append(float(np.sqrt(np.mean(noise**2))))
        for name, some in _families().items():
            fitted = [rival.fit(by_amount[-1]) for rival in some]
            best = min(fitted, key=lambda rival: _errors(rival, {"choice": choice})["choice"])
            errors = _map(best, everywhere, scale)
            there = [
                _map(best.fit(training), everywhere, scale)[practised][0]
                for training in by_amount[:-1]
            ]
            by_name[name].append(
                {"there": [*there, errors[practised][0]], "errors": errors,
                 "cells": getattr(best, "cells", 0)}
            )  # fmt: skip
            if name in _VARIED:
                errors = _map(best.fit(varied), everywhere, scale)
                by_name[f"{name}, varied"].append({"errors": errors})
    return {name: _over_days(some) for name, some in by_name.items()} | {"floor": floor}


def _map(rival: Rival, everywhere: Cases, scale) -> np.ndarray:
    """Error on each trajectory of the square, shape (runs,)."""
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        residual = (rival.torque(everywhere.x) - everywhere.torque) / scale
    return np.sqrt((residual**2).reshape(POINTS**2, -1).mean(-1))


def _full() -> dict:
    """Tables with the right torque in every cell, and how many cells the training runs reach."""
    setup = JOINT_DAMPING
    training, everywhere = setup.record()[:5], square_recordings(setup, POINTS).recording
    states = _cases(setup, everywhere, "exact", 10).x
    seen = _cases(setup, training, "exact").x
    both = np.concatenate([states, seen])
    limits = np.stack([both.min(0), both.max(0)])

    def torque(x):
        return equations(setup)(*np.moveaxis(x, -1, 0))

    exact, reached = torque(states), []
    for cells in _FULL:
        cell_table = CellTable(cells, limits=limits).fit(Cases(seen, torque(seen), "states", 0.01))
        reached.append(1 - float(cell_table.empty(states).mean()))
    errors = {
        name: [
            float(rmss(full_table(torque, states, limits, n, interpolated=smooth), exact))
            for n in _FULL
        ]
        for name, smooth in (("constant", False), ("multilinear", True))
    }
    return {"cells": list(_FULL), **errors, "reached": reached}


# CMAC

_LAYERS, _EPOCHS, _HASHED_WIDTH = 32, 50, 0.5  # of CMAC; assumed
_WIDTHS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0)  # edges of its cubes over the box's
_SLOTS = (16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 16384)  # weights of a joint, by hashing


@study
def _rivals_cmac(days=_DAYS) -> dict:
    """Errors of CMAC by width, layers and slots; its collisions, and where it diverges."""
    settings = [
        *({"layers": _LAYERS, "width": width, "slots": None} for width in _WIDTHS),
        *({"layers": layers, "width": _HASHED_WIDTH, "slots": None} for layers in (8, 128)),
        *({"layers": _LAYERS, "width": _HASHED_WIDTH, "slots": slots} for slots in _SLOTS),
    ]
    rows = []
    for kind in KINDS:
        sets = {day: _day(day, kind) for day in days}
        for setting in settings if kind == KINDS[1] else settings[: len(_WIDTHS)]:
            by_day = [_cmac(sets[day], setting) for day in days]
            rows.append({"kind": kind, **setting, **_over_days(by_day)})
    chosen = _over_days([_chosen_cmac(day, kind, sets[day]) for day in days])
    return {"days": list(days), "floor": list(map(_floor, days)), "rows": rows, "chosen": chosen}


def _cmac(sets: dict[str, Cases], setting: dict) -> dict:
    """One CMAC: errors, what collides, and its error after each of the first passes."""
    rival = CMAC(**setting, epochs=_EPOCHS, beyond="edge")
    try:
        errors, diverged = _errors(rival.fit(sets["training"]), sets), False
    except Diverged:
        errors, diverged = dict.fromkeys(sets, np.nan), True
    return {
        **errors,
        "diverged": diverged,
        "history": rival.history[:: 1 if diverged else 10],
        "visited": rival.visited,
        "occupied": rival.occupied,
        "sharing": rival.sharing,
        "overlap": rival.overlap,
        "count": rival.count(),
    }


def _chosen_cmac(day: int, kind: str, sets: dict[str, Cases]) -> dict:
    """The width chosen for the same motions again, and for new ones, by what it has not seen."""
    spare = JOINT_DAMPING.repeated(day + 2 * _LATER)
    again = _cases(spare, _recorded(day + 2 * _LATER, "six")[:5], kind)
    training = sets["training"]

    def made(width, cases):
        return CMAC(_LAYERS, width, epochs=_EPOCHS, beyond="edge").fit(cases)

    fitted = {width: made(width, training) for width in _WIDTHS}
    same = min(_WIDTHS, key=lambda width: _errors(fitted[width], {"x": again})["x"])
    left_out = {
        width: np.mean(
            [_errors(made(width, rest), {"x": out})["x"] ** 2 for rest, out in _folds(training)]
        )
        for width in _WIDTHS
    }
    new = min(_WIDTHS, key=left_out.get)
    return {
        "practised width": same,
        "practised": _errors(fitted[same], sets)["again"],
        "new width": new,
        "new": _errors(fitted[new], sets)["trajectory 6"],
    }


def _folds(training: Cases) -> list[tuple[Cases, Cases]]:
    """Each of five trajectories left out in turn: the others, and it."""
    parts = [
        Cases(x, torque, "states", training.step)
        for x, torque in zip(np.split(training.x, 5), np.split(training.torque, 5))
    ]
    return [(_joined(parts[:k] + parts[k + 1 :]), parts[k]) for k in range(5)]


# Polynomials and Fourier series

_RIDGES = (0.0, 1e-8, 1e-6, 1e-4, 1e-2)  # on squared coefficients

# Families of functions and their highest degree or order.
_BASES: dict[str, tuple[Callable[[int, float], Rival], int]] = {
    "chebyshev": (lambda order, ridge: Polynomial(order, ridge=ridge), 6),
    "monomials": (lambda order, ridge: Polynomial(order, "monomials", ridge), 5),
    "fourier": (lambda order, ridge: Fourier(order, ridge=ridge), 3),
}


@study
def _rivals_bases(days=_DAYS) -> dict:
    """Errors of polynomials and Fourier series by degree and penalty; which one is chosen."""
    rows, chosen = [], {}
    for kind in KINDS:
        sets = {day: _day(day, kind) for day in days}
        for name, (make, highest) in list(_BASES.items())[: None if kind == KINDS[1] else 1]:
            for order in range(1, highest + 1):
                by_day = [_by_ridge(make, order, sets[day]["training"], sets[day]) for day in days]
                for k, ridge in enumerate(_RIDGES):
                    rows.append(
                        {"kind": kind, "basis": name, "order": order, "ridge": ridge}
                        | _over_days([each[k] for each in by_day])
                    )
    for name in ("chebyshev", "fourier"):
        chosen[name] = [_left_out(*_BASES[name], sets[day]["training"]) for day in days]
    return {"days": list(days), "floor": list(map(_floor, days)), "rows": rows, "chosen": chosen}


def _by_ridge(make, order: int, training: Cases, sets: dict[str, Cases]) -> list[dict]:
    """Number of coefficients, and errors, for each penalty."""
    fitted = [make(order, ridge).fit(training) for ridge in _RIDGES]
    return [{"count": each.count()} | _errors(each, sets) for each in fitted]


def _left_out(make, highest: int, training: Cases) -> dict:
    """Order and penalty with the least squared error on trajectories that were left out."""
    total: dict[tuple, float] = {}
    for rest, out in _folds(training):
        for order in range(1, highest + 1):
            errors = _by_ridge(make, order, rest, {"out": out})
            for ridge, row in zip(_RIDGES, errors):
                key = order, ridge
                total[key] = total.get(key, 0.0) + row["out"] ** 2
    order, ridge = min(total, key=total.get)
    return {"order": order, "ridge": ridge, "left out": float(np.sqrt(total[order, ridge] / 5))}


def practised_distance() -> np.ndarray:
    """Larger difference of extents to the practised one, degrees, ``(runs,)``, as in `_square`."""
    return np.abs(square_extents(POINTS) - PRACTISED).max(1)
