"""Section 5 beside fair nulls: networks trained on torques that are smooth and unrelated.

Read from the results "filter-trial" and "filter-trial-elsewhere". The replicates draw networks of
the real torques and draws of the surrogates; a p-value counts draws (`ddlib.learning.p_value`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from ddlib.analysis import CLASSES, DERIVATIVES
from ddlib.evidence.measures.filters import RUNS
from ddlib.evidence.verdicts import Measured, judged, largest_median, mean, median
from ddlib.experiments import results, split, true_states
from ddlib.experiments.studies.nulls import TRIAL
from ddlib.learning import MATCHED, p_value
from ddlib.tables import significant

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
    "inertia": {"M11": (0, 0, 2), "M12": (0, 1, 2), "M21": (1, 0, 2), "M22": (1, 1, 2)},
    "friction": {"shoulder": (0, 0, 1), "elbow": (1, 1, 1)},
}
"""Gains of a network that the arm has, too: output, joint, order of the derivative."""

UNITS = {"inertia": "kg m²", "friction": "N m s/rad"}
"""Units of these gains."""


@cache
def arm_gains() -> np.ndarray:
    """What the gains of the trial's networks should be, shape (output, joint, 3).

    No stiffness; the slope of the friction torque with the velocity, by least squares over the
    training cases; the mean mass matrix. Coulomb friction adds to the slope.
    """
    training, _ = split(TRIAL.record())
    states = true_states(training, TRIAL).reshape(-1, 2, 3)
    speed = states[..., 1]
    slope = np.linalg.lstsq(speed, TRIAL.effects.friction_torque(speed), rcond=None)[0].T
    inertia = TRIAL.arm.mass_matrix(states[..., 0]).mean(0)
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
    found, wanted = row(width), arm_gains()
    names, places = zip(*ENTRIES[what].items())
    true = np.array([wanted[at] for at in places])

    def of(ensemble):
        return np.stack([np.array(ensemble[path])[(slice(None), *at)] for at in places], -1)

    real = of(found["real"])
    told = ", ".join(
        f"{n} {m:.2f} (arm {t:.2f})" for n, m, t in zip(names, np.median(real, 0), true)
    )
    chance = max(near_by_chance(of(null), real, true) for null in matched(found).values())
    return judged(
        lambda each: np.abs(np.median(each, axis=1) / true - 1).max(-1),
        real,
        text=f"{told} {UNITS[what]}; as near by chance: p {chance:.2f}",
    )


def near_by_chance(null, real, true) -> float:
    """p-value of gains as near to the arm's as those on the real torques, in their worst entry.

    Parameters
    ----------
    null, real : array_like, shapes (draws, entries) and (networks, entries)
    true : array_like, shape (entries,)
    """

    def off(gains):
        return np.abs(np.asarray(gains) / true - 1).max(-1)

    return p_value(off(np.median(real, 0)), off(null), "less")


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
        One of `ddlib.evidence.measures.filters.RUNS`.
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
