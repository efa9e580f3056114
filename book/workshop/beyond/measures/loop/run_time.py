"""Torques at run time: end-point errors of feedforwards, read from the result "run-time".

An error is the distance of the hand from where it should be, in mm: the root mean square over a
motion, then the median over the square of extents. Members are networks, each on a day of its
own, or days; medians are over them, and replicates draw them anew.
"""

from __future__ import annotations

import numpy as np

from ddlib import paper
from ddlib.setups import JOINT_DAMPING
from ddlib.tables import significant
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median

NETWORK = "network, window 21"
"""The paper's best window."""

PREDICTORS = ("RMSS", "through the loop", "planned")
"""What could predict a network's end-point error, as the study names it."""


def reading(setup: str = JOINT_DAMPING.name) -> dict:
    """What the study found under one reading of the controller.

    Parameters
    ----------
    setup : str
        "joint damping" or "state feedback".
    """
    return results.read("run-time")["readings"][setup]


def errors(line: str = NETWORK, setup: str = JOINT_DAMPING.name, part: str = "whole") -> np.ndarray:
    """A score of a feedforward, a value for each member.

    Parameters
    ----------
    line : str
        As the study names it.
    setup : str
    part : str
        A score, like "whole", "start", "inside", "outside", "largest".
    """
    return np.array(reading(setup)["square"][line][part])


def side(kind: str, value: str, line: str, setup: str = JOINT_DAMPING.name) -> np.ndarray:
    """Errors of a feedforward in a side experiment, a value for each member.

    Parameters
    ----------
    kind : {"load", "friction", "delay", "gains", "rounded"}
    value : str
        As the study names it, like "10" kg.
    line : str
        Like "none", "exact", "exact, window", "network", "computed torque".
    setup : str
    """
    found = reading(setup)
    if kind == "rounded":
        return np.array(found["corner"]["rounded"][value][line])
    return np.array((found if kind == "gains" else found["changed"])[kind][value][line])


def over(first: np.ndarray, second: np.ndarray) -> Measured:
    """Median of one group of errors over that of another.

    Parameters
    ----------
    first, second : array_like, shape (members,)
        mm.
    """
    text = " and ".join(f"{significant(float(np.median(x)), 2)} mm" for x in (first, second))
    return judged(lambda a, b: median(a) / median(b), np.array(first), np.array(second), text=text)


def ratio(
    first: str = NETWORK,
    second: str = "none",
    part: str = "whole",
    second_part: str | None = None,
    setup: str = JOINT_DAMPING.name,
) -> Measured:
    """Error of a feedforward over that of another.

    Parameters
    ----------
    first, second : str
        Lines of the study.
    part, second_part : str
        Scores of the first and the second; default: the same.
    setup : str
    """
    return over(errors(first, setup, part), errors(second, setup, second_part or part))


def side_ratio(
    kind: str,
    value: str,
    first: str = "network",
    second: str = "none",
    setup: str = JOINT_DAMPING.name,
) -> Measured:
    """The same in a side experiment.

    Parameters
    ----------
    kind, value : str
        As of `side`.
    first, second : str
        Lines.
    setup : str
    """
    return over(side(kind, value, first, setup), side(kind, value, second, setup))


def best_window(setup: str = JOINT_DAMPING.name) -> Measured:
    """Error with window 21 over the least with another of the paper's windows.

    Parameters
    ----------
    setup : str
    """
    cells = [errors(f"network, window {w}", setup) for w in paper.TABLE_4_1]
    told = ", ".join(significant(float(np.median(x)), 2) for x in cells)
    names = list(paper.TABLE_4_1)
    own = names.index(21)

    def least(*drawn):
        each = [median(x) for x in drawn]
        others = [x for k, x in enumerate(each) if k != own]
        return each[own] / np.min(others, axis=0)

    return judged(least, *cells, text=f"{told} mm at {', '.join(map(str, names))}")


def rate(between: str = "hold", setup: str = JOINT_DAMPING.name) -> Measured:
    """Error when a torque comes every 10 ms over that with a window for every control sample.

    Parameters
    ----------
    between : {"hold", "line", "2 ms apart"}
        What is done between; or windows of samples that lie a control period apart.
    setup : str
    """
    found = reading(setup)["rates"]
    return over(np.array(found[between]), np.array(found["window"]))


