"""What the evidence page *What the random start decides* shows."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ddlib import figures
from ddlib.analysis import classify, decompose
from ddlib.learning import Weights, p_value
from ddlib.setups import SETUPS, STATE_FEEDBACK, train_windows
from ddlib.tables import Table, quote, significant
from workshop.report import results
from workshop.report.evidence.statements import resampled, stated
from workshop.report.studies.start import RANGES, agreement, chosen

PRINTED = "0 to 1"
"""Range of the inputs that the report prints."""

SHOWN = (1.0, 0.3, 0.1, 0.01)
"""Ranges whose unit the first figure shows."""


@cache
def cells(method: str = "descent", scaling: str = PRINTED) -> dict:
    """Cells of the study by reading, range and window."""
    name = "start" if method == "descent" else "start-solver"
    return results.read(name)["cells"][method][scaling]


def values(reading: str, size: float, width: int, *path: str, **where) -> np.ndarray:
    """What a cell keeps of its networks, shape (networks,)."""
    found = cells(**where)[reading][str(size)][str(width)]
    for name in path:
        found = found[name]
    return np.array(found, float)


def named(reading: str, size: float, width: int = 21, layer: str = "hidden", **where):
    """Share of a layer's filters with a name, for each network."""
    return 1 - values(reading, size, width, layer, "names", "not analysable", **where)


# --- one unit, four starts --------------------------------------------------------------------


def four_starts(unit: int = 0, seed: int = 0) -> figures.Illustration:
    """The same hidden unit, trained from random weights of four sizes, with its parts.

    One network each, by state feedback: an example, trained as the page is made.
    """
    recording = STATE_FEEDBACK.record()
    x = 10 * np.arange(-10, 11)
    rows = {}
    for size in SHOWN:
        setup = replace(STATE_FEEDBACK, initial=size)
        model, *_ = train_windows(setup, recording, 21, 1, seed=seed, progress=False)
        start = Weights.random(1, 21, initial=size, seed=seed)
        rows[size] = [w.hidden_weights[0, unit, 0] for w in (start, model.weights)]

    def draw(figure):
        axes = figure.subplots(1, len(rows))
        for axis, (size, (before, after)) in zip(axes, rows.items()):
            axis.plot(x, before, color=figures.FAINT, lw=1, label="before training")
            parts = decompose(after)
            axis.plot(x, after, color=figures.INK, lw=2, label="after training")
            axis.plot(x, parts.even, color=figures.COLOURS[0], ls="--", label="even part")
            axis.plot(x, parts.odd, color=figures.COLOURS[1], ls="-.", label="odd part")
            axis.set(title=f"start: ±{size:g}", xlabel="time, ms")
        axes[0].set_ylabel("weight")
        figures.legend_above(figure, *axes[0].get_legend_handles_labels())

    told = "; ".join(f"±{size:g}: {classify(after)}" for size, (_, after) in rows.items())
    alt = (
        "Weights of one hidden unit over its window of 21 samples, before and after training, in "
        f"four panels from the largest to the smallest start, with their names: {told}."
    )
    return figures.illustrate(draw, alt, 7.0, 2.5)


# --- which start agrees with the report -------------------------------------------------------


def agreement_table() -> Table:
    """Share of networks in which each remark of the report comes out, by range."""
    found = {
        size: [agreement(cells()[reading][str(size)]) for reading in SETUPS] for size in RANGES
    }
    rows = []
    for remark in found[RANGES[0]][0]:
        each = (100 * np.mean([cell[remark] for cell in found[size]]) for size in RANGES)
        rows.append((remark, *(f"{share:.0f} %" for share in each)))
    scores = chosen(cells())[1]
    rows.append(("remarks met, of 7", *(f"{scores[size]:.1f}" for size in RANGES)))
    for k, reading in enumerate(SETUPS):
        each = (sum(found[size][k].values()) for size in RANGES)
        rows.append((f"{reading} alone", *(f"{score:.1f}" for score in each)))
    return Table(("remark of the report", *(f"±{size:g}" for size in RANGES)), rows)


# --- what a large start hides -----------------------------------------------------------------

_PANELS = {
    "hidden filters with a name, %": lambda r, s, **w: 100 * named(r, s, **w),
    "roughness": lambda r, s, **w: values(r, s, 21, "hidden", "roughness", **w),
    "turn of hidden rows": lambda r, s, **w: values(r, s, 21, "turn", **w),
    "test error, RMSS": lambda r, s, **w: values(r, s, 21, "test", **w),
}


