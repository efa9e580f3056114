"""What the evidence page *What the random start decides* shows."""

from __future__ import annotations

from functools import cache

import numpy as np

from ddlib import figures
from ddlib.learning import p_value
from ddlib.setups import (
    INITIAL,
    SETUPS,
    STATE_FEEDBACK,
    WINDOWS,
)
from ddlib.tables import Table, quote, significant
from workshop.chapters import planted
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged, mean, median
from workshop.report.studies.random_starts import RANGES, SOLVED, agreement, chosen

PRINTED = "0 to 1"
"""Range of the inputs that the report prints."""


@cache
def cells(method: str = "descent", scaling: str = PRINTED) -> dict:
    """Cells of the study by reading, range and window."""
    name = "start" if method == "descent" else "start-solver"
    return results.read(name)["cells"][method][scaling]


def values(reading: str, size: float, width: int, *path: str, **where) -> np.ndarray:
    """What a cell keeps of its networks, shape (networks,)."""
    cell = cells(**where)[reading][str(size)][str(width)]
    for name in path:
        cell = cell[name]
    return np.array(cell, float)


def named(reading: str, size: float, width: int = 21, layer: str = "hidden", **where):
    """Share of a layer's filters with a name, for each network."""
    return 1 - values(reading, size, width, layer, "names", "not analysable", **where)


# --- which start agrees with the report -------------------------------------------------------


def agreement_table() -> Table:
    """Share of networks in which each remark of the report comes out, by range."""
    agreements = {
        size: [agreement(cells()[reading][str(size)]) for reading in SETUPS] for size in RANGES
    }
    rows = []
    for remark in agreements[RANGES[0]][0]:
        each = (100 * np.mean([cell[remark] for cell in agreements[size]]) for size in RANGES)
        rows.append((remark, *(f"{share:.0f} %" for share in each)))
    scores = chosen(cells())[1]
    rows.append(("remarks met, of 7", *(f"{scores[size]:.1f}" for size in RANGES)))
    for k, reading in enumerate(SETUPS):
        each = (sum(agreements[size][k].values()) for size in RANGES)
        rows.append((f"{reading} alone", *(f"{score:.1f}" for score in each)))
    each = direct_scores().values()
    rows.append(("read of the direct weights", *(f"{score:.1f}" for score in each)))
    return Table(("remark of the report", *(f"±{size:g}" for size in RANGES)), rows)


def direct_scores() -> dict[float, float]:
    """How many remarks each range meets if they are read of the direct weights."""
    return {
        size: np.mean([sum(agreement(cells()[r][str(size)], "direct").values()) for r in SETUPS])
        for size in RANGES
    }


def agree_by_direct() -> tuple[float, float]:
    """The least and largest range within half a remark of the best, read of direct weights."""
    scores = direct_scores()
    near = [size for size, score in scores.items() if score >= max(scores.values()) - 0.5]
    return min(near), max(near)


# --- what a large start hides -----------------------------------------------------------------

_PANELS = {
    "filters with a name, %": lambda r, s, **w: 100 * named(r, s, **w),
    "roughness": lambda r, s, **w: values(r, s, 21, "hidden", "roughness", **w),
    "turn of hidden rows": lambda r, s, **w: values(r, s, 21, "turn", **w),
    "test error, RMSS": lambda r, s, **w: values(r, s, 21, "test", **w),
}

_LOGARITHMIC = {"roughness": (0.001, 0.01, 0.1, 1.0), "test error, RMSS": (0.03, 0.1, 0.3)}


