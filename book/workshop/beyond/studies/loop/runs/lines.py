"""Feedforwards side by side: all lines of an experiment simulated as one batch."""

from __future__ import annotations

import numpy as np

from ddlib.setups import Setup
from ddlib.simulation import Recording
from ddlib.trajectories import Trajectory
from workshop.beyond.studies.loop.run_time_parts import drive, given, score, time_first


def driven(
    setup: Setup, made: dict, reference: Trajectory, **changed
) -> tuple[Recording, dict[str, slice]]:
    """Recording of all lines, and which part of it belongs to each.

    ``made`` has by the name of a line its torques (N m), ``(days or 1, runs, time, 2)``, and its
    days; ``changed`` is another arm or other effects.
    """
    every, days, parts = [], [], {}
    for name, (torque, own) in made.items():
        parts[name] = slice(len(days), len(days) + len(own))
        days += own
        every.append(np.broadcast_to(torque, (len(own), *torque.shape[1:])))
    law = given(time_first(np.concatenate(every)), setup.controller)
    return drive(setup, law, reference, days, **changed), parts


def errors(setup: Setup, made: dict, reference: Trajectory, **changed) -> dict[str, np.ndarray]:
    """Median end-point error over the runs on each day of each line, mm."""
    log, parts = driven(setup, made, reference, **changed)
    middle = np.median(score(setup.arm, log).whole, -1)
    return {name: middle[part] for name, part in parts.items()}
