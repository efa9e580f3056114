"""What a page says in words ("larger", "most", "falls"), checked where the page is made."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workshop.report.evidence.verdicts import DRAWS, bootstrap

# Share of the draws in which a statement about an ensemble has to hold. When it is written it
# should hold in nearly all; it stands until results made anew say something else.
SURE = 0.8


def stated(name: str, holds, share: float = SURE) -> None:
    """Check what a sentence of the page says in words.

    `tests/support/bound_words.yml` names the sentence; a test fails on words of direction or order
    about trained outcomes that no such check stands behind.
    """
    outcomes = np.asarray(holds)
    if outcomes.dtype != bool:
        raise TypeError(f"holds must be true or false, got {holds!r}")
    if not 0.5 < share <= 1:
        raise ValueError(f"share must be over 0.5 and at most 1, got {share}")
    if not outcomes.size:
        raise ValueError("holds must not be empty")
    if outcomes.size == 1:
        share = 1.0
    if outcomes.mean() < share:
        draws = f", true in {100 * outcomes.mean():.0f} % of the draws" if outcomes.size > 1 else ""
        raise AssertionError(f"{name!r} is not so{draws}: a sentence of this page is not true")


def resampled(values, statistic: Callable = np.median, seed: int = 0) -> np.ndarray:
    """A statistic of an ensemble, in draws of as many networks with replacement (bootstrap), shape
    (DRAWS,).
    """
    values = np.asarray(values, dtype=float)
    if values.ndim != 1 or values.size < 2:
        raise ValueError(f"values must be at least two numbers in a row, got shape {values.shape}")
    if not np.isfinite(values).all():
        raise ValueError("values must be finite")
    return bootstrap(lambda drawn: statistic(drawn, axis=-1), values, draws=DRAWS, seed=seed)