def by_range() -> figures.Illustration:
    """Names, roughness, turn of hidden rows and test error at window 21, by range and reading."""

    def draw(figure):
        axes = figure.subplots(1, len(_PANELS))
        for axis, (title, measure) in zip(axes, _PANELS.items()):
            for reading in SETUPS:
                quartiles = [np.quantile(measure(reading, s), (0.25, 0.5, 0.75)) for s in RANGES]
                low, middle, high = np.transpose(quartiles)
                look = figures.looks(SETUPS)[reading]
                axis.fill_between(RANGES, low, high, color=look.colour, alpha=0.15, lw=0)
                axis.plot(RANGES, middle, label=reading, marker="o", ms=3, **look.line)
            axis.set(title=title, xlabel="start, ±", xscale="log")
            axis.set_xticks((0.01, 0.1, 1.0), ("0.01", "0.1", "1"))
            if title in _LOGARITHMIC:
                axis.set_yscale("log")
                axis.set_yticks(_LOGARITHMIC[title], map("{:g}".format, _LOGARITHMIC[title]))
            axis.minorticks_off()
        figures.legend_above(figure, *axes[0].get_legend_handles_labels())

    ends = {
        title: "; ".join(
            f"{reading} {significant(np.median(measure(reading, RANGES[0])))} to "
            f"{significant(np.median(measure(reading, RANGES[-1])))}"
            for reading in SETUPS
        )
        for title, measure in _PANELS.items()
    }
    ends_in_words = " ".join(f"{title}, from ±0.01 to ±1: {end}." for title, end in ends.items())
    return figures.illustrate(
        draw, f"Four panels over the range of the start. {ends_in_words}", 7.0, 2.6
    )


def lazy_table() -> Table:
    """By range: hidden filters with a name, and how far rows and tangent kernel move."""
    rows = []
    for size in RANGES:
        shares = (
            100 * np.mean([named(r, size, scaling=scaling).mean() for r in SETUPS])
            for scaling in (PRINTED, "-1 to 1")
        )
        medians = (
            np.median(values(STATE_FEEDBACK.name, size, 21, what)) for what in ("turn", "kernel")
        )
        texts = (*(f"{x:.0f} %" for x in shares), *(f"{x:.2f}" for x in medians))
        rows.append((f"±{size:g}", *texts))
    heads = ("named, inputs 0 to 1", "named, inputs −1 to 1", "turn, state feedback")
    return Table(("start", *heads, "kernel's change, state feedback"), rows)


# --- beside unrelated torques -----------------------------------------------------------------


_KINDS = {"real": "the arm's torques", "shifted": "shifted", "phases": "random phases"}


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
    shares = shares_beside(reading, size, name, layer)
    real = shares.pop("real").mean()
    return max(p_value(real, null, "more") for null in shares.values())


def beside_unrelated() -> figures.Illustration:
    """Shares of acceleration and of velocity filters, real torques beside unrelated ones."""
    sizes = results.read("start-nulls")["ranges"]
    tones = figures.looks(_KINDS.values())

    def draw(figure):
        axes = figure.subplots(2, len(SETUPS), sharex=True, sharey=True)
        for row, name in zip(axes, ("acceleration", "velocity")):
            for axis, reading in zip(row, SETUPS):
                for k, (kind, label) in enumerate(_KINDS.items()):
                    for i, size in enumerate(sizes):
                        share = 100 * shares_beside(reading, size, name)[kind]
                        low, middle, high = np.quantile(share, (0.05, 0.5, 0.95))
                        at = i + 0.25 * (k - 1)
                        axis.plot([at, at], [low, high], color=tones[label].colour, lw=3, alpha=0.4)
                        axis.plot(
                            at, middle, "os^"[k], color=tones[label].colour, ms=5,
                            label=label if not i else None,
                        )  # fmt: skip
                axis.set_xticks(range(len(sizes)), [f"±{size:g}" for size in sizes])
                if name == "acceleration":
                    axis.set_title(reading)
            row[0].set_ylabel(f"{name} filters, %")
        figures.legend_above(figure, *axes[0, 0].get_legend_handles_labels())

    medians = []
    for reading in SETUPS:
        for size in sizes:
            shares = shares_beside(reading, size, "acceleration")
            each = ", ".join(f"{_KINDS[k]} {100 * np.median(x):.0f} %" for k, x in shares.items())
            medians.append(f"{reading}, ±{size:g}: {each}")
    alt = (
        "Shares of hidden filters named acceleration and velocity at window 21, medians and the "
        f"middle 90 % of networks. Acceleration: {'; '.join(medians)}."
    )
    return figures.illustrate(draw, alt, 7.0, 4.0)


