"""Section 5 beside fair nulls: networks trained on torques that are smooth and unrelated.

Read from the results "filter-trial" and "filter-trial-elsewhere". The replicates draw networks of
the real torques and draws of the surrogates; a p-value counts draws (`ddlib.learning.p_value`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ddlib.analysis import calibrated as gains_of
from ddlib.learning import MATCHED, cases, p_value
from ddlib.setups import JOINT_DAMPING, SETUPS, true_states
from ddlib.simulation import LOG_STEP
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured, judged


def row(where: int | str = 21) -> dict:
    """One row of the trial: of a window size, or by its name of the one with other conditions."""
    if isinstance(where, str):
        return results.read("filter-trial-elsewhere")["rows"][where]
    return results.read("filter-trial")["windows"][str(where)]


def matched(entry: dict) -> dict:
    """The nulls of a row that are as smooth as the torques."""
    return {kind: null for kind, null in entry["nulls"].items() if kind in MATCHED}


def share(entry: dict, layer: str, names: Sequence[str], kind: str = "classes") -> np.ndarray:
    """Share of a layer's filters in any of some classes, one for each network or draw."""
    return np.sum([entry[layer][kind][name] for name in names], axis=0)


# Gains of a network that the arm has, too: output, joint, order of the derivative
ENTRIES = {
    "inertia": {"M₁₁": (0, 0, 2), "M₁₂": (0, 1, 2), "M₂₁": (1, 0, 2), "M₂₂": (1, 1, 2)},
    "friction": {"shoulder": (0, 0, 1), "elbow": (1, 1, 1)},
}

_UNITS = {"inertia": "kg m²", "friction": "N m s/rad"}  # Units of these gains


@cache
def arm_gains(setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """What the gains of networks should be, shape (output, joint, 3).

    No stiffness; the slope of the friction torque with the velocity, by least squares over the
    training cases; the mean mass matrix. Coulomb friction adds to the slope.
    """
    reading = SETUPS[setup]
    states = true_states(committed.training(setup), reading).reshape(-1, 2, 3)
    speed = states[..., 1]
    slope = np.linalg.lstsq(speed, reading.effects.friction_torque(speed), rcond=None)[0].T
    inertia = reading.arm.mass_matrix(states[..., 0]).mean(0)
    return np.stack([np.zeros((2, 2)), slope, inertia], -1)


def calibrated(what: str = "inertia", width: int = 21, path: str = "gains") -> Measured:
    """How far the gains of networks are from the arm's own: the worst entry of `ENTRIES`.

    Of the whole network, `path` "gains", or through the direct weights alone, "gains, direct".
    """
    entry = row(width)
    real, true, compared = _entries(what, np.array(entry["real"][path]), arm_gains())
    nulls = (_entries(what, np.array(x[path]), arm_gains())[0] for x in matched(entry).values())
    chance = max(near_by_chance(null, real, true) for null in nulls)
    text = f"{compared} {_UNITS[what]}; as near by chance: p {chance:.2f}"
    return judged(lambda gains: _off(gains, true), real, text=text)


def calibrated_networks(width: int = 21, setup: str = JOINT_DAMPING.name) -> Measured:
    """How far the inertia in the networks of Table 4-1 is from the arm's: the worst entry."""
    windows, _ = cases(committed.training(setup), width)
    gains = gains_of(committed.networks(width, setup), windows, LOG_STEP).whole
    real, true, compared = _entries("inertia", gains, arm_gains(setup))
    return judged(lambda gains: _off(gains, true), real, text=f"{compared} {_UNITS['inertia']}")


def response(width: int = 21) -> Measured:
    """How far the trial's networks are from the arm in torque per acceleration on slow motions.

    At the shoulder, along the worst of three trajectories; see the study `filter_responses`.
    """
    study = results.read("filter-responses")
    numbers, (cell, own) = study["trajectories"], responses(width)
    pairs = list(zip(numbers, np.median(cell["network"], 0), own))
    text = ", ".join(
        f"{network:.1f} on trajectory {k} (arm {arm:.1f})" for k, network, arm in pairs
    )
    filters = ", ".join(f"{linear:.1f}" for linear in np.median(cell["filter"], 0))
    text += f" kg m²; as linear filters {filters}"
    return judged(lambda drawn: _off(drawn, own), cell["network"], text=text)


def responses(width: int = 21, motion: str = "slow") -> tuple[dict, np.ndarray]:
    """Torque per acceleration by trajectory: of "network" and "filter", one for each, and the arm.

    Along the motion as it was "recorded", swings included, or a "slow" sine as it was desired.
    """
    study = results.read("filter-responses")[motion]
    cell = {way: np.array(values) for way, values in study["windows"][str(width)].items()}
    return cell, np.array(study["arm"])


def _entries(what, gains, wanted) -> tuple[np.ndarray, np.ndarray, str]:
    """Gains ``(networks, entries)``, the arm's own, and both in words."""
    names, places = zip(*ENTRIES[what].items())
    entries = np.stack([gains[(slice(None), *at)] for at in places], -1)
    true = np.array([wanted[at] for at in places])
    medians = zip(names, np.median(entries, 0), true)
    return entries, true, ", ".join(f"{n} {m:.2f} (arm {t:.2f})" for n, m, t in medians)


def _off(gains, true) -> np.ndarray:
    """Largest deviation of the medians of ``(..., networks, entries)``, relative to the arm's."""
    return np.abs(np.median(gains, axis=-2) / true - 1).max(-1)


def near_by_chance(null, real, true) -> float:
    """p-value of gains as near to the arm's (`true`) as the `real` ones, in their worst entry."""
    draws = np.asarray(null)[:, None]  # each by itself
    return p_value(_off(np.asarray(real), true), _off(draws, true), "less")
