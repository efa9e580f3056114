"""*Joints three and four*, an evidence page: errors of arms of more joints, growth and filters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.figures import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    TONES,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.tables import Table, quote, significant, spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, bootstrap, judged, median

_MARKERS = "os^Dv*"

_DAMPED = "windows"  # part with the errors of window networks under joint damping


def ladders(
    panels: dict[str, dict[str, tuple]], labels: tuple[str, str], alt: str, level: float
) -> Illustration:
    """Errors over the size of a training set, both logarithmic: a line for each arm.

    Of ``{title: {arm: (sizes, errors)}}``, errors of shape (sizes, seeds), lines are medians, bars
    reach from the least to the largest. The error to be reached is dotted.
    """
    arms = list(dict.fromkeys(name for each in panels.values() for name in each))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharex=True, sharey=True, squeeze=False)[0]
        for axis, (title, each) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            axis.set_title(title)
            axis.axhline(level, color=FAINT, ls=":", lw=1.4)
            for name, (size, errors) in each.items():
                look = _look(arms.index(name))
                axis.plot(size, np.median(errors, 1), **look)
                ends = np.min(errors, 1), np.max(errors, 1)
                axis.vlines(size, *ends, color=look["color"], lw=1.0, alpha=0.5)
        plain_ticks(axes[0].xaxis)
        plain_ticks(axes[0].yaxis)
        figure.supxlabel(check_label(labels[0]))
        figure.supylabel(check_label(labels[1]))
        legend_above(figure, [Line2D([], [], **_look(k)) for k in range(len(arms))], arms)

    return illustrate(draw, alt, 6.4, 2.7)


def _look(k: int) -> dict:
    place = k % len(COLOURS)
    return {
        "color": COLOURS[place], "ls": DASHES[place], "marker": _MARKERS[place], "ms": 4, "lw": 1.8
    }  # fmt: skip


def gains_by_torque(inertia, real, unrelated, label: str, alt: str) -> Illustration:
    """Gains of networks on accelerations by pair of joints, beside the arm's inertia.

    Gains are of shape (networks, torque, joint); a bar holds the middle nine tenths of those that
    were trained on unrelated torques.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(inertia), sharey=True, squeeze=False)[0]
        place = np.arange(1, len(inertia) + 1)
        for j, axis in enumerate(axes):
            low, high = np.percentile(unrelated[:, j], (5, 95), axis=0)
            axis.bar(
                place, high - low, 0.6, low, color=FAINT, alpha=0.35, label="unrelated torques"
            )
            axis.hlines(inertia[j], place - 0.36, place + 0.36, color=INK, lw=1.8, label="the arm")
            for k, gains in enumerate(real[:, j]):
                x = place + 0.4 * (k / max(len(real) - 1, 1) - 0.5)
                name = "networks" if k == 0 else None
                axis.plot(x, gains, "o", color=TONES["network"], ms=3, mew=0, alpha=0.8, label=name)
            axis.set(title=f"torque {j + 1}", xticks=place)
            axis.grid(visible=False, axis="x")
        axes[0].set_ylabel(check_label(label))
        figure.supxlabel("acceleration of joint")
        legend_above(figure, *axes[0].get_legend_handles_labels())

    return illustrate(draw, alt, 6.4, 2.7)


def two_joints(reading: str, motions: int, kind: str = "closed loop", taps: int = 5) -> np.ndarray:
    """Test errors on two joints, one for each seed, by how motions are followed."""
    how = {"reading": reading, "motions": motions, "kind": kind, "taps": taps}
    return np.array(_row("closed loops", **how)["test"])


def _read(part: str):
    """A part of the result, like "windows" or "costs"."""
    return results.read("joints")[part]


def _row(part: str, **wanted) -> dict:
    """The one row of a part whose entries have these values."""
    rows = [r for r in _read(part) if all(r[key] == value for key, value in wanted.items())]
    (row,) = rows
    return row


def errors(joints: int, motions: int, what: str = "test", reading: str = _DAMPED) -> np.ndarray:
    """One error for each seed of a cell: "test", "training", or "linear" of a linear filter."""
    return np.array(_row(reading, joints=joints, motions=motions)[what])


def _ladder(joints: int, what: str = "test") -> tuple[np.ndarray, list[np.ndarray]]:
    """Numbers of motions that were tried with so many joints, and the `errors` of each."""
    rows = [r for r in _read(_DAMPED) if r["joints"] == joints]
    return np.array([r["motions"] for r in rows]), [np.array(r[what]) for r in rows]


def _numbers() -> list[int]:
    """Numbers of joints that were tried."""
    return sorted({row["joints"] for row in _read(_DAMPED)})


# --- growth -------------------------------------------------------------------------------


def _needed(joints: int, level: float) -> tuple[float, np.ndarray]:
    """Training motions from which on the median RMSS is below a level, and in each draw."""
    motions, cells = _ladder(joints)
    crossing = _crossing(motions, level)
    # a seed's motions are among those of its longer draws: seeds are drawn for a whole ladder
    replicates = bootstrap(lambda drawn: crossing(*drawn), tuple(cells), seed=joints)
    return float(crossing(*(c[None] for c in cells))[0]), replicates


def _crossing(motions, level) -> Callable:
    x = np.log(motions)

    def crossing(*cells):
        y = np.log(np.stack([median(c) for c in cells])) - np.log(level)
        crossed = np.full(y.shape[1], np.inf)
        for k in range(y.shape[1]):
            above = np.flatnonzero(y[:, k] > 0)
            last = above.max() if above.size else -1
            if last < 0:
                crossed[k] = motions[0]
            elif last + 1 < len(x):
                share = y[last, k] / (y[last, k] - y[last + 1, k])
                crossed[k] = np.exp(x[last] + share * (x[last + 1] - x[last]))
        return crossed

    return crossing


