"""What a window calls viscous friction on two geared arms, and what it is made of.

A linear filter of a joint's own window is fitted to the joint's torque; its first moment is what
it answers to velocity. It is read off the measured torque, and off the torque of the identified
equations without their viscous or without their dry friction. If the reading were viscous, it
would vanish in the first and stay in the second. Last, three signs of the velocity, computed from
the same window, stand beside the filter. Motions (KR 300) or blocks (TX40) are left out whole.
"""

from __future__ import annotations

import numpy as np

from beyond.others import kr300
from beyond.studies.tx40 import Windowed, _fitted
from ddlib.analysis import gains
from ddlib.identification import joint_terms
from ddlib.learning import sliding_windows
from workshop.report.code_hash import study

_STEP, _WIDTH = 0.01, 21  # s, samples
_SPEEDS = {
    "three signs": (0.005, 0.02, 0.08),
    "wider signs": (0.02, 0.05, 0.1),
}  # rad/s: where a sign has turned


def _arms() -> dict[str, list]:
    """Windows, states and torques to learn from, and to be tested on, for each part left out."""
    half = _WIDTH // 2
    parts = [
        Windowed(100, _WIDTH, sliding_windows(m.q, _WIDTH), m.current[half:-half]) for m in kr300()
    ]
    motions = [(m.x, m.states, m.current) for m in parts]
    others = [motions[:k] + motions[k + 1 :] for k in range(len(motions))]
    learnt = [tuple(map(np.concatenate, zip(*each))) for each in others]
    data = Windowed.of(100, _WIDTH)
    whole = data.x, data.states, data.current
    blocks = [tuple(tuple(a[part] for a in whole) for part in fold) for fold in data.folds()]
    return {"KR 300": list(zip(learnt, motions)), "TX40": blocks}


def _columns(x, states, j, speeds=(), window=True) -> np.ndarray:
    """A joint's window, a constant, and the velocity's sign, blurred below some speeds."""
    signs = [np.tanh(states[:, j, 1] / speed) for speed in speeds]
    return np.column_stack([*x[:, j].T[: window * _WIDTH], np.ones(len(x)), *signs])


def _read(columns, torque) -> float:
    """First moment of the window's filter."""
    return float(gains(_fitted(columns, torque)[:_WIDTH], _STEP)[1])


def _joint(j: int, learnt, test) -> dict:
    """Readings over the equations' viscous friction, and squared errors on what was left out."""
    (x, states, torque), (new, new_states, wanted) = learnt, test
    rows, new_rows = (joint_terms(s)[j] for s in (states, new_states))
    terms = np.stack(list(rows.values()), -1)
    factors = _fitted(terms, torque[:, j])
    parts = {"velocity": 0.0, "sign": 0.0}
    for name, part in zip(rows, (terms * factors).T):
        if (kind := name.split(",")[0]) in parts:
            parts[kind] = parts[kind] + part
    equations, plain = terms @ factors, _columns(x, states, j)
    read = {
        "measured": _read(plain, torque[:, j]),
        "equations": _read(plain, equations),
        "no viscous": _read(plain, equations - parts["velocity"]),
        "no dry": _read(plain, equations - parts["sign"]),
    }
    models = {"window": ((), True), "three signs alone": (_SPEEDS["three signs"], False)}
    for name, speeds in _SPEEDS.items():
        read[name] = _read(_columns(x, states, j, speeds), torque[:, j])
        models[f"window and {name}"] = (speeds, True)
    guesses = {"equations": np.stack(list(new_rows.values()), -1) @ factors}
    for name, how in models.items():
        weights = _fitted(_columns(x, states, j, *how), torque[:, j])
        guesses[name] = _columns(new, new_states, j, *how) @ weights
    viscous = float(factors[list(rows).index("velocity")])
    errors = {name: float(((g - wanted[:, j]) ** 2).mean()) for name, g in guesses.items()}
    shares = {name: value / viscous for name, value in read.items()}
    return {"viscous": viscous, "read": shares, "errors": errors}


@study
def _viscosity() -> dict:
    """Of each arm, part left out and joint: readings over viscous friction, and squared errors."""
    return {
        arm: [[_joint(j, *fold) for j in range(6)] for fold in folds]
        for arm, folds in _arms().items()
    }