def hidden_by_feedback(
    against: str = "none", setup: str = JOINT_DAMPING.name, stiff: str = "1", soft: str = "0.0625"
) -> Measured:
    """A network's error over another feedforward's under stiff feedback, over that under soft.

    Parameters
    ----------
    against : str
        The other feedforward.
    setup : str
    stiff, soft : str
        Factors on the gains, as the study names them.
    """
    cells = [side("gains", f, n, setup) for f in (stiff, soft) for n in ("network", against)]

    def change(a, b, c, d):
        return median(a) / median(b) / (median(c) / median(d))

    low, high = (float(np.median(a) / np.median(b)) for a, b in (cells[:2], cells[2:]))
    told = f"{significant(low, 2)} times at {stiff} of the gains, {significant(high, 2)} at {soft}"
    return judged(change, *cells, text=told)


# --- what predicts it ---------------------------------------------------------------------


def scatter(
    predictor: str = "RMSS", width: int | None = None, setup: str = JOINT_DAMPING.name
) -> tuple[np.ndarray, np.ndarray]:
    """A predictor and the end-point error of networks, mm, both of shape (networks,).

    Parameters
    ----------
    predictor : str
        One of `PREDICTORS`.
    width : int, optional
        Window size; default: networks of all windows together.
    setup : str
    """
    found = reading(setup)["scatter"]
    cells = [found[str(width)]] if width else list(found.values())
    return tuple(np.concatenate([cell[n] for cell in cells]) for n in (predictor, "end point"))


def _ranks(x: np.ndarray) -> np.ndarray:
    """Mean ranks along the last axis: of equal values, as a draw has them, the same."""
    below = (x[..., None, :] < x[..., None]).sum(-1)
    return below + ((x[..., None, :] == x[..., None]).sum(-1) - 1) / 2


def rank_correlation(first, second) -> np.ndarray:
    """Spearman's rank correlation along the last axis.

    Parameters
    ----------
    first, second : array_like, shape (..., members)
    """
    a, b = (_ranks(np.asarray(x, float)) for x in (first, second))
    a, b = (x - x.mean(-1, keepdims=True) for x in (a, b))
    return (a * b).sum(-1) / np.sqrt((a**2).sum(-1) * (b**2).sum(-1))


def predicts(
    predictor: str = "RMSS", width: int | None = None, setup: str = JOINT_DAMPING.name
) -> Measured:
    """Rank correlation of a predictor with the end-point error.

    Parameters
    ----------
    predictor, width, setup
        As of `scatter`.
    """
    pair = tuple(scatter(predictor, width, setup))
    return judged(
        lambda drawn: rank_correlation(*drawn),
        pair,
        text=lambda value: f"{value:.2f} over {len(pair[0])} networks",
    )


def predicts_better(
    first: str = "through the loop", second: str = "RMSS", setup: str = JOINT_DAMPING.name
) -> Measured:
    """Least gain in rank correlation from one predictor to another, over the paper's windows.

    Parameters
    ----------
    first, second : str
        Of `PREDICTORS`.
    setup : str
    """
    cells = []
    for width in paper.TABLE_4_1:
        (a, error), (b, _) = (scatter(name, width, setup) for name in (first, second))
        cells.append((a, b, error))

    def least(*drawn):
        gains = [rank_correlation(a, e) - rank_correlation(b, e) for a, b, e in drawn]
        return np.min(gains, axis=0)

    each = [f"{rank_correlation(b, e):.2f} to {rank_correlation(a, e):.2f}" for a, b, e in cells]
    return judged(least, *cells, text=f"from {', from '.join(each)}")


KINDS = (
    "identified", "linear filter", "Gaussian process", "Lagrangian network",
    "network, two hidden units",
)  # fmt: skip
"""Rivals that see the same windows of 21."""