def law(level: float = 0.2) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Joints, motions that they need, exponents of a power law: medians first, then replicates."""
    joints = np.array([n for n in _numbers() if n >= 2])
    each = [_needed(n, level) for n in joints]
    motions = np.column_stack([np.append(value, drawn) for value, drawn in each])
    x = np.log(joints) - np.log(joints).mean()
    return joints, motions, np.log(motions) @ x / (x @ x)


def growth(level: float = 0.2) -> Measured:
    """Exponent of the motions needed for an RMSS over the number of joints, from two to seven."""
    _, motions, exponents = law(level)
    low, high = np.percentile(exponents[1:], [5, 95])
    shown = ", ".join(f"{m:.0f}" for m in motions[0])
    text = f"{exponents[0]:.1f} ({low:.1f} to {high:.1f}): {shown} motions"
    return Measured(float(exponents[0]), text, exponents[1:])


# --- filters --------------------------------------------------------------------------------


def scaled(kind: str = "real") -> tuple[np.ndarray, np.ndarray]:
    """Gains on acceleration, ``(networks, torque, joint)``, and the arm's inertia, as shares."""
    pairs = _read("pairs")
    unit = np.array(pairs["acceleration"]) / np.array(pairs["deviation"])[:, None]
    return np.array(pairs["gains"][kind]) * unit, np.array(pairs["inertia"]) * unit


def _together(kind: str) -> np.ndarray:
    """Correlation of each network's gains with inertia, over pairs of different joints."""
    gains, inertia = scaled(kind)
    pairs = ~np.eye(len(inertia), dtype=bool)
    return np.array([np.corrcoef(g[pairs], inertia[pairs])[0, 1] for g in gains])


def couplings(kind: str = "real") -> Measured:
    """Correlation of the gains by pairs of different joints with the arm's inertia."""
    real, null = _together("real"), _together("unrelated")
    text = f"{_spread(real)}; {_spread(null)} on unrelated torques"
    return judged(median, real if kind == "real" else null, text=text)


def _spread(x) -> str:
    return f"{significant(float(np.median(x)), 2)} ({min(x):.2g} to {max(x):.2g})"


# --- the page's numbers and figure ---------------------------------------------------------


def _further(each) -> np.ndarray:
    """Errors of joints 3 and 4 together, from errors by joint, one for each draw."""
    return np.sqrt(np.square(each)[:, 2:].mean(1))


def four_joints_table() -> Table:
    """Errors of four joints, median and range: by training, and of rivals on the same draws."""
    by_joint = {
        "as in the report": _row(_DAMPED, joints=4, motions=5)["by joint"],
        "training chosen": results.read("joints-chosen")["by joint"],
        "twenty motions": _row(_DAMPED, joints=4, motions=20)["by joint"],
    }
    rows = [
        (name, spread(each), spread(_further(by_joint[name])) if name in by_joint else "")
        for name, each in _draws().items()
    ]
    others = results.read("loop-conditions")["windows"]
    for windows in (750, 300):
        cell = spread(others[f"{windows} of twenty"])
        rows.append((f"twenty motions, {windows} windows, other draws", cell, ""))
    return Table(("four joints, error in the test", "all joints", "joints 3 and 4"), rows)


def _draws() -> dict[str, np.ndarray]:
    """Errors of four joints in the draws: by how a network was trained, and of rivals."""
    return {
        "as in the report": errors(4, 5),
        "linear filter": errors(4, 5, "linear"),
        "training chosen": np.array(results.read("joints-chosen")["test"]),
        "equations": np.array(_row("known structure", joints=4, motions=5)["test"]),
        "twenty motions": errors(4, 20),
    }


def _quoted() -> None:
    """The numbers of the prose."""
    quote("joints-owed-joint-4", 100 * _read("interactions")["4"][3])
    quote("joints-seeds", _read("seeds"))
    quote("joints-test-7-5", np.median(errors(7, 5)))
    chosen = results.read("joints-chosen")["test"]
    quote("joints-again-ahead", int((chosen < errors(4, 5, "linear")).sum()))
    costs = _read("costs")[-1]
    quote("joints-cost-network", costs["network"])
    quote("joints-cost-general", costs["Newton-Euler, general"])


def answer_figure() -> Illustration:
    """The first figure: errors by arm over motions, and of four joints in every draw."""

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2, sharey=True, width_ratios=(3, 2))
        for k, n in enumerate(_numbers()):
            motions, cells = _ladder(n)
            name = f"{n} joint" if n == 1 else f"{n} joints"
            left.plot(motions, np.median(cells, 1), label=name, **_look(k))
        left.set(xscale="log", yscale="log", xlabel="training motions", ylabel="RMSS in the test")
        for k, each in enumerate(_draws().values()):
            place = k + 0.05 * (np.arange(len(each)) - 4.5)
            right.plot(place, each, "o", color=COLOURS[_numbers().index(4)], ms=3, mew=0)
            right.plot([k - 0.3, k + 0.3], 2 * [np.median(each)], color=INK, lw=1.8)
        names = [name.replace(" ", "\n") for name in _draws()]
        names[0] = "as in\nreport"
        right.set_xticks(range(len(names)), names, fontsize=7.5)
        right.set_title("four joints")
        plain_ticks(left.xaxis)
        plain_ticks(left.yaxis)
        legend_above(figure, *left.get_legend_handles_labels())

    medians = ", ".join(f"{name} {np.median(each):.2f}" for name, each in _draws().items())
    alt = f"Errors of networks fall with the number of motions. Four joints, medians: {medians}."
    return illustrate(draw, alt, 7.2, 2.8)
