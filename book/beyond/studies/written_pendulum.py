"""A longer forearm, written by hand into networks of a real double pendulum.

Design C1 has the links of A0 exchanged. Its change of the equations goes into networks that learnt
A0, as far as filters of a window can: inertias, and the mean slope of gravity. Gravity itself is a
sine of the angles; beside the network it stands as a formula. If *turned sign* does as well as
*inertia written*, or *unedited* better, the inertia alone is not what separates the two arms.
"""

from __future__ import annotations

import numpy as np

from beyond.studies.two_link import (
    CONTROLLED,
    PUBLISHED,
    RUNS,
    START,
    STEP,
    all_runs,
    optimal_networks,
    regressor,
)
from ddlib.learning import TorqueModel, TrainingSet, Weights, train_ensemble
from ddlib.metrics import rmss
from ddlib.setups import WINDOWS
from workshop.report.code_hash import code_hash, study
from workshop.report.pencil import moment_filters, written
from workshop.report.sweeps import _sweep

_RIGID, _GRAVITY = np.arange(12) < 6, np.isin(np.arange(12), (3, 4))  # columns of `regressor`
_MEMBERS, _EPOCHS, _STEPS, _TRACE = 5, 8000, 120, 1e-4


def _swinging(runs, width: int, method: str) -> TorqueModel:
    """Networks of some recordings, trained as in the study of these."""
    x, torque = all_runs(runs, width), all_runs(runs, "torque")
    if method == "solver":
        return optimal_networks(x, torque, _MEMBERS, _TRACE, _STEPS)
    data = TrainingSet.from_arrays(x, torque, scaling=(-1, 1), step=STEP)
    start = Weights.random(_MEMBERS, width, initial=START)
    return train_ensemble(
        start, data, rate=66 / width, momentum=0.98, warm_up=500, epochs=_EPOCHS,
        progress=False,
    )[0]  # fmt: skip


def _slopes(states, parameters) -> np.ndarray:
    """Mean slope of torques ``Y @ parameters`` by each state, (torque, joint, 3)."""
    slopes = np.empty((2, 2, 3))
    for at in np.ndindex(2, 3):
        nudge = np.zeros((2, 3))
        nudge[at] = 1e-4
        change = (regressor(states + nudge) - regressor(states - nudge)) @ parameters
        slopes[:, *at] = change.mean(0) / 2e-4
    return slopes


def _pendulum(width: int, method: str) -> dict:
    """The longer forearm of design C1 in networks of design A0: RMSS on each run of C1.

    The change is that of the builders' equations along the run's positions, friction aside. Gravity
    is a sine of the angles, so no filter of a window: its mean slope is written, or it stands
    beside the network as a formula.
    """
    model, filters = _swinging(RUNS["A0"], width, method), moment_filters(width, STEP)
    short, long = (np.array(list(PUBLISHED[design].values())) for design in ("A0", "C1"))
    found: dict = {}
    for run in RUNS["C1"] + CONTROLLED["C1"]:
        x, torque = all_runs([run], width), all_runs([run], "torque")
        rows = regressor(states := all_runs([run], 41)[..., 14:27] @ moment_filters(13, STEP).T)
        change = _slopes(states, (long - short) * _RIGID)
        inertia = change * [0, 0, 1]
        few = tuple(other for other in RUNS["C1"] if other != run)
        with_inertia = written(model, x, inertia, filters).torque(x)
        torques = {
            "unedited": model.torque(x),
            "inertia written": with_inertia,
            "turned sign": written(model, x, -inertia, filters).torque(x),
            "inertia and slope of gravity written": written(model, x, change, filters).torque(x),
            "gravity by formula": model.torque(x) + rows @ ((long - short) * _GRAVITY),
            "inertia written, gravity by formula": with_inertia
            + rows @ ((long - short) * _GRAVITY),
            "all by formula": model.torque(x) + rows @ ((long - short) * _RIGID),
            "retrained": _swinging(few, width, method).torque(x),
            "equations, unedited": rows @ short,
            "equations": rows @ long,
        }
        own = _slopes(states, short * _RIGID)
        found[run] = {"change": change, "own": own} | {
            "error": {name: np.atleast_1d(rmss(each, torque)) for name, each in torques.items()}
        }
    return found


@study
def _written_pendulum() -> dict:
    """RMSS on each run of C1, by method and window."""
    settings = [{"width": width, "method": m} for m in ("descent", "solver") for width in WINDOWS]
    how = {"code": code_hash("written-pendulum"), "backend": "sequential"}
    found = _sweep(_pendulum, settings, label="double pendulum", **how)
    rows = [{"setting": setting, "runs": row} for setting, row in zip(settings, found)]
    return {"networks": _MEMBERS, "rows": rows}