def by_range() -> figures.Illustration:
    """Names, roughness, turn of hidden rows and test error at window 21, by range and reading."""

    def draw(figure):
        axes = figure.subplots(1, len(_PANELS))
        for axis, (title, measure) in zip(axes, _PANELS.items()):
            for k, reading in enumerate(SETUPS):
                each = [np.quantile(measure(reading, s), (0.25, 0.5, 0.75)) for s in RANGES]
                low, middle, high = np.transpose(each)
                look = {"color": figures.COLOURS[k], "label": reading, "marker": "o", "ms": 3}
                axis.fill_between(RANGES, low, high, color=look["color"], alpha=0.15, lw=0)
                axis.plot(RANGES, middle, ls=figures.DASHES[k], **look)
            axis.set(title=title, xlabel="start, ±", xscale="log")
            if title.startswith(("roughness", "test")):
                axis.set_yscale("log")
        figures.legend_above(figure, *axes[0].get_legend_handles_labels(), ncols=3)

    ends = {
        title: "; ".join(
            f"{reading} {significant(np.median(measure(reading, RANGES[0])))} to "
            f"{significant(np.median(measure(reading, RANGES[-1])))}"
            for reading in SETUPS
        )
        for title, measure in _PANELS.items()
    }
    told = " ".join(f"{title}, from ±0.01 to ±1: {end}." for title, end in ends.items())
    return figures.illustrate(draw, f"Four panels over the range of the start. {told}", 7.0, 2.6)


# --- beside unrelated torques -----------------------------------------------------------------


def null_row(reading: str, size: float) -> dict:
    """Networks of the real torques and of unrelated ones, of one reading and range."""
    return results.read("start-nulls")["rows"][reading][str(size)]


def shares_beside(reading: str, size: float, name: str, layer: str = "hidden") -> dict:
    """Share of a layer's filters with a name, a value for each network, by kind of torques."""
    row = null_row(reading, size)
    return {kind: np.array(row[kind][layer]["names"][name]) for kind in row}


def p_more(reading: str, size: float, name: str, layer: str = "hidden") -> float:
    """The larger p-value of the two kinds of unrelated torques.

    How likely a network of unrelated torques has as large a share as those of the real torques
    have on average.
    """
    found = shares_beside(reading, size, name, layer)
    real = found.pop("real").mean()
    return max(p_value(real, null, "more") for null in found.values())


def beside_unrelated() -> figures.Illustration:
    """Shares of acceleration and of velocity filters, real torques beside unrelated ones."""
    sizes = results.read("start-nulls")["ranges"]
    kinds = {"real": "the arm's torques", "shifted": "shifted", "phases": "random phases"}

    def draw(figure):
        axes = figure.subplots(2, len(SETUPS), sharex=True, sharey=True)
        for row, name in zip(axes, ("acceleration", "velocity")):
            for axis, reading in zip(row, SETUPS):
                for k, (kind, label) in enumerate(kinds.items()):
                    for i, size in enumerate(sizes):
                        share = 100 * shares_beside(reading, size, name)[kind]
                        low, middle, high = np.quantile(share, (0.05, 0.5, 0.95))
                        at = i + 0.25 * (k - 1)
                        axis.plot([at, at], [low, high], color=figures.COLOURS[k], lw=3, alpha=0.4)
                        axis.plot(
                            at, middle, "os^"[k], color=figures.COLOURS[k], ms=5,
                            label=label if not i else None,
                        )  # fmt: skip
                axis.set_xticks(range(len(sizes)), [f"±{size:g}" for size in sizes])
                if name == "acceleration":
                    axis.set_title(reading)
            row[0].set_ylabel(f"{name} filters, %")
        figures.legend_above(figure, *axes[0, 0].get_legend_handles_labels(), ncols=3)

    told = []
    for reading in SETUPS:
        for size in sizes:
            found = shares_beside(reading, size, "acceleration")
            each = ", ".join(f"{kinds[k]} {100 * np.median(x):.0f} %" for k, x in found.items())
            told.append(f"{reading}, ±{size:g}: {each}")
    alt = (
        "Shares of hidden filters named acceleration and velocity at window 21, medians and the "
        f"middle 90 % of networks. Acceleration: {'; '.join(told)}."
    )
    return figures.illustrate(draw, alt, 7.0, 4.0)
