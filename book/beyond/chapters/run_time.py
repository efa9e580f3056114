"""*Torques at run time*: numbers, figures and checks; what predicts the hand's error (mm)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from beyond.figures import maps
from beyond.studies.loop import fair_rivals
from ddlib import paper
from ddlib.figures import (
    FAINT,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    looks,
    plain_ticks,
)
from ddlib.setups import JOINT_DAMPING, JOINT_DAMPING_VISCOUS, STATE_FEEDBACK
from ddlib.simulation import CONTROL_STEP
from ddlib.tables import quote, significant
from workshop.chapters.exercises import Exercise, judging
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, median, rank_correlation

_MARKERS = "osD^v"

NETWORK = "network, window 21"  # the paper's best window

_SETUPS = (JOINT_DAMPING.name, STATE_FEEDBACK.name)

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
                look = {"color": looks(names)[name].colour, "ms": 4, "mew": 0, "alpha": 0.8}
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
    by_window = _reading(setup)["scatter"]
    cells = [by_window[str(width)]] if width else list(by_window.values())
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
    shares, inside = _inside(f"network, {late}", setup)
    stopped = np.array(inside["stopped"]) >= 0.5
    first = np.where(stopped.any(-1), shares[stopped.argmax(-1)], np.inf)
    words = ", ".join("none" if np.isinf(x) else f"{x:g}" for x in first)
    return judged(median, np.minimum(first, 1e3), text=f"at {words}")


def onsets(line: str = "network", setup: str = JOINT_DAMPING.name) -> tuple[np.ndarray, np.ndarray]:
    """Shares, by model, at which a loop with it inside turns: by its poles, and as simulated."""
    shares, inside = _inside(f"{line}, 0", setup)
    poles, error = (np.array(inside[name]) for name in ("poles", "error"))
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
    both = " and ".join(significant(float(np.median(x)), 2) for x in pair)
    return judged(lambda drawn: median(drawn[0] / drawn[1]), pair, text=f"shares {both}")


# --- the lesson ---------------------------------------------------------------------------


def _median(line: str, setup: str = JOINT_DAMPING.name, part: str = "whole") -> float:
    return float(np.median(errors(line, setup, part)))


def _quoted() -> None:
    """The numbers of the prose."""
    for tail, setup in zip(("", "-sf"), _SETUPS):
        reading, copies = _reading(setup), results.read("loop-conditions")["copies"][setup]
        lines = {
            "none": "none",
            NETWORK: "network",
            "exact": "exact",
            "exact, window 21": "exact-21",
        }
        for line, name in lines.items():
            quote(f"run-time-{name}{tail}", _median(line, setup))
        quote(f"run-time-copy-slow{tail}", np.median(copies["0.1"]))
        for line in ("exact", "network"):
            at = reading["corner"]["rounded"]["0.1"][line]
            quote(f"run-time-rounded-{line}{tail}", np.median(at))
        quote(f"run-time-late-pole{tail}", reading["inside"]["network, 5"]["poles"][0][0])
        one = results.read("run-time")["shares"].index(1.0)
        stopped = np.array(reading["inside"]["network, 5"]["stopped"])
        quote(f"run-time-late-stopped{tail}", 100 * np.mean(stopped[:, one]))
    pole = _reading()["inside"]["network, 5"]["poles"][0][0]
    quote("run-time-doubling", CONTROL_STEP * np.log(2) / np.log(pole))
    soft = JOINT_DAMPING_VISCOUS[0] / JOINT_DAMPING.controller.kp[0]
    quote("run-time-limit-shoulder", 1e3 * (soft - CONTROL_STEP / 2))
    quote("run-time-limit-both", 1e3 * fair_rivals.delay_margin(fair_rivals.POSITION_ALONE))
    quote("run-time-members", len(errors()))
    quote("run-time-runs", results.read("run-time")["points"] ** 2)
    for line in ("identified", "Lagrangian network"):
        quote(f"run-time-{line.split()[0]}", _median(line))
    for line in ("network", "none", "exact, window, knows"):
        heavy = np.median(_reading()["changed"]["load"]["10"][line])
        quote(f"run-time-load-{line.split()[-1]}", heavy)
    quote("run-time-inside-onset", np.median(onsets()[0]))


def square_figure() -> Illustration:
    """The first figure: the end-point error over the square of extents, by four feedforwards."""
    study = results.read("run-time")
    lines = {"no feedforward": "none", "network, window 21": NETWORK,
             "exact equations": "exact", "exact, through a window": "exact, window 21"}  # fmt: skip
    shape = (study["points"],) * 2
    square = _reading()["square"]
    grids = {title: np.reshape(square[line]["map"], shape) for title, line in lines.items()}
    medians = ", ".join(f"{title}, median {_median(line):.1f} mm" for title, line in lines.items())
    labels = ("extent of the shoulder, °", "extent of the elbow, °", "end-point error, mm")
    edge = np.array(study["extents"])[: study["points"], 1]
    return maps(edge, grids, labels, f"Maps over the extents of shoulder and elbow: {medians}.")


def _exercise(number: int, error=None) -> Exercise:
    """An exercise; `error` gives the end-point error (mm) of an answer."""
    if number == 1:
        zeta = 5.3 / (2 * np.sqrt(750.0 * 6.5))
        rho = np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2))
        gain = (1 + rho) / (1 - rho) / 750
        slips = [
            (1 / 750, "so far goes a torque that stays; one in step with the loop goes on."),
            ((1 + rho) / 750, "that is the first swing; all others follow."),
        ]
        return Exercise(
            "number",
            gain,
            "most of it is ringing.",
            slips,
            "Add up all swings of a step's answer.",
            unit="rad",
        )
    elif number == 2:
        slips = [(1, "then the torque would do nothing, and it pushes the wrong way.")]
        otherwise = "what is missing is the torque needed minus the torque given."
        return Exercise(
            "number",
            error(-1) / error(0),
            "twice the torque is missing.",
            slips,
            otherwise,
            0.15,
            infinite=True,
        )
    else:

        def short(seconds):
            return 0.01 < seconds <= 0.5 and error(seconds) < 0.5 < error(seconds / 2)

        otherwise = "above 0.5 mm, or half of it would do as well. What do the motors give?"
        return Exercise(
            "number", short, "the motors can give what is asked.", [], otherwise, unit="s"
        )


check = judging(_exercise)
