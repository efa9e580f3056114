"""Words of direction on the verdict, the landing page and the ledger, checked as they are made."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workshop.report.evidence.verdicts import bootstrap

# Share of the draws in which a statement about an ensemble has to hold. When it is written it
# should hold in nearly all; it stands until results made anew say something else.
SURE = 0.8


def stated(name: str, holds) -> None:
    """Check what a sentence of the page says in words ("larger", "most", "falls").

    `holds` is true or false, or so in each draw of an ensemble. `tests/support/bound_words.yml`
    names the sentence.
    """
    outcomes = np.asarray(holds)
    if outcomes.dtype != bool:
        raise TypeError(f"holds must be true or false, got {holds!r}")
    if not outcomes.mean() >= SURE:
        share = f"{100 * outcomes.mean():.0f} % of {outcomes.size}"
        raise AssertionError(f"{name!r} holds in {share}: a sentence of this page is not true")


def resampled(values, statistic: Callable = np.median, seed: int = 0) -> np.ndarray:
    """A statistic of an ensemble, in draws of as many networks with replacement (bootstrap)."""
    return bootstrap(lambda drawn: statistic(drawn, axis=-1), np.asarray(values, float), seed=seed)