def predicts_kind(setup: str = JOINT_DAMPING.name) -> Measured:
    """Rank correlation of RMSS and end-point error over kinds of model, each by its medians.

    Parameters
    ----------
    setup : str
    """
    found = reading(setup)
    rows = [found["square"][kind] for kind in KINDS]
    cells = [tuple(np.array(row[name]) for name in ("RMSS", "whole")) for row in rows]
    cells.append(scatter("RMSS", 21, setup))

    def correlation(*drawn):
        pairs = [[median(x) for x in pair] for pair in drawn]
        return rank_correlation(*(np.stack(x, -1) for x in zip(*pairs)))

    return judged(
        correlation, *cells, text=lambda value: f"{value:.2f} over {len(cells)} kinds of model"
    )


# --- stability ----------------------------------------------------------------------------


def within_bound(setup: str = JOINT_DAMPING.name) -> Measured:
    """Largest share of the linear loop's bound that a run uses, over networks and runs.

    Parameters
    ----------
    setup : str
    """
    share = np.array(reading(setup)["bound"]["share"])
    return judged(
        lambda drawn: drawn.max(-1), share, text=lambda value: f"{100 * value:.0f} % of the bound"
    )


def inside_share(setup: str = JOINT_DAMPING.name, share: float = 1.0, late: int = 0) -> Measured:
    """Error of a network inside the loop over its error as a plan, network by network.

    Parameters
    ----------
    setup : str
    share : float
        Of the measured deviation that it sees.
    late : int
        Delay of the loop, control periods.
    """
    found = np.array(reading(setup)["inside"][f"network, {late}"]["error"])
    at = list(_shares()).index(share)
    return judged(
        lambda drawn: median(drawn[..., 0] / drawn[..., 1]),
        found[:, [at, 0]],
        text=" and ".join(f"{significant(float(np.median(found[:, k])), 2)} mm" for k in (at, 0)),
    )


def _shares() -> tuple:
    return tuple(results.read("run-time")["shares"])


def stops_at(line: str = "network", setup: str = JOINT_DAMPING.name, late: int = 0) -> np.ndarray:
    """Least share at which the guard stops half of the runs or more, by model; infinite if none.

    Parameters
    ----------
    line : {"network", "exact, window"}
    setup : str
    late : int
    """
    stopped = np.array(reading(setup)["inside"][f"{line}, {late}"]["stopped"]) >= 0.5
    first = stopped.argmax(-1)
    return np.where(stopped.any(-1), np.array(_shares())[first], np.inf)


def unstable_at(setup: str = JOINT_DAMPING.name, late: int = 0) -> Measured:
    """The share of the median network at which the guard stops half of the runs.

    Parameters
    ----------
    setup : str
    late : int
    """
    found = stops_at("network", setup, late)
    told = ", ".join("none" if np.isinf(x) else f"{x:g}" for x in found)
    return judged(median, np.minimum(found, 1e3), text=f"at {told}")


def onsets(
    line: str = "network", setup: str = JOINT_DAMPING.name, late: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """Shares at which a loop with a model inside turns: by its poles, and as simulated.

    The first is where the largest pole leaves the unit circle, the second where the error doubles
    its least value; between the shares that were tried both go in straight lines. Infinite where
    it does not come so far.

    Parameters
    ----------
    line : {"network", "exact, window"}
    setup : str
    late : int

    Returns
    -------
    predicted, simulated : ndarray, shape (models,)
    """
    found = reading(setup)["inside"][f"{line}, {late}"]
    shares = np.array(_shares())
    poles, error = (np.array(found[name]) for name in ("poles", "error"))
    ends = []
    for values, level in ((poles, np.ones(len(poles))), (error, 2 * error.min(1))):
        each = []
        for row, limit in zip(values, level):
            calm = int(row.argmin())
            over = np.flatnonzero(row[calm:] > limit)
            if not over.size:
                each.append(np.inf)
                continue
            k = calm + over[0]
            each.append(np.interp(limit, row[k - 1 : k + 1], shares[k - 1 : k + 1]))
        ends.append(np.array(each))
    return ends[0], ends[1]


def onset(setup: str = JOINT_DAMPING.name, late: int = 0) -> Measured:
    """The share at which poles say that the loop turns over the one at which it does.

    Parameters
    ----------
    setup : str
    late : int
    """
    predicted, simulated = onsets("network", setup, late)
    told = " and ".join(significant(float(np.median(x)), 2) for x in (predicted, simulated))
    return judged(
        lambda drawn: median(drawn[0] / drawn[1]), (predicted, simulated), text=f"shares {told}"
    )
