"""Section 5 beside fair nulls: networks trained on torques that are smooth and unrelated.

Read from the results "filter-trial" and "filter-trial-elsewhere". The replicates draw networks of
the real torques and draws of the surrogates; a p-value counts draws (`ddlib.learning.p_value`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ddlib.analysis import CLASSES, DERIVATIVES
from ddlib.analysis import calibrated as gains_of
from ddlib.learning import MATCHED, cases, p_value
from ddlib.setups import JOINT_DAMPING, SETUPS, true_states
from ddlib.tables import significant, spread
from ddlib.trajectories import MOTION_SECONDS
from workshop.report import committed, results
from workshop.report.evidence.verdicts import Measured, judged, largest_median, mean, median
from workshop.report.measures.filters import RUNS

SHAPES = tuple(name for name in CLASSES if name != "not analysable")
"""Classes of filters that have a name."""


def row(where: int | str = 21) -> dict:
    """One row of the trial.

    Parameters
    ----------
    where : int or str
        A window size of the main trial, or the name of a row of the one with other conditions.
    """
    if isinstance(where, str):
        return results.read("filter-trial-elsewhere")["rows"][where]
    return results.read("filter-trial")["windows"][str(where)]


def matched(found: dict) -> dict:
    """The nulls of a row that are as smooth as the torques."""
    return {kind: null for kind, null in found["nulls"].items() if kind in MATCHED}


def share(found: dict, layer: str, names: Sequence[str], kind: str = "classes") -> np.ndarray:
    """Share of a layer's filters in any of some classes, one for each network or draw.

    Parameters
    ----------
    found : dict
        What the trial tells of an ensemble.
    layer : str
        One of `ddlib.analysis.LAYERS`.
    names : sequence of str
        Among `ddlib.analysis.CLASSES`.
    kind : {"classes", "changes"}
        Of the weights, or of what training added to them.
    """
    return np.sum([found[layer][kind][name] for name in names], axis=0)


def excess(
    name: str, width: int | str = 21, layer: str = "hidden", kind: str = "classes"
) -> Measured:
    """Share of filters of a class on the real torques, less that on surrogates (judged).

    Less the mean over the draws of the matched surrogate that gives most of them.

    Parameters
    ----------
    name : str
        One of `ddlib.analysis.CLASSES`, "any" of those with a name, or some joined by "|".
    width : int or str
        As of `row`.
    layer : {"hidden", "direct", "both"}
        Which filters; both are weighted by their number.
    kind : {"classes", "changes"}
        As of `share`.
    """
    names = SHAPES if name == "any" else name.split("|")
    found = row(width)

    def of(ensemble):
        if layer != "both":
            return share(ensemble, layer, names, kind)
        hidden, direct = (share(ensemble, one, names, kind) for one in ("hidden", "direct"))
        return (20 * hidden + 4 * direct) / 24

    real = of(found["real"])
    nulls = {n: of(null) for n, null in matched(found).items()}
    told = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    before = 100 * of(found["untrained"]).mean()
    return judged(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
        text=f"{100 * real.mean():.0f} %; {told}; untrained {before:.0f} %",
    )


def above_null(what: str, width: int | str = 21) -> Measured:
    """A number of the networks on the real torques, less that on surrogates (judged).

    Less the median over the draws of the matched surrogate that has most of it.

    Parameters
    ----------
    what : str
        Among those that a row tells of its networks, like "cancelled" or "saturated".
    width : int or str
        As of `row`.
    """
    found = row(width)
    real = np.array(found["real"][what])
    nulls = {n: np.array(null[what]) for n, null in matched(found).items()}
    told = "; ".join(f"{n} {significant(np.median(x), 2)}" for n, x in nulls.items())
    text = f"{significant(np.median(real), 2)}; {told}"
    text += f"; untrained {significant(np.median(found['untrained'][what]), 2)}"
    return judged(
        lambda one, *others: median(one) - largest_median(*others),
        real,
        *nulls.values(),
        text=text,
    )


def follow(quantity: str, width: int | str = 21, layer: str = "hidden") -> Measured:
    """Share of units that follow a quantity best, less that on surrogates (judged).

    By all that comes in at a unit through a layer, from the windows of both joints.

    Parameters
    ----------
    quantity : str
        One of `ddlib.analysis.DERIVATIVES`, or some joined by "|".
    width : int or str
        As of `row`.
    layer : str
        One of `ddlib.analysis.LAYERS`.
    """
    found, which = row(width), [DERIVATIVES.index(name) for name in quantity.split("|")]

    def of(ensemble):
        return np.array(ensemble[layer]["strongest"])[:, which].sum(-1)

    real, nulls = of(found["real"]), {n: of(null) for n, null in matched(found).items()}
    told = "; ".join(f"{n} {100 * x.mean():.0f} %" for n, x in nulls.items())
    return judged(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
        text=f"{100 * real.mean():.0f} %; {told}",
    )


ENTRIES = {
    "inertia": {"M₁₁": (0, 0, 2), "M₁₂": (0, 1, 2), "M₂₁": (1, 0, 2), "M₂₂": (1, 1, 2)},
    "friction": {"shoulder": (0, 0, 1), "elbow": (1, 1, 1)},
}
"""Gains of a network that the arm has, too: output, joint, order of the derivative."""

UNITS = {"inertia": "kg m²", "friction": "N m s/rad"}
"""Units of these gains."""


@cache
def arm_gains(setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """What the gains of networks should be, shape (output, joint, 3).

    No stiffness; the slope of the friction torque with the velocity, by least squares over the
    training cases; the mean mass matrix. Coulomb friction adds to the slope.

    Parameters
    ----------
    setup : str
        One of `workshop.report.SETUPS`; the trial has the recording of joint damping.
    """
    made = SETUPS[setup]
    states = true_states(committed.training(setup), made).reshape(-1, 2, 3)
    speed = states[..., 1]
    slope = np.linalg.lstsq(speed, made.effects.friction_torque(speed), rcond=None)[0].T
    inertia = made.arm.mass_matrix(states[..., 0]).mean(0)
    return np.stack([np.zeros((2, 2)), slope, inertia], -1)


def calibrated(what: str = "inertia", width: int = 21, path: str = "gains") -> Measured:
    """How far the gains of networks are from the arm's own: the worst entry (judged).

    Parameters
    ----------
    what : {"inertia", "friction"}
        Gains on acceleration, or on the joint's own velocity.
    width : int
        Window size.
    path : {"gains", "gains, direct"}
        Of the whole network, or through the direct weights alone.
    """
    found = row(width)
    real, true, told = _entries(what, np.array(found["real"][path]), arm_gains())
    nulls = (_entries(what, np.array(x[path]), arm_gains())[0] for x in matched(found).values())
    chance = max(near_by_chance(null, real, true) for null in nulls)
    return judged(
        lambda each: _off(each, true),
        real,
        text=f"{told} {UNITS[what]}; as near by chance: p {chance:.2f}",
    )


def calibrated_networks(width: int = 21, setup: str = JOINT_DAMPING.name) -> Measured:
    """How far the inertia in the networks of Table 4-1 is from the arm's: the worst entry (judged).

    Parameters
    ----------
    width : int
        Window size.
    setup : str
        One of `workshop.report.SETUPS`.
    """
    windows, _ = cases(committed.training(setup), width)
    found = gains_of(committed.networks(width, setup), windows).whole
    real, true, told = _entries("inertia", found, arm_gains(setup))
    return judged(lambda each: _off(each, true), real, text=f"{told} {UNITS['inertia']}")


def stiffness(width: int = 21) -> Measured:
    """Stiffness of the trial's networks at the shoulder, which the arm has none of.

    Judged as a share of what the inertia is worth along the family's motions, half a period of a
    sine in `MOTION_SECONDS`.

    Parameters
    ----------
    width : int
        Window size.
    """
    found = np.array(row(width)["real"]["gains"])[:, 0, 0, 0]
    worth = (np.pi / MOTION_SECONDS) ** 2 * arm_gains()[0, 0, 2]
    text = f"K₁₁ {spread(found, 2)} N m/rad; the inertia is worth {worth:.1f}"
    return judged(lambda each: np.abs(median(each)) / worth, found, text=text)


def _entries(what, gains, wanted) -> tuple[np.ndarray, np.ndarray, str]:
    """Gains ``(networks, entries)``, the arm's own, and both in words."""
    names, places = zip(*ENTRIES[what].items())
    found = np.stack([gains[(slice(None), *at)] for at in places], -1)
    true = np.array([wanted[at] for at in places])
    told = zip(names, np.median(found, 0), true)
    return found, true, ", ".join(f"{n} {m:.2f} (arm {t:.2f})" for n, m, t in told)


