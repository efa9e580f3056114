"""All rivals on the same recordings: error, stored numbers, arithmetic, training time."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.analysis import noise_floor
from ddlib.experiments.extents import square
from ddlib.experiments.setups import JOINT_DAMPING, split
from ddlib.experiments.studies.beyond.lineup import DAYS, LINES
from ddlib.experiments.two_harmonics import true_states
from ddlib.rivals import Cases, Estimating, trial
from ddlib.simulation import LOG_STEP

WIDTH = 21
"""Samples of the windows: the paper's best."""

GRID = 9
"""Trajectories in a row of the square of extents."""

EVERY = 4
"""Of the square's samples every so many are asked."""

INPUTS = ("positions", "exact states")
"""What rivals see: windows of measured positions, or states without noise."""


def days(number: int = DAYS):
    """Recordings of several days as cases: what each kind of rival learns from and is tested on.

    Parameters
    ----------
    number : int
        Of days; the first one is 1.

    Yields
    ------
    dict
        For each of `INPUTS` the sets by name: training, trajectory 6, inside, outside.
    """
    for day in range(1, number + 1):
        setup = JOINT_DAMPING.repeated(day)
        training, six = split(setup.record())
        whole = square(setup, GRID)
        parts = {
            "training": training,
            "trajectory 6": six,
            "inside": whole.recording[whole.inside],
            "outside": whole.recording[~whole.inside],
        }
        yield {
            "positions": {name: Cases.windows(part, WIDTH) for name, part in parts.items()},
            "exact states": {
                name: Cases.states(part, true_states(part, setup)) for name, part in parts.items()
            },
        }


def _thinned(sets: dict) -> dict:
    """The same with every so many of the square's samples."""
    return {
        name: Cases(c.x[::EVERY], c.torque[::EVERY], c.kind, c.step)
        if name in ("inside", "outside")
        else c
        for name, c in sets.items()
    }


def _seen(line, inputs: str, size, seed: int):
    """A rival for what it is to see, or None if it cannot."""
    rival = line.make(size, seed)
    if inputs == "positions" and rival.kind == "states":
        return Estimating(rival)
    return None if inputs == "exact states" and rival.kind == "windows" else rival


def floors(sets: dict) -> dict:
    """The noise floor of each set (`ddlib.analysis.noise_floor`), for each of `INPUTS`.

    Parameters
    ----------
    sets : dict
        Cases by name.
    """
    (noise,), (encoder,) = JOINT_DAMPING.effects.torque_sensor, JOINT_DAMPING.effects.encoder
    bits = float(np.log2(2 * np.pi / encoder.step))
    found = {inputs: {} for inputs in INPUTS}
    for name, cases in sets.items():
        deviation = cases.torque.std(0)
        share = float(np.sqrt(np.mean((np.array(noise.std) / deviation) ** 2)))
        known = JOINT_DAMPING.arm, deviation, WIDTH, bits, share, LOG_STEP
        found["positions"][name], found["exact states"][name] = noise_floor(*known), share
    return found


def rivals() -> dict:
    """Every line of `LINES` at all its sizes, on several days; torques of the first day are kept.

    A row for each rival, size and kind of inputs; errors and times have a value for each day.
    """
    rows, floor = {}, None
    for day, seen in enumerate(days(), 1):
        sets = {inputs: _thinned(seen[inputs]) for inputs in INPUTS}
        floor = floor or floors(seen["positions"])
        for name, line in LINES.items():
            for inputs in INPUTS:
                for size in line.sizes if day <= line.days else ():
                    rival = _seen(line, inputs, size, day)
                    if rival is None:
                        continue
                    found = trial(rival, sets[inputs]["training"], sets[inputs])
                    row = rows.setdefault((name, inputs, size), _row(name, inputs, size, found))
                    row["seconds"].append(found.seconds)
                    for part, error in found.rmss.items():
                        row["errors"][part].append(error)
    return {
        "days": DAYS,
        "width": WIDTH,
        "test trajectory": paper.TEST_TRAJECTORY,
        "floor": floor,
        "lines": {
            name: {"varied": line.varied, "shown": line.shown, "family": line.family}
            | {"year": line.year, "sizes": line.sizes}
            for name, line in LINES.items()
        },
        "rows": list(rows.values()),
    }


def _row(name, inputs, size, found) -> dict:
    return {
        "rival": name,
        "inputs": inputs,
        "size": size,
        "count": found.count,
        "operations": list(found.operations),
        "seconds": [],
        "errors": {part: [] for part in found.rmss},
    }
