"""Joints three and four, and up to seven: growth and filters, from the result "joints"."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, bootstrap, judged, median

DAMPED = "windows"  # part with the errors of window networks under joint damping


def read(part: str):
    """A part of the result, like "windows" or "costs"."""
    return results.read("joints")[part]


def row(part: str, **wanted) -> dict:
    """The one row of a part whose entries have these values."""
    rows = [r for r in read(part) if all(r[key] == value for key, value in wanted.items())]
    (found,) = rows
    return found


def errors(joints: int, motions: int, what: str = "test", reading: str = DAMPED) -> np.ndarray:
    """One error for each seed of a cell: "test", "training", or "linear" of a linear filter."""
    return np.array(row(reading, joints=joints, motions=motions)[what])


def ladder(joints: int, what: str = "test") -> tuple[np.ndarray, list[np.ndarray]]:
    """Numbers of motions that were tried with so many joints, and the `errors` of each."""
    rows = [r for r in read(DAMPED) if r["joints"] == joints]
    return np.array([r["motions"] for r in rows]), [np.array(r[what]) for r in rows]


def numbers() -> list[int]:
    """Numbers of joints that were tried."""
    return sorted({row["joints"] for row in read(DAMPED)})


# --- growth -------------------------------------------------------------------------------


def _needed(joints: int, level: float) -> tuple[float, np.ndarray]:
    """Training motions from which on the median RMSS is below a level, and in each draw."""
    motions, cells = ladder(joints)
    crossing = _crossing(motions, level)
    # a seed's motions are among those of its longer draws: seeds are drawn for a whole ladder
    replicates = bootstrap(lambda drawn: crossing(*drawn), tuple(cells), seed=joints)
    return float(crossing(*(c[None] for c in cells))[0]), replicates


def _crossing(motions, level) -> Callable:
    x = np.log(motions)

    def crossing(*cells):
        y = np.log(np.stack([median(c) for c in cells])) - np.log(level)
        late = np.full(y.shape[1], np.inf)
        for k in range(y.shape[1]):
            above = np.flatnonzero(y[:, k] > 0)
            last = above.max() if above.size else -1
            if last < 0:
                late[k] = motions[0]
            elif last + 1 < len(x):
                share = y[last, k] / (y[last, k] - y[last + 1, k])
                late[k] = np.exp(x[last] + share * (x[last + 1] - x[last]))
        return late

    return crossing


def law(level: float = 0.2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joints, motions that they need, exponents of a power law: medians first, then replicates."""
    joints = np.array([n for n in numbers() if n >= 2])
    each = [_needed(n, level) for n in joints]
    motions = np.column_stack([np.append(value, drawn) for value, drawn in each])
    x = np.log(joints) - np.log(joints).mean()
    return joints, motions, np.log(motions) @ x / (x @ x)


def growth(level: float = 0.2) -> Measured:
    """Exponent of the motions needed for an RMSS over the number of joints, from two to seven."""
    _, motions, exponents = law(level)
    low, high = np.percentile(exponents[1:], [5, 95])
    shown = ", ".join(f"{m:.0f}" for m in motions[0])
    text = f"{exponents[0]:.1f} ({low:.1f} to {high:.1f}): {shown} motions"
    return Measured(float(exponents[0]), text, exponents[1:])


# --- filters --------------------------------------------------------------------------------


def scaled(kind: str = "real") -> tuple[np.ndarray, np.ndarray]:
    """Gains on acceleration, ``(networks, torque, joint)``, and the arm's inertia, as shares."""
    pairs = read("pairs")
    unit = np.array(pairs["acceleration"]) / np.array(pairs["deviation"])[:, None]
    return np.array(pairs["gains"][kind]) * unit, np.array(pairs["inertia"]) * unit


def _together(kind: str) -> np.ndarray:
    """Correlation of each network's gains with inertia, over pairs of different joints."""
    gains, inertia = scaled(kind)
    pairs = ~np.eye(len(inertia), dtype=bool)
    return np.array([np.corrcoef(g[pairs], inertia[pairs])[0, 1] for g in gains])


def couplings(kind: str = "real") -> Measured:
    """Correlation of the gains by pairs of different joints with the arm's inertia."""
    real, null = _together("real"), _together("unrelated")
    text = f"{_spread(real)}; {_spread(null)} on unrelated torques"
    return judged(median, real if kind == "real" else null, text=text)


def _spread(x) -> str:
    return f"{significant(float(np.median(x)), 2)} ({min(x):.2g} to {max(x):.2g})"
