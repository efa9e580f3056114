"""Filters on a real arm, their gains and shares, beside networks of unrelated currents."""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.analysis import CLASSES
from ddlib.learning import p_value
from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, mean, median

_NAMED = ("velocity", "acceleration", "velocity + acceleration")  # filters that the paper finds

# Gains of a network, and what the identified model has in their place
WORTH = {"inertia": ("acceleration", "inertia"), "friction": ("velocity", "slope")}

_UNITS = {"inertia": "A s²/rad", "friction": "A s/rad"}


def row(width: int) -> dict:
    """Networks of a window on the whole recording, and on unrelated currents."""
    return results.read("real-arm")["windows"][str(width)]


def _members(width: int, name: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """An entry of the networks, and of each kind of nulls."""
    found = row(width)
    return np.array(found["real"][name]), [np.array(x[name]) for x in found["nulls"].values()]


def _gains(what: str, width: int) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """What a gain is in the identified model, in the networks, and in each kind of nulls."""
    name, wanted = WORTH[what]
    return np.array(row(width)["identified"][wanted]), *_members(width, name)


def named(ensemble: dict) -> np.ndarray:
    """Share of an ensemble's filters that have one of the names in `_NAMED`."""
    which = [CLASSES.index(name) for name in _NAMED]
    hidden, direct = (
        np.array(ensemble["classes"][x])[:, which].sum(-1) for x in ("hidden", "direct")
    )
    return (paper.HIDDEN_UNITS * hidden + 6 * direct) / (paper.HIDDEN_UNITS + 6)


def excess(width: int = 21) -> Measured:
    """Share of velocity and acceleration filters, less the most that a kind of nulls gives."""
    found = row(width)
    real, nulls = named(found["real"]), {n: named(x) for n, x in found["nulls"].items()}
    told = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    before = 100 * named(found["untrained"]).mean()
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
    """How far gains on a joint's own motion are from the arm's, in the worst joint."""
    true, real, nulls = _gains(what, width)
    typical = np.median(_off(real[:, None], true))  # of one network, as each of the nulls is
    chance = max(p_value(typical, _off(x[:, None], true), "less") for x in nulls)
    pairs = zip(np.median(real, 0), true)
    told = ", ".join(f"{significant(a, 2)} for {significant(b, 2)}" for a, b in pairs)
    text = f"{told} {_UNITS[what]} at joints 1 to 6; as near by chance: p {chance:.2f}"
    return judged(lambda each: _off(each, true), real, text=text)


def _pearson(a, b) -> np.ndarray:
    a, b = (x - x.mean(-1, keepdims=True) for x in (np.asarray(a), np.asarray(b)))
    size = np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1)
    return (a * b).sum(-1) / np.where(size > 0, size, 1)


def beyond_null(what: str = "friction", width: int = 11) -> Measured:
    """At how many joints the typical gain is nearer the identified one than 19 of 20 nulls."""
    true, real, nulls = _gains(what, width)
    edge = np.min([np.percentile(np.abs(x / true - 1), 5, axis=0) for x in nulls], axis=0)

    def joints(drawn):
        return (np.median(np.abs(drawn / true - 1), axis=-2) < edge).sum(-1)

    off = np.median(np.abs(real / true - 1), 0)
    told = ", ".join(f"{100 * a:.0f} % ({100 * b:.0f} %)" for a, b in zip(off, edge))
    return judged(joints, real, text=f"off by {told} at joints 1 to 6, in brackets by chance")


def follow(what: str = "friction", width: int = 11) -> Measured:
    """Correlation over joints of gains with identified values, less that by chance (95 %)."""
    unit = np.array(row(width)["deviations"][WORTH[what][0]])
    true, real, nulls = _gains(what, width)
    true, real = true * unit, real * unit
    chance = max(float(np.percentile(_pearson(x * unit, true), 95)) for x in nulls)
    r = np.median(_pearson(real, true))
    return judged(
        lambda drawn: np.median(_pearson(drawn, true), axis=-1) - chance,
        real,
        text=f"r {r:.2f}; unrelated currents reach {chance:.2f} in one of twenty",
    )


def unique_beyond(what: str = "velocity", width: int = 21) -> Measured:
    """At how many joints the own filter follows a quantity more than 19 of 20 nulls."""
    real, nulls = _members(width, f"unique {what}")
    edge = np.max([np.percentile(x, 95, axis=0) for x in nulls], axis=0)
    pairs = zip(np.median(real, 0), edge)
    told = ", ".join(f"{100 * a:.0f} ({100 * b:.0f})" for a, b in pairs)
    return judged(
        lambda drawn: (np.median(drawn, axis=-2) > edge).sum(-1),
        real,
        text=f"{told} % at joints 1 to 6, in brackets by chance",
    )


def shares_follow(width: int = 21) -> Measured:
    """Correlation over joints of velocity's share in the own filter and friction's in current."""
    true, (real, nulls) = np.array(row(width)["friction"]), _members(width, "share of velocity")
    r = float(_pearson(np.median(real, 0), true))
    typical = np.median(_pearson(real, true))  # of one network, as each of the nulls is
    chance = max(p_value(typical, _pearson(x, true), "more") for x in nulls)
    text = f"r {r:.2f}; as high by chance: p {chance:.2f}"
    return judged(lambda drawn: _pearson(np.median(drawn, axis=-2), true), real, text=text)


def compensate_friction(width: int = 21) -> Measured:
    """Share of the hidden units' non-linear part that friction and rigid body explain."""
    found = row(width)
    curved = np.array(found["curved"])
    told = ", ".join(significant(x, 2) for x in np.median(curved, 0))
    nulls = [np.median(x["curved"], axis=-1) for x in found["nulls"].values()]
    chance = max(float(np.percentile(x, 95)) for x in nulls)
    text = f"R² {told} at joints 1 to 6; unrelated currents reach {chance:.2f} in one of twenty"
    return judged(median, curved, text=text)
