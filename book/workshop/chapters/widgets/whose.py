"""Two galleries of filters a round: which one learnt this arm's torques?"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import traitlets as t

from ddlib.analysis import classify
from ddlib.figures import TONES, illustrate
from ddlib.widgets.base import PageWidget
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded

_HERE = Path(__file__).parent

_COLUMNS = 5  # of a gallery


class GuessRound(NamedTuple):
    """Filters of two networks that see the same motion, ``(filters, samples)`` each."""

    own: np.ndarray  #: Of the network that learnt the arm's torques.
    other: np.ndarray  #: Of the one that learnt others.
    learnt: str  #: What the other one learnt: follows its letter.
    remark: str  #: A sentence after the answer.


class WhoseFilters(PageWidget):
    """Guess which of two galleries of filters learnt this arm's torques; the guesses are counted.

    Each filter is drawn as high as its own largest weight. Names by the rule come with the answer.

    Parameters
    ----------
    rounds : sequence of GuessRound
        One or more.
    seed : int
        Decides which side is the arm's.
    """

    _esm = bundle(_HERE / "whose.js")
    _css = styles(_HERE / "whose.css")

    round = t.Int(0, help="which round is shown, from 0").tag(sync=True)
    guesses = t.Unicode(help="A or B for each round, - where there is no guess").tag(sync=True)

    def __init__(self, rounds: Sequence[GuessRound], seed: int = 1):
        first = np.random.default_rng(seed).permutation(len(rounds)) % 2 == 0
        shown = [_shown(*pair) for pair in zip(rounds, first)]
        sides = [gallery["rows"] for gallery in shown[0]["galleries"]]
        alt = (
            "Two galleries of rows of weights, A and B. One belongs to a network that learnt the "
            f"arm's torques, the other one to a network that {rounds[0].learnt}."
        )
        spec = {"key": "whose", "title": "Which network learnt this arm?", "rounds": shown}
        self._keep(spec=spec, still=_still(sides, alt), still_alt=alt)
        super().__init__(guesses="-" * len(rounds))


def _shown(guess: GuessRound, own_first: bool) -> dict:
    galleries = [_gallery(guess.own, True), _gallery(guess.other, False)]
    return {
        "galleries": galleries if own_first else galleries[::-1],
        "learnt": guess.learnt,
        "remark": guess.remark,
    }


def _gallery(filters, arm: bool) -> dict:
    names = classify(filters).tolist()
    rows = filters / np.maximum(np.abs(filters).max(-1, keepdims=True), 1e-12)
    counts = [list(pair) for pair in Counter(names).most_common()]
    return {"arm": arm, "rows": rows.round(3).tolist(), "names": names, "counts": counts}


def _still(sides, alt: str) -> str:
    def draw(figure):
        for part, rows, letter in zip(figure.subfigures(1, 2), sides, "AB"):
            axes = part.subplots(-(-len(rows) // _COLUMNS), _COLUMNS).ravel()
            for axis in axes:
                axis.set_axis_off()
            for axis, row in zip(axes, rows):
                axis.plot(row, color=TONES["network"], lw=1.2)
                axis.set_ylim(-1.1, 1.1)
            part.suptitle(letter)

    return START + encoded(illustrate(draw, alt, 7.0, 2.6).svg)
