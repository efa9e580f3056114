"""The filters of networks on a real arm: their names, gains and shares, beside fair nulls.

Read from the result "real-arm". These networks learnt the whole recording; the nulls learnt
currents of the same spectra that have nothing to do with the motion. The replicates draw networks.
"""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.analysis import CLASSES
from ddlib.evidence.verdicts import Measured, judged, mean, median
from ddlib.experiments import results
from ddlib.learning import p_value
from ddlib.tables import significant

NAMED = ("velocity", "acceleration", "velocity + acceleration")
"""Classes of filters that the paper finds."""

WORTH = {"inertia": ("acceleration", "inertia"), "friction": ("velocity", "slope")}
"""Gains of a network, and what the identified model has in their place."""

UNITS = {"inertia": "A s²/rad", "friction": "A s/rad"}
"""Units of these gains."""

LEAST = 0.1
"""Share of the identified value at which a gain that is less, or of the wrong sign, is counted."""


def row(width: int) -> dict:
    """Networks of a window on the whole recording, and on unrelated currents."""
    return results.read("real-arm")["windows"][str(width)]


def _names(ensemble: dict) -> np.ndarray:
    """Share of an ensemble's filters that have one of the names in `NAMED`."""
    which = [CLASSES.index(name) for name in NAMED]
    hidden, direct = (
        np.array(ensemble["classes"][x])[:, which].sum(-1) for x in ("hidden", "direct")
    )
    return (paper.HIDDEN_UNITS * hidden + 6 * direct) / (paper.HIDDEN_UNITS + 6)


def excess(width: int = 21) -> Measured:
    """Share of velocity and acceleration filters, less that on unrelated currents (judged).

    Less the mean over the draws of the surrogate that gives most of them.

    Parameters
    ----------
    width : int
        Window size.
    """
    found = row(width)
    real, nulls = _names(found["real"]), {n: _names(x) for n, x in found["nulls"].items()}
    told = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    before = 100 * _names(found["untrained"]).mean()
    return judged(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
        text=f"{100 * real.mean():.0f} %; {told}; untrained {before:.0f} %",
    )


def _off(gains, true) -> np.ndarray:
    """How far the median gains are from the arm's, in the worst joint."""
    return np.abs(np.median(gains, axis=-2) / true - 1).max(-1)


def calibrated(what: str = "inertia", width: int = 21) -> Measured:
    """How far the gains of networks on a joint's own motion are from the arm's: the worst (judged).

    Parameters
    ----------
    what : {"inertia", "friction"}
        Gains on acceleration, or on velocity.
    width : int
        Window size.
    """
    found, (name, wanted) = row(width), WORTH[what]
    real, true = np.array(found["real"][name]), np.array(found["identified"][wanted])
    chance = max(
        p_value(_off(real, true), _off(np.array(x[name])[:, None], true), "less")
        for x in found["nulls"].values()
    )
    pairs = zip(np.median(real, 0), true)
    told = ", ".join(f"{significant(a, 2)} for {significant(b, 2)}" for a, b in pairs)
    text = f"{told} {UNITS[what]} at joints 1 to 6; as near by chance: p {chance:.2f}"
    return judged(lambda each: _off(each, true), real, text=text)


def _correlation(gains, true) -> np.ndarray:
    """Of the logarithms of median gains and of what should be there, over the joints."""
    kept = np.maximum(np.median(gains, axis=-2), LEAST * true)
    return _pearson(np.log(kept), np.log(true))


def _pearson(a, b) -> np.ndarray:
    a, b = (x - x.mean(-1, keepdims=True) for x in (np.asarray(a), np.asarray(b)))
    size = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    return (a * b).sum(-1) / np.where(size > 0, size, 1)


def _followed(statistic, real, nulls) -> Measured:
    chance = {n: p_value(float(statistic(real)), statistic(x[:, None]), "more")
              for n, x in nulls.items()}  # fmt: skip
    text = f"r {float(statistic(real)):.2f}; as high by chance: "
    text += ", ".join(f"{n} p {p:.2f}" for n, p in chance.items())
    return judged(statistic, real, text=text)


def gains_follow(what: str = "friction", width: int = 11) -> Measured:
    """Correlation over six joints of gains and of what the identified model has (judged).

    Of logarithms; a gain below a tenth of the identified value, or of the wrong sign, counts as
    that tenth. The replicates draw networks.

    Parameters
    ----------
    what : {"inertia", "friction"}
    width : int
        Window size.
    """
    found, (name, wanted) = row(width), WORTH[what]
    true = np.array(found["identified"][wanted])
    nulls = {n: np.array(x[name]) for n, x in found["nulls"].items()}
    return _followed(lambda g: _correlation(g, true), np.array(found["real"][name]), nulls)


def shares_follow(width: int = 21) -> Measured:
    """Correlation over six joints of velocity's share in a filter and friction's in the current.

    The filters are the direct weights from each joint to its own motor.

    Parameters
    ----------
    width : int
        Window size.
    """
    found, name = row(width), "share of velocity"
    true = np.array(found["friction"])
    nulls = {n: np.array(x[name]) for n, x in found["nulls"].items()}
    return _followed(
        lambda g: _pearson(np.median(g, axis=-2), true), np.array(found["real"][name]), nulls
    )


def compensate_friction(width: int = 21) -> Measured:
    """Share of the hidden units' non-linear part that friction and rigid body explain (judged).

    Median of six outputs; least squares takes out what is linear in the window.

    Parameters
    ----------
    width : int
        Window size.
    """
    found = np.array(row(width)["curved"])
    told = ", ".join(significant(x, 2) for x in np.median(found, 0))
    return judged(median, found, text=f"R² {told} at joints 1 to 6")
