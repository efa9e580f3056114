"""*Torques at run time*: what predicts the error of the hand (mm), and when loops turn."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from ddlib import paper
from ddlib.figures import (
    COLOURS,
    FAINT,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.setups import JOINT_DAMPING
from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median, rank_correlation

_MARKERS = "osD^v"

NETWORK = "network, window 21"  # the paper's best window

PREDICTORS = ("RMSS", "through the loop", "planned")  # of a network's end-point error

# Rivals that see the same windows of 21
_KINDS = (
    "identified", "linear filter", "Gaussian process", "Lagrangian network",
    "network, two hidden units",
)  # fmt: skip


def against(
    panels: dict[str, dict[str, tuple]], label: str, alt: str, equal: tuple[str, ...]
) -> Illustration:
    """A quantity over its predictors, both logarithmic: a panel each, a dot for each member.

    Of ``{x label: {group: (x, y)}}`` a group looks the same in every panel. Panels named in
    `equal`, whose predictor has the unit of the quantity, get a line of equal values.
    """
    names = list(dict.fromkeys(name for groups in panels.values() for name in groups))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        handles = {}
        for axis, (title, groups) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            for name, (x, y) in groups.items():
                k = names.index(name)
                look = {"color": COLOURS[k % len(COLOURS)], "ms": 4, "mew": 0, "alpha": 0.8}
                (handles[name],) = axis.plot(x, y, _MARKERS[k % len(_MARKERS)], **look)
            if title in equal:
                both = np.concatenate([np.ravel(values) for values in groups.values()])
                ends = [both.min(), both.max()]
                axis.plot(ends, ends, color=FAINT, ls="--", lw=1)
            axis.set_xlabel(check_label(title))
            plain_ticks(axis.xaxis)
            plain_ticks(axis.yaxis)
        axes[0].set_ylabel(check_label(label))
        legend_above(figure, [handles[name] for name in names], names)

    return illustrate(draw, alt, 7.0, 2.9)


def _reading(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found under one reading of the controller."""
    return results.read("run-time")["readings"][setup]


def errors(line: str = NETWORK, setup: str = JOINT_DAMPING.name, part: str = "whole") -> np.ndarray:
    """A score of a feedforward, like "whole" or "largest", a value for each member."""
    return np.array(_reading(setup)["square"][line][part])


# --- what predicts it ---------------------------------------------------------------------


def scatter(
    predictor: str = "RMSS", width: int | None = None, setup: str = JOINT_DAMPING.name
) -> tuple[np.ndarray, np.ndarray]:
    """A predictor and the end-point error of networks of one window, or of all together."""
    found = _reading(setup)["scatter"]
    cells = [found[str(width)]] if width else list(found.values())
    return tuple(np.concatenate([cell[n] for cell in cells]) for n in (predictor, "end point"))


def predicts(
    predictor: str = "RMSS", width: int | None = None, setup: str = JOINT_DAMPING.name
) -> Measured:
    """Rank correlation of a predictor with the end-point error, as in `scatter`."""
    pair = scatter(predictor, width, setup)
    return judged(
        lambda drawn: rank_correlation(*drawn),
        pair,
        text=lambda value: f"{value:.2f} over {len(pair[0])} networks",
    )


def predicts_better(first: str = "through the loop", setup: str = JOINT_DAMPING.name) -> Measured:
    """Least gain in rank correlation from RMSS to another predictor, over the paper's windows."""
    cells = []
    for width in paper.TABLE_4_1:
        (a, error), (b, _) = (scatter(name, width, setup) for name in (first, "RMSS"))
        cells.append((a, b, error))

    def least(*drawn):
        gains = [rank_correlation(a, e) - rank_correlation(b, e) for a, b, e in drawn]
        return np.min(gains, axis=0)

    each = [f"{rank_correlation(b, e):.2f} to {rank_correlation(a, e):.2f}" for a, b, e in cells]
    return judged(least, *cells, text=f"from {', from '.join(each)}")


def predicts_kind(setup: str = JOINT_DAMPING.name) -> Measured:
    """Rank correlation of RMSS and end-point error over kinds of model, each by its medians."""
    cells = [(errors(kind, setup, "RMSS"), errors(kind, setup)) for kind in _KINDS]
    cells.append(scatter("RMSS", 21, setup))

    def correlation(*drawn):
        pairs = [[median(x) for x in pair] for pair in drawn]
        return rank_correlation(*(np.stack(x, -1) for x in zip(*pairs)))

    return judged(
        correlation, *cells, text=lambda value: f"{value:.2f} over {len(cells)} kinds of model"
    )


# --- a model inside the loop ----------------------------------------------------------------


def _inside(loop: str, setup: str) -> tuple[np.ndarray, dict]:
    """Shares of the measured deviation that a model sees, and what a loop does by share."""
    return np.array(results.read("run-time")["shares"]), _reading(setup)["inside"][loop]


def unstable_at(setup: str = JOINT_DAMPING.name, late: int = 0) -> Measured:
    """The share of the median network at which the guard stops half of the runs."""
    shares, found = _inside(f"network, {late}", setup)
    stopped = np.array(found["stopped"]) >= 0.5
    first = np.where(stopped.any(-1), shares[stopped.argmax(-1)], np.inf)
    told = ", ".join("none" if np.isinf(x) else f"{x:g}" for x in first)
    return judged(median, np.minimum(first, 1e3), text=f"at {told}")


def onsets(line: str = "network", setup: str = JOINT_DAMPING.name) -> tuple[np.ndarray, np.ndarray]:
    """Shares, by model, at which a loop with it inside turns: by its poles, and as simulated."""
    shares, found = _inside(f"{line}, 0", setup)
    poles, error = (np.array(found[name]) for name in ("poles", "error"))
    predicted = [_crossing(shares, row, 1.0) for row in poles]
    simulated = [_crossing(shares, row, 2 * row.min()) for row in error]
    return np.array(predicted), np.array(simulated)


def _crossing(shares: np.ndarray, values: np.ndarray, limit: float) -> float:
    """The share at which values rise above a limit, from where they are least."""
    calm = int(values.argmin())
    over = np.flatnonzero(values[calm:] > limit)
    if not over.size:
        return np.inf
    k = calm + over[0]
    return np.interp(limit, values[k - 1 : k + 1], shares[k - 1 : k + 1])


def onset() -> Measured:
    """The share at which poles say that the loop turns over the one at which it does."""
    pair = onsets()
    told = " and ".join(significant(float(np.median(x)), 2) for x in pair)
    return judged(lambda drawn: median(drawn[0] / drawn[1]), pair, text=f"shares {told}")
