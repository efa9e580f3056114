"""Which arms would have produced Table 4-1: many arms at random, and how well each was trained."""

from __future__ import annotations

import numpy as np

from ddlib.experiments.random_arms import RANGES, distance, draw, setup
from ddlib.experiments.results import code_hash
from ddlib.experiments.setups import WINDOWS, errors, train_windows
from ddlib.experiments.sweeps import sweep


def _arm(arm: dict, members: int, seed: int = 0) -> dict:
    """The six errors of one arm."""
    here = setup(arm)
    recording = here.record()
    tracking = np.abs(recording.tracking_error[:, recording.motion]).max()
    row = {**arm, "largest tracking error, degrees": float(np.rad2deg(tracking))}
    for width in WINDOWS:
        model, history, _ = train_windows(
            here, recording, width, members, seed=seed, progress=False
        )
        found = errors(model, recording)
        row[str(width)] = {
            "training": found["training"],
            "test": found["test"],
            "best test": history.best_test,
            "largest weight": model.weights.largest,
        }
    return row


def arms(count=32, members=8) -> dict:
    """Table 4-1 for arms drawn at random (`draw`), with one network for each cell.

    The arm whose training errors come closest to the printed ones is trained again with
    `members` other networks: chosen by the training column, it may be judged by the test column.
    """
    settings = [{"arm": arm, "members": 1} for arm in draw(count)]
    rows = sweep(_arm, settings, code=code_hash("arms"), backend="sequential", label="arms")
    closest = min(rows, key=distance)
    chosen = {name: closest[name] for name in RANGES}
    again = _arm(chosen, members, seed=1)
    return {"ranges": RANGES, "rows": rows, "chosen": again, "members": members}
