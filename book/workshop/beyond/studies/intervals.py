"""Whether a Gaussian process is right about how wrong it is, on recordings with noise."""

from __future__ import annotations

import warnings

import numpy as np

from ddlib.identification import FRICTION, RIGID
from ddlib.metrics import rmss
from ddlib.setups import JOINT_DAMPING, split
from ddlib.trajectories import OutsideFamilyWarning
from workshop.beyond.rivals.gaussian import GaussianProcess, _SemiParametric
from workshop.beyond.rivals.identified import Identified
from workshop.beyond.rivals.protocol import Cases, Estimating
from workshop.report.code_hash import study

_DAYS, _WIDTH, _DIRECTIONS = 6, 21, 10  # recordings; samples of a window; principal directions
_LEVEL, _SIGMAS = 0.95, 1.959964  # of the intervals, and their half width in deviations
_KEPT = 0.2  # share of the training cases that is kept out

_PROCESSES = {
    "directions of the window": lambda: GaussianProcess(directions=_DIRECTIONS, restarts=0),
    "estimated states": lambda: Estimating(GaussianProcess("states", restarts=0)),
    "known structure": lambda: Estimating(Identified(RIGID + FRICTION)),
    "beside known structure": lambda: Estimating(_SemiParametric(RIGID + FRICTION, restarts=0)),
}


def _asked(rival, cases: Cases) -> dict:
    within = isinstance(rival, Estimating)
    deviation = getattr(rival.rival if within else rival, "deviation", None)
    with warnings.catch_warnings(action="ignore", category=OutsideFamilyWarning):
        found = rival.torque(cases.x)
        row = {"rmss": float(rmss(found, cases.torque))}
        if deviation is not None:
            width = _SIGMAS * deviation(cases.x @ rival.filters.T if within else cases.x)
            row["covered"] = float((np.abs(found - cases.torque) <= width).mean())
            row["half width"] = width.mean(0)
    return row


@study
def gaussian_intervals() -> dict:
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
                rows[name][part].append(_asked(rival, cases))
    return {"days": _DAYS, "level": _LEVEL, "processes": rows}