def _off(gains, true) -> np.ndarray:
    """Largest deviation of the medians of ``(..., networks, entries)``, relative to the arm's."""
    return np.abs(np.median(gains, axis=-2) / true - 1).max(-1)


def near_by_chance(null, real, true) -> float:
    """p-value of gains as near to the arm's as those on the real torques, in their worst entry.

    Parameters
    ----------
    null, real : array_like, shapes (draws, entries) and (networks, entries)
    true : array_like, shape (entries,)
    """
    each = np.asarray(null)[:, None]  # a draw at a time
    return p_value(_off(np.asarray(real), true), _off(each, true), "less")


def readable(what: str = "velocity", width: int | str = 21) -> Measured:
    """How well a probe reads a quantity from the hidden units, less the best control (judged).

    Mean of both joints, on trajectory 6; R² for velocity and acceleration, balanced accuracy for
    the sign of the velocity. Controls are the units before training and under each null.

    Parameters
    ----------
    what : {"velocity", "acceleration", "sign"}
    width : int or str
        As of `row`.
    """
    found = row(width)
    name, which = {
        "velocity": ("probe", [0, 2]),
        "acceleration": ("probe", [1, 3]),
        "sign": ("probe of sign", [0, 1]),
    }[what]

    def of(ensemble):
        return np.array(ensemble[name])[:, which].mean(-1)

    real = of(found["real"])
    controls = {"untrained": of(found["untrained"])}
    controls |= {kind: of(null) for kind, null in matched(found).items()}
    told = "; ".join(f"{n} {np.median(x):.2f}" for n, x in controls.items())
    return judged(
        lambda one, *others: median(one) - largest_median(*others),
        real,
        *controls.values(),
        text=f"{np.median(real):.2f}; {told}",
    )


def replaced(by: str, width: int = 21, refitted: bool = False, runs: str = "training") -> Measured:
    """Error with other hidden filters over the error with the network's own (judged).

    Parameters
    ----------
    by : str
        What takes the place of the filters: "pure parts", "without pure parts", "untrained", or a
        matched surrogate, whose networks lend theirs.
    width : int
        Window size.
    refitted : bool
        Fit the output layer anew, in either case.
    runs : str
        One of `workshop.report.measures.filters.RUNS`.
    """
    found, how = row(width)["interventions"], "refitted" if refitted else "at once"
    errors = [np.array(found[name][how])[:, RUNS.index(runs)] for name in ("as trained", by)]
    alone = found["linear filter alone"][RUNS.index(runs)]
    own, other = (significant(np.median(x), 2) for x in errors)
    return judged(
        lambda pair: median(pair[1]) / median(pair[0]),
        tuple(errors),
        text=f"error {other}, with its own {own}; a linear filter alone {significant(alone, 2)}",
    )