def velocity_table() -> Table:
    """Mean share of velocity filters in hidden units, by the torques, over readings and ranges."""
    sizes = results.read("start-nulls")["ranges"]
    rows = []
    for kind, label in _KINDS.items():
        shares = [shares_beside(r, s, "velocity")[kind].mean() for r in SETUPS for s in sizes]
        rows.append((label, f"{100 * np.mean(shares):.0f} %"))
    return Table(("torques", "velocity filters, of the hidden ones"), rows)


# --- what a small start costs -----------------------------------------------------------------


def errors_table() -> Table:
    """Errors in training and on trajectory 6 by reading and range, and how long training waits."""
    rows = []
    for reading in SETUPS:
        for size in RANGES:
            medians = [
                f"{np.median(values(reading, size, w, 'training')):.3f} / "
                f"{np.median(values(reading, size, w, 'test')):.3f}"
                for w in WINDOWS
            ]
            wait = np.median(values(reading, size, 21, "until half"))
            rows.append((reading, f"±{size:g}", *medians, f"{wait:,.0f}"))
    heads = (f"window {w}, training / test" for w in WINDOWS)
    return Table(("reading", "start", *heads, "epochs until 0.5"), rows)


def solver_table() -> Table:
    """Names of hidden filters and test error by the solver, with white inputs and without."""
    rows = []
    for reading in SETUPS:
        for size in SOLVED:
            row = [reading, f"±{size:g}"]
            for method in ("solver", "solver, white inputs"):
                share = 100 * named(reading, size, method=method).mean()
                error = np.median(values(reading, size, 21, "test", method=method))
                row += [f"{share:.0f} %", f"{error:.3f}"]
            rows.append(row)
    heads = ("plain: named", "test error", "white inputs: named", "test error")
    return Table(("reading", "start", *heads), rows)


# --- what the page says and claims ------------------------------------------------------------


def more_names(small: float = 0.03, large: float = 0.3) -> Measured:
    """Share of hidden filters with a name from a small start less that from a large one.

    At window 21, in the reading where the difference is least.
    """
    pairs = [tuple(named(r, s) for s in (small, large)) for r in SETUPS]
    compared = (f"{100 * a.mean():.0f} % against {100 * b.mean():.0f} %" for a, b in pairs)

    def least(*drawn):
        return np.min([mean(a) - mean(b) for a, b in zip(drawn[::2], drawn[1::2])], axis=0)

    return judged(least, *(cell for pair in pairs for cell in pair), text=_by_reading(compared))


def turned(small: float = 0.03, large: float = 1.0) -> Measured:
    """Turn of hidden rows from a small start less that from a large one, the least of readings."""
    return _difference("turn", small, large)


def kernel_moved(small: float = 0.03, large: float = 1.0) -> Measured:
    """Change of the tangent kernel from a small start less that from a large one, the least."""
    return _difference("kernel", small, large)


def _difference(what: str, small: float, large: float) -> Measured:
    pairs = [tuple(values(r, s, 21, what) for s in (small, large)) for r in SETUPS]
    compared = (f"{np.median(a):.2f} against {np.median(b):.2f}" for a, b in pairs)

    def least(*drawn):
        return np.min([median(a) - median(b) for a, b in zip(drawn[::2], drawn[1::2])], axis=0)

    return judged(least, *(cell for pair in pairs for cell in pair), text=_by_reading(compared))


