"""Section 5 beside fair nulls: networks trained on torques that are smooth and unrelated.

Read from the results "filter-trial" and "filter-trial-elsewhere". The replicates draw networks of
the real torques and draws of the surrogates; a p-value counts draws (`ddlib.learning.p_value`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddlib.analysis import CLASSES
from ddlib.evidence.verdicts import Measured, mean, median, over_members
from ddlib.experiments import TRIAL, results, split, true_states
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
    value, replicates = over_members(
        lambda one, *others: mean(one) - np.max([mean(x) for x in others], axis=0),
        real,
        *nulls.values(),
    )
    told = "; ".join(
        f"{n} {100 * x.mean():.0f} % (p {p_value(real.mean(), x, 'more'):.2f})"
        for n, x in nulls.items()
    )
    text = (
        f"{100 * real.mean():.0f} %; {told}; untrained {100 * of(found['untrained']).mean():.0f} %"
    )
    return Measured(value, text, replicates)


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
    value, replicates = over_members(
        lambda one, *others: median(one) - np.max([median(x) for x in others], axis=0),
        real,
        *nulls.values(),
    )
    told = "; ".join(f"{n} {significant(np.median(x), 2)}" for n, x in nulls.items())
    text = f"{significant(np.median(real), 2)}; {told}"
    return Measured(
        value,
        f"{text}; untrained {significant(np.median(found['untrained'][what]), 2)}",
        replicates,
    )
