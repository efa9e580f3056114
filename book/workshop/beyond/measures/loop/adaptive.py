"""Section 1.1: what adaptive controllers reach on the arm, what they find, and what they miss."""

from __future__ import annotations

import numpy as np

from workshop.beyond.studies.loop.runs.adaptive import _FULL
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged

SETUPS = ("joint damping", "state feedback")  # of the study


def kept(*path) -> np.ndarray | dict:
    """A part of the result; among its numbers, runs that were stopped are infinite."""
    found = results.read("adaptive")
    for key in path:
        found = found[key]
    return found if isinstance(found, dict) else _finite(found)


def _finite(numbers) -> np.ndarray:
    return np.nan_to_num(np.array(numbers, float), nan=np.inf)


def load_row(setup: str, mass: float, late: int = 0) -> dict[str, np.ndarray]:
    """Errors in mm by law, ``(motions, seeds)``, with a load in kg and torques periods late."""
    rows = kept("loads", setup)["rows"]
    (row,) = [r for r in rows if r["load"] == mass and r["late"] == late]
    return {name: _finite(errors) for name, errors in row["settled"].items()}


def _added(effect: str) -> np.ndarray:
    """What an effect adds to the estimates of each day, as shares of the true ones."""
    own, none = (np.array(kept("bed", e, "estimate")) for e in (effect, next(iter(kept("bed")))))
    return own - none


def bias(effect: str) -> np.ndarray:
    """What an effect adds to the seven estimates in the median, as shares of the true ones."""
    return np.median(_added(effect), axis=0)


def _told(parameter: str) -> str:
    """A parameter of adaptive controllers in words, if it is a friction or a moment."""
    kinds = {"F_v": "viscous friction", "F_c": "Coulomb friction", "g": "gravity moment"}
    kind, joint = kinds.get(parameter[:-1]), parameter[-1]
    return f"the {('shoulder', 'elbow')[int(joint) - 1]}'s {kind}" if kind else parameter


def bent(effect: str) -> Measured:
    """Largest such bias."""
    off = bias(effect)
    k = int(np.abs(off).argmax())
    return judged(
        lambda x: np.abs(np.median(x, axis=1)).max(-1),
        _added(effect),
        text=f"{100 * off[k]:+.0f} % of {_told(_FULL[k])}",
    )
