"""Recordings of several days as one batch: the same motions or others on each, its own noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib._check import shaped
from ddlib.setups import Setup
from ddlib.simulation import Recording
from ddlib.trajectories import APPENDIX_I, Trajectory, pick_and_place
from workshop.beyond.studies.loop import motions
from workshop.beyond.studies.loop.run_time_parts import _on_days

_TRAINED = 5  # motions of a family on a day: as many as Appendix I has for training


def _recorded(setup: Setup, references: list[Trajectory], days) -> list[Recording]:
    """Drive the arm along the references of each day, and log what its sensors say.

    Each day has its own zero of the encoders, each run its own torque noise, whatever else is
    recorded.
    """
    days = shaped("days", days, f"({len(references)},)").astype(int)
    together = Trajectory(*(np.stack(parts) for parts in zip(*references)))
    today = replace(setup, effects=_on_days(setup.effects, setup, days))
    seeds = 1000 * (1 + days[:, None]) + np.arange(together.q.shape[1])
    log = motions.recorded(today, together, seed=seeds)
    return [log[k] for k in range(len(days))]


def training(setup: Setup, days) -> list[dict[str, Recording]]:
    """Recordings of five motions of each family, for each day, which is the seed of their draw."""
    t = motions.times()
    references = {
        "pick and place": lambda day: pick_and_place(APPENDIX_I[:_TRAINED], t),
        "circles": lambda day: motions.stirred(setup.arm, motions.random_circles(_TRAINED, day), t),
        "via points": lambda day: motions._via_points(
            motions._random_points(_TRAINED, motions._VIA, day), t
        ),
    }
    each = [[make(day) for make in references.values()] for day in days]
    joined = [Trajectory(*(np.concatenate(parts) for parts in zip(*day))) for day in each]
    logs = _recorded(setup, joined, days)
    return [
        {name: log[k * _TRAINED : (k + 1) * _TRAINED] for k, name in enumerate(references)}
        for log in logs
    ]
