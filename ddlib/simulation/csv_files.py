"""Recordings of a reader's own arm, from CSV files."""

from __future__ import annotations

import csv
import math
import os

import numpy as np

from ddlib._check import integer
from ddlib.simulation.recording import Recording
from ddlib.trajectories import Trajectory

_COLUMNS = ("time", "q1", "q2", "tau1", "tau2")


def read_csv(paths, width: int) -> Recording:
    """Read a recording with columns time (s), q1, q2 (rad), tau1, tau2 (N m), and run, if any.

    The motion is all samples that have a whole window around them. What a file does not tell is
    NaN: the reference, and what is true rather than measured.

    Parameters
    ----------
    paths : path or list of paths
        A file for each run, or one with a column run. Longer runs are cut to the shortest.
    width : int
        Window size in samples, odd. Every run must have more samples.

    Returns
    -------
    Recording
        Arrays of shape (runs, time, 2).

    Raises
    ------
    ValueError
        With the file, and line, column or run: if a column is missing, a cell is no finite number,
        a run is too short, or a time step differs from the usual one by more than 1 %.
    """
    half = integer("width", width, 3) // 2
    runs = {}
    for path in [paths] if isinstance(paths, (str, os.PathLike)) else paths:
        runs |= _runs_in(path)
    if not runs:
        raise ValueError(f"{paths}: no samples")
    for run, samples in runs.items():
        if len(samples) <= width:
            raise ValueError(f"{run}: {len(samples)} samples are too few for a window of {width}")
    step = float(np.median(np.concatenate([np.diff(x[:, 1]) for x in runs.values()])))
    for run, samples in runs.items():
        steps = np.diff(samples[:, 1])
        fine = (steps > 0) & (np.abs(steps - step) <= 0.01 * step)
        for k in np.flatnonzero(~fine)[:1]:
            raise ValueError(
                f"{run}, line {samples[k + 1, 0]:.0f}: time must grow in equal steps, like the "
                f"{step:g} s of most, got a step of {steps[k]:g} s"
            )
    shortest = min(map(len, runs.values()))
    data = np.stack([samples[:shortest, 2:] for samples in runs.values()])
    unknown = np.full_like(data[..., :2], np.nan)
    t = step * (np.arange(shortest) - half)
    arrays = (data[..., :2], data[..., 2:], unknown, unknown, unknown)
    return Recording(
        t, Trajectory(unknown, unknown, unknown), *arrays, (shortest - 2 * half) * step
    )


def _runs_in(path) -> dict[str, np.ndarray]:
    """Samples of each run of a file: line, time, angles, torques."""
    runs = {}
    with open(path, encoding="utf-8-sig", newline="") as file:
        table = csv.DictReader(file, skipinitialspace=True)
        heads = table.fieldnames or ["nothing"]
        if missing := [name for name in _COLUMNS if name not in heads]:
            raise ValueError(
                f"{path}, line 1: no column {', '.join(missing)} in {', '.join(heads)}"
            )
        for row in table:
            run = f"{path}, run {row['run']}" if "run" in heads else str(path)
            place = f"{path}, line {table.line_num}, column "
            sample = [_finite(row[name], place + name) for name in _COLUMNS]
            runs.setdefault(run, []).append([table.line_num, *sample])
    return {run: np.array(samples) for run, samples in runs.items()}


def _finite(text, place: str) -> float:
    """The number in a cell; a ValueError names its place."""
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{place}: must be a finite number, got {text!r}")
    return value
