"""What a measure returns, how sure its value is, and the verdict that follows.

A statistic over networks is one draw: another processor rounds otherwise, and 20,000 epochs of
descent make other networks of the same initial weights. So such a measure brings replicates of
its value, from a bootstrap over the networks, and its verdict is what most replicates get:

- The *fresh* verdict is the one that at least `DECIDED` of the replicates get, and "undecided"
  if none has so many.
- The *written* verdict, in ``book/claims.yml``, is the fresh one of the committed results, and is
  wrong if it is not (`judging`). Results made anew on another machine are another draw; there it
  *stands* until the replicates contradict it: a decided one while at least `STANDS` of them agree,
  "undecided" while no verdict has `_CONTRADICTS`. `claims.Claim.judge` knows which of both it is.

Measures without replicates, of exact mathematics or a deterministic simulation, have one value
and one verdict, and a written one that differs is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ddlib._check import integer, one_of

# All verdicts. The first three are decided by bands, best first.
VERDICTS = (
    "reproduced",
    "qualitative",
    "not reproduced",
    "undecided",
    "by construction",
    "not testable",
)

DRAWS = 2000  # Draws of a bootstrap

# Members from which a bootstrap draws at least: of fewer it has hardly any draws that differ
FEWEST = 5

DECIDED = 0.95  # Share of the draws that makes a verdict

# Share of the draws down to which a written verdict stands: below, they exclude it as surely as
# they had to agree before. Between two ensembles a value moves by 1.4 standard errors, so a
# verdict at the edge of being decided falls in 1 new ensemble of 100, where 0.8 would fell 29.
STANDS = 0.05

_CONTRADICTS = 1.0  # Share of the draws for one verdict that ends a written "undecided"


class Measured(NamedTuple):
    """What a measuring function returns."""

    value: float | bool
    text: str
    replicates: np.ndarray | None = None


def bootstrap(
    statistic: Callable, *cells, draws: int = DRAWS, seed: int = 0, nested: bool = False
) -> np.ndarray:
    """A statistic of members drawn with replacement, again and again, shape (draws,)."""
    integer("draws", draws, DRAWS)
    rng = np.random.default_rng(seed)
    drawn = _picked(cells, lambda n: rng.integers(0, n, (draws, n)), rng if nested else None)
    values = np.asarray(statistic(*drawn))
    if values.shape != (draws,):
        raise ValueError(
            f"statistic must give one number for each of {draws} draws, got shape {values.shape}"
        )
    return values


def _picked(cells, pick: Callable, rng=None) -> list:
    """The cells with members picked by ``pick(members)``, of shape ``(draws, members)``.

    With `rng` the members of each member are drawn, too.
    """
    drawn = []
    for cell in cells:
        parts = [np.asarray(part) for part in (cell if isinstance(cell, tuple) else (cell,))]
        members = {part.shape[0] for part in parts}
        if len(members) != 1 or not min(members):
            raise ValueError(f"cells must have the same members in a tuple, got {sorted(members)}")
        integer("members", *members, FEWEST)
        picked = (pick(*members),)
        if rng is not None:
            inner = parts[0].shape[1]
            picked = picked[0][..., None], rng.integers(0, inner, (*picked[0].shape, inner))
        parts = tuple(part[picked] for part in parts)
        drawn.append(parts if isinstance(cell, tuple) else parts[0])
    return drawn


def median(cell) -> np.ndarray:
    """Median over all members and all that is theirs, one for each draw."""
    return np.median(cell.reshape(len(cell), -1), axis=-1)


def mean(cell) -> np.ndarray:
    """Mean over all members and all that is theirs, one for each draw."""
    return cell.reshape(len(cell), -1).mean(-1)


def rank_correlation(first, second) -> np.ndarray:
    """Spearman's rank correlation along the last axis."""
    from scipy.stats import rankdata  # takes half a second; every page imports this module

    a, b = (rankdata(x, axis=-1) for x in (first, second))  # those drawn twice share a mean rank
    a, b = (x - x.mean(-1, keepdims=True) for x in (a, b))
    return (a * b).sum(-1) / np.sqrt((a**2).sum(-1) * (b**2).sum(-1))


def judged(
    statistic: Callable, *cells, text: str | Callable[[float], str], nested: bool = False
) -> Measured:
    """A statistic of all members with its replicates, and a text or a function of the value."""
    once = _picked(cells, lambda n: np.arange(n)[None])
    value = float(np.asarray(statistic(*once))[0])
    replicates = bootstrap(statistic, *cells, nested=nested)
    return Measured(value, text(value) if callable(text) else text, replicates)


def largest_median(*cells) -> np.ndarray:
    """The largest of the medians of some cells, one for each draw."""
    return np.max([median(cell) for cell in cells], axis=0)


def shares_of_draws(verdicts) -> dict[str, float]:
    """Share of the draws in which each verdict comes out, the most frequent first."""
    names, counts = np.unique(verdicts, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return {str(names[k]): float(counts[k] / counts.sum()) for k in order}


def share_told(share: float) -> str:
    """A share of the draws in words: no page says how much more than `DECIDED` it is.

    Networks trained anew, even from the same seeds on a processor that rounds otherwise, are
    another ensemble, and its share is another one.
    """
    if share > DECIDED:
        return f"more than {100 * DECIDED:.0f} %"
    if share < 1 - DECIDED:
        return f"less than {100 * (1 - DECIDED):.0f} %"
    return f"{100 * share:.0f} %"


def verdict_of_shares(shares: Mapping[str, float]) -> str:
    """The verdict that shares of draws give by themselves; "undecided" if none is decided."""
    best = max(shares, key=shares.get)
    return best if shares[best] >= DECIDED else "undecided"


def not_contradicted(written: str, shares: Mapping[str, float]) -> bool:
    """Whether shares of draws do not contradict a written verdict; see the module."""
    one_of("written", written, VERDICTS)
    if written == "undecided":
        return max(shares.values()) < _CONTRADICTS
    return shares.get(written, 0.0) >= STANDS


def turns_at(values, shares, level: float) -> float:
    """Value of an assumed parameter at which a claim would turn, from a few that were tried."""
    order = np.argsort(shares)
    log_values, log_shares = (np.log(np.asarray(x, dtype=float)[order]) for x in (values, shares))
    if not log_shares[0] <= np.log(level) <= log_shares[-1]:
        raise ValueError(f"shares must reach across {level:g}, got {np.exp(log_shares)}")
    return float(np.exp(np.interp(np.log(level), log_shares, log_values)))
