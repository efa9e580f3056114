"""Two rows that look alike: of networks that learnt the arm, and a spring in its place.

Chosen is nothing: shown are the first hidden units of the first networks, and how much alike all
pairs of rows are stands beside them. The small start lets rows grow to where training leads them;
so long a training is that of the lessons (`workshop.report.studies.planted`).
"""

from __future__ import annotations

from dataclasses import asdict, replace

import numpy as np

from ddlib.analysis import gains, mean_gradient
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from workshop.report.code_hash import study
from workshop.report.known_torques import ARM, Day

_SPRING = "position alone"
_NETWORKS = 4
_HOW = {"steps": 0, "decay": 0.0, "warm_up": 500, "initial": 0.001, "epochs": 4000}


@study
def _twins() -> dict:
    """Of each kind the first network and what all read; how much alike the shoulder's rows are."""
    day = Day(replace(JOINT_DAMPING, **_HOW), 21)
    kinds = {name: day.kinds(_NETWORKS, seed=0)[name] for name in (ARM, _SPRING)}
    found, rows = {}, []
    for name, model, _ in day.learnt(kinds, _NETWORKS, "descent", seed=0):
        found[name] = {
            "weights": asdict(model.weights[0]),
            "inputs": asdict(model.inputs),
            "outputs": asdict(model.outputs),
            "inertia": gains(mean_gradient(model, day.windows), LOG_STEP)[:, 0, 0, 2],
        }
        rows.append(model.weights.hidden_weights[..., 0, :].reshape(-1, day.width))
    alike = np.corrcoef(*rows)[: len(rows[0]), len(rows[0]) :]
    return {
        "how": {**_HOW, "networks": _NETWORKS},
        "arm": kinds[ARM].truth(day.states)[0, 0, 2],
        "alike": {"shown": alike[0, 0], "least": alike.min(), "median": np.median(alike)},
        "pairs": alike.size,
        "kinds": found,
    }
