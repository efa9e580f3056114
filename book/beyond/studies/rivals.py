"""All rivals on the same recordings, and whether Gaussian processes know how wrong they are."""

from __future__ import annotations

import warnings
from itertools import product
from typing import NamedTuple

import numpy as np

from beyond.rivals.gaussian import GaussianProcess, SemiParametric
from beyond.rivals.identified import Identified
from beyond.rivals.protocol import Cases, Estimating, trial
from beyond.studies.lineup import _DAYS as _RECORDINGS, LINES, REFERENCE
from ddlib.analysis import inside_hull, noise_floor
from ddlib.identification import FRICTION, RIGID
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, Setup, split, true_states
from ddlib.simulation import LOG_STEP, Recording
from ddlib.trajectories import MAX_EXTENT_DEG, OutsideFamilyWarning
from workshop.report import results
from workshop.report.code_hash import study

WINDOW = 21  # samples of the windows: the paper's best
SQUARE_POINTS = 9  # trajectories in a row of the square of extents

_EVERY, _SHOWN = 4, 10  # samples of the square from test to test, and of those shown
NUMBERS_BUDGET = 540  # stored numbers of the paper's network with ten hidden units

# Torques on the square: each rival at its largest size within the budget, or at its smallest.
_TORQUES = results.FOLDER / "rivals-torques.npz"
_INPUTS = ("positions", "exact states")  # windows of measured positions, or states without noise


class _Square(NamedTuple):
    """Recordings of a grid of trajectories; in `extents_deg` the elbow's changes fastest."""

    extents_deg: np.ndarray  # shape (runs, 2), shoulder and elbow
    inside: np.ndarray  # whether they lie in the hull of the training trajectories
    recording: Recording


def square_recordings(setup: Setup, points: int = 9) -> _Square:
    """Record trajectories on a grid of extents, equally spaced from ``45 / points`` degrees on."""
    edge = MAX_EXTENT_DEG * np.arange(1, points + 1) / points
    extents = np.stack(np.meshgrid(edge, edge, indexing="ij"), -1).reshape(-1, 2)
    return _Square(extents, inside_hull(extents), setup.record(extents))


def recorded(day: int) -> tuple[dict[str, dict[str, Cases]], Cases]:
    """Cases of one day by `_INPUTS` and name (inside and outside the hull), and the square's."""
    setup = JOINT_DAMPING.repeated(day)
    training, six = split(setup.record())
    whole = square_recordings(setup, SQUARE_POINTS)
    parts = {
        "training": (training, 1),
        "trajectory 6": (six, 1),
        "inside": (whole.recording[whole.inside], _EVERY),
        "outside": (whole.recording[~whole.inside], _EVERY),
    }
    seen: dict = {inputs: {} for inputs in _INPUTS}
    for name, (part, every) in parts.items():
        seen["positions"][name] = Cases.windows(part, WINDOW)[::every]
        seen["exact states"][name] = Cases.states(part, true_states(part, setup))[::every]
    return seen, Cases.windows(whole.recording, WINDOW)[::_SHOWN]


def _seen(line, inputs: str, size, seed: int):
    """A rival for what it is to see, or None if it cannot."""
    rival = line.make(size, seed)
    if inputs == "positions" and rival.kind == "states":
        return Estimating(rival)
    return None if inputs == "exact states" and rival.kind == "windows" else rival


def _floors(sets: dict) -> dict:
    """The noise floor of each set (`ddlib.analysis.noise_floor`), for each of `_INPUTS`."""
    (noise,), (encoder,) = JOINT_DAMPING.effects.torque_sensor, JOINT_DAMPING.effects.encoder
    bits = float(np.log2(2 * np.pi / encoder.step))
    floors = {inputs: {} for inputs in _INPUTS}
    for name, cases in sets.items():
        deviation = cases.torque.std(0)
        share = float(np.sqrt(np.mean((np.array(noise.std) / deviation) ** 2)))
        known = JOINT_DAMPING.arm, deviation, WINDOW, bits, share, LOG_STEP
        floors["positions"][name], floors["exact states"][name] = noise_floor(*known), share
    return floors