def better_tests(small: float = 0.03, large: float = 0.3) -> Measured:
    """Test error at window 21 from a small start over that from a large one, the worst reading."""
    pairs = [tuple(values(r, s, 21, "test") for s in (small, large)) for r in SETUPS]
    compared = (f"{np.median(a):.3f} against {np.median(b):.3f}" for a, b in pairs)

    def worst(*drawn):
        return np.max([median(a) / median(b) for a, b in zip(drawn[::2], drawn[1::2])], axis=0)

    return judged(worst, *(cell for pair in pairs for cell in pair), text=_by_reading(compared))


def beyond_unrelated() -> Measured:
    """The largest p-value, over readings and ranges, of acceleration filters of real torques."""
    sizes = results.read("start-nulls")["ranges"]
    p_values = {(r, s): p_more(r, s, "acceleration") for r in SETUPS for s in sizes}
    (reading, size), most = max(p_values.items(), key=lambda item: item[1])
    text = f"p at most {most:.3f} ({reading}, ±{size:g}), at least {min(p_values.values()):.3f}"
    return Measured(most, text)


def velocity_beyond_unrelated() -> Measured:
    """The smallest p-value, over readings and ranges, of velocity filters of the real torques."""
    sizes = results.read("start-nulls")["ranges"]
    p_values = {(r, s): p_more(r, s, "velocity") for r in SETUPS for s in sizes}
    (reading, size), least = min(p_values.items(), key=lambda item: item[1])
    return Measured(least, f"p at least {least:.3f} ({reading}, ±{size:g})")


def _by_reading(texts) -> str:
    return "; ".join(f"{reading} {text}" for reading, text in zip(SETUPS, texts))


def _quoted() -> None:
    """The numbers of the page's prose."""
    best = chosen(cells())[0]
    quote("start-chosen", f"{best:g}")
    quote("start-initial", f"{INITIAL:g}")
    walk = results.read("filter-trial")["windows"]["21"]
    unnamed = np.mean(walk["real"]["hidden"]["classes"]["not analysable"])
    quote("start-walk-named", 100 * (1 - unnamed))
    quote("start-walk-test", float(np.median(np.array(walk["real, errors"])[:, 1])))
    nulls = results.read("start-nulls")
    quote("start-draws", nulls["draws"])
    places = [(r, s) for r in SETUPS for s in nulls["ranges"]]
    p = {place: p_more(*place, "acceleration") for place in places}
    clear = [place for place in places if p[place] < 0.05]
    in_cases = f"In {len(clear)} of {len(places)} cases"
    if len(clear) == len(places):
        in_cases = f"In all {len(places)} cases"
    quote(
        "start-nulls-told",
        f"{in_cases} fewer than one in twenty of the unrelated networks have as many acceleration "
        "filters as the real ones have on average.",
    )
    direct = shares_beside(STATE_FEEDBACK.name, best, "acceleration", "direct")
    unrelated = np.concatenate([direct[kind] for kind in ("shifted", "phases")])
    quote("start-direct-unrelated", 100 * unrelated.mean())
    least, most = agree_by_direct()
    quote("start-direct-least", f"{least:g}")
    quote("start-direct-most", f"{most:g}")
    inertia = {place: np.median(null_row(*place)["real"]["M11"]) for place in places}
    for reading in SETUPS:
        found = [inertia[reading, size] for size in nulls["ranges"]]
        quote(f"start-inertia-{reading.split()[0]}-least", min(found))
        quote(f"start-inertia-{reading.split()[0]}-most", max(found))
    off = [planted.elbow_of_the_other(row) for row in SETUPS]
    quote("start-elbow-least", 100 * min(off))
    quote("start-elbow-most", 100 * max(off))
    longer = values(STATE_FEEDBACK.name, INITIAL, 21, "M11")
    quote("start-inertia-state-longer", np.median(longer))
    unrelated = [null_row(*p)[kind]["M11"] for p in places for kind in ("shifted", "phases")]
    quote("start-inertia-null", float(np.median(np.concatenate(unrelated))))
    quote("start-inertia-arm", results.read("excitation")["cells"][0]["arm"])