@study
def _rivals() -> dict:
    """Every line of `_LINES` at all its sizes, on several days; torques go into `_TORQUES`."""
    rows, torques, floor = {}, {}, None
    for day in range(1, _RECORDINGS + 1):
        sets, asked = recorded(day)
        floor = floor or _floors(sets["positions"])
        for name, line in LINES.items():
            for inputs, size in product(_INPUTS, line.sizes if day <= line.days else ()):
                rival = _seen(line, inputs, size, day)
                if rival is None:
                    continue
                tried = trial(rival, sets[inputs]["training"], sets[inputs])
                row = rows.setdefault((name, inputs, size), _row(name, inputs, size, tried))
                for part, error in tried.rmss.items():
                    row["errors"][part].append(error)
                affordable = name not in torques or tried.count <= NUMBERS_BUDGET
                if day == 1 and inputs == "positions" and affordable:
                    torques[name] = _asked(rival, asked)
        if day == 1:
            _keep(torques, asked)
    return {
        "days": _RECORDINGS,
        "width": WINDOW,
        "reference": REFERENCE,
        "budget": NUMBERS_BUDGET,
        "floor": floor,
        "rows": list(rows.values()),
    }


def _row(name, inputs, size, tried) -> dict:
    return {
        "rival": name,
        "inputs": inputs,
        "size": size,
        "count": tried.count,
        "errors": {part: [] for part in tried.rmss},
    }


def _asked(rival, asked: Cases) -> np.ndarray:
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        return rival.torque(asked.x)


def _keep(torques: dict, asked: Cases) -> None:
    """Measured and predicted torques of the square, shape (rivals + 1, runs, samples, joint)."""
    shape = (-1, SQUARE_POINTS**2, len(asked) // SQUARE_POINTS**2, 2)
    values = np.stack([asked.torque, *torques.values()]).reshape(shape)
    part = _TORQUES.with_name(_TORQUES.name + ".part")
    with open(part, "wb") as file:
        np.savez_compressed(file, names=["measured", *torques], torque=values.astype(np.float16))
    part.replace(_TORQUES)


_DAYS, _WIDTH, _DIRECTIONS = 6, 21, 10  # of the intervals; principal directions
_LEVEL, _SIGMAS = 0.95, 1.959964  # of the intervals, and their half width in deviations
_KEPT = 0.2  # share of the training cases that is kept out

_PROCESSES = {
    "directions of the window": lambda: GaussianProcess(directions=_DIRECTIONS, restarts=0),
    "estimated states": lambda: Estimating(GaussianProcess("states", restarts=0)),
    "known structure": lambda: Estimating(Identified(RIGID + FRICTION)),
    "beside known structure": lambda: Estimating(SemiParametric(RIGID + FRICTION, restarts=0)),
}


def _interval_row(rival, cases: Cases) -> dict:
    within = isinstance(rival, Estimating)
    deviation = getattr(rival.rival if within else rival, "deviation", None)
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        predicted = rival.torque(cases.x)
        row = {"rmss": float(rmss(predicted, cases.torque))}
        if deviation is not None:
            width = _SIGMAS * deviation(cases.x @ rival.filters.T if within else cases.x)
            row["covered"] = float((np.abs(predicted - cases.torque) <= width).mean())
            row["half width"] = width.mean(0)
    return row


@study
def _gaussian_intervals() -> dict:
    """Share of measured torques in the intervals of several processes, on several days."""
    rows: dict = {name: {"kept out": [], "trajectory 6": []} for name in _PROCESSES}
    for day in range(1, _DAYS + 1):
        training, six = split(JOINT_DAMPING.repeated(day).record())
        windows = Cases.windows(training, _WIDTH)
        out = np.random.default_rng(day).random(len(windows)) < _KEPT
        sets = {"kept out": windows[out], "trajectory 6": Cases.windows(six, _WIDTH)}
        for name, make in _PROCESSES.items():
            rival = make().fit(windows[~out])
            for part, cases in sets.items():
                rows[name][part].append(_interval_row(rival, cases))
    return {"days": _DAYS, "level": _LEVEL, "processes": rows}
