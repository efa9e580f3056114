"""The lesson *Convolution filters*: its numbers and answers, and figures of its evidence page."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib._check import finite_array, shaped
from ddlib.analysis import purest, shares, upright
from ddlib.figures.style import (
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)
from ddlib.learning import p_value
from ddlib.setups import JOINT_DAMPING
from ddlib.simulation import LOG_STEP
from ddlib.tables import quote
from ddlib.widgets.engine import builder
from workshop.chapters import excitation
from workshop.chapters.exercises import judge
from workshop.report import results
from workshop.report._measures import filter_trial as trial
from workshop.report.evidence.statements import resampled, stated


def trained_unit() -> np.ndarray:
    """The hidden filter purest in acceleration, of networks of damped joints by the solver."""
    every = results.networks(21, JOINT_DAMPING.name).weights.hidden_weights.reshape(-1, 21)
    return upright(purest(every, "acceleration"))


def _named(name: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Share of a name in the hidden filters of the trial: the arm's torques, and each null."""
    row = trial.row(21)
    nulls = {k: trial.share(x, "hidden", [name]) for k, x in trial.matched(row).items()}
    return trial.share(row["real"], "hidden", [name]), nulls


def _quoted() -> None:
    """Numbers of the lesson."""
    quote("filters-bend", 1e3 * LOG_STEP**2)
    quote("filters-encoder", 1e3 * builder.readings()[2])
    for width in (5, 11, 21):
        quote(f"filters-own-{width}", builder.score(builder.starts()[f"Savitzky–Golay, {width}"]))
    for name in ("velocity", "acceleration"):
        real, nulls = _named(name)
        means = {kind: 100 * each.mean() for kind, each in nulls.items()}
        quote(f"filters-{name}", 100 * real.mean())
        if name == "velocity":
            quote("filters-velocity-least", min(means.values()))
            quote("filters-velocity-most", max(means.values()))
        else:
            quote("filters-acceleration-most", max(means["shifted"], means["phases"]))
            quote("filters-acceleration-run", means["other run"])
    quote("filters-m11", np.median(np.array(trial.row(21)["real"]["gains"])[:, 0, 0, 2]))
    quote("filters-m11-arm", trial.arm_gains()[0, 0, 2])
    quote("filters-inertia-off", 100 * trial.calibrated("inertia", 21).value)
    quote("filters-off-by", excitation.half_foretold().value)


def _said() -> None:
    """What the lesson says in words about committed results."""
    lost, back = (
        np.array(excitation.cell(drive, 1.0)["descent"]["M11"])[-1]
        for drive in ("state feedback", "state feedback, two sines")
    )
    stated("filters-half-foretold", excitation.half_foretold().replicates < 3)
    every = results.read("excitation")["cells"]
    reached = [np.isfinite(excitation.half_measured(each)).all() for each in every]
    stated("filters-half-but-one", sum(reached) == len(every) - 1)
    stated("filters-swing-lost", resampled(lost) < resampled(back, seed=1) / 4)
    real, nulls = _named("velocity")
    stated("filters-velocity-no-more", resampled(real, np.mean) < min(map(np.mean, nulls.values())))
    real, nulls = _named("acceleration")
    chances = [p_value(real.mean(), nulls[kind], "more") for kind in ("shifted", "phases")]
    stated("filters-acceleration-more", max(chances) < 0.06)
    row = trial.row(21)
    inertia = [
        np.array(x["gains"])[:, 0, 0, 2] for x in (row["real"], *trial.matched(row).values())
    ]
    stated("filters-number-apart", min(inertia[0]) > max(map(max, inertia[1:])))
    study = results.read("targets")
    unnamed = {
        size: resampled(found["not analysable"], np.mean)
        for size, found in zip(study["initial"], study["by initial"]["real torques"])
    }
    stated("filters-start-hides", (unnamed[0.03] < 0.5) & (unnamed[0.3] > 0.5))
    stated("filters-own-difference", builder.score(builder.starts()["Second difference"]) > 0.9)
    places = list(trial.ENTRIES["inertia"].values())
    kinds = row["real"], row["nulls"]["shifted"], row["nulls"]["phases"]
    gains = (np.moveaxis(np.array(x["gains"]), 0, -1) for x in kinds)
    real, *nulls = (np.transpose([each[at] for at in places]) for each in gains)
    true = np.array([trial.arm_gains()[at] for at in places])
    stated("filters-no-null", max(trial.near_by_chance(x, real, true) for x in nulls) < 0.06)


def check(number: int, mine, x) -> None:
    """Judge an answer to an exercise; x is the time of the window's samples from its centre, s."""
    k = np.round(x / (x[1] - x[0]))
    if number == 1:
        slips = [(1.0, "that holds in a window of three. In this one the line runs on."),
                 (4 / (k @ k), "divide by the energy of the difference, too.")]  # fmt: skip
        judge(mine, 2 / (k @ k), "it measures velocity, but from two samples only.", slips,
              "divide the energy along the line by that of the whole filter.")  # fmt: skip
    elif number == 2:
        early = (k - 3) ** 2
        share = shares(early - early.mean())[2]
        judge(mine, lambda guess: abs(guess - share) < 0.1,
              f"{share:.2f} of its energy is left to acceleration, the rest is velocity.",
              otherwise="too far off: expand (k - 3)² and compare the parts.")  # fmt: skip
    elif number == 3:
        moments = np.array([x**0, x, x**2 / 2])
        wanted = np.array([0.0, 3.0, 2.0])
        least = np.linalg.pinv(moments) @ wanted

        def fits(g):
            return np.allclose(moments @ np.asarray(g, float), wanted, atol=1e-3)

        judge(mine, lambda g: fits(g) and np.sum(np.square(g)) < 1.001 * least @ least,
              "three moments, and no energy to spare.",
              [(fits, "the moments are right, but a filter of less energy has them, too.")],
              f"it needs {x.size} numbers with K = 0, B = 3 and M = 2.")  # fmt: skip


_TORQUES = {
    "real": "the arm's own", "shifted": "shifted in time", "other run": "another run's",
    "phases": "random phases",
}  # fmt: skip


def beside_unrelated(width: int = 21) -> Illustration:
    """Names and inertia of networks of the arm's torques, beside those of unrelated torques."""
    row, arm = trial.row(width), trial.arm_gains()[0, 0, 2]
    sets = {"real": row["real"], **trial.matched(row)}
    panels = {
        f"{name} filters, %": {
            kind: 100 * trial.share(found, "hidden", [name]) for kind, found in sets.items()
        }
        for name in ("velocity", "acceleration")
    }
    inertia = {kind: np.array(found["gains"])[:, 0, 0, 2] for kind, found in sets.items()}
    panels["inertia, kg m²"] = inertia

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True)
        for axis, (label, shown) in zip(axes, panels.items()):
            for k, (kind, values) in enumerate(shown.items()):
                _dots(axis, values, k, 0, kind, colour=COLOURS[min(k, 1)])
                axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(sets) - 0.5, -0.6))
        axes[-1].axvline(arm, color=INK, ls="--", lw=1.0)
        axes[-1].annotate(" the arm", (arm, -0.55), ha="right", va="top")
        axes[0].set_yticks(range(len(sets)), [_TORQUES[kind] for kind in sets])

    told = "; ".join(
        f"{label}: " + ", ".join(f"{_TORQUES[k]} {np.mean(x):.0f}" for k, x in shown.items())
        for label, shown in panels.items()
    )
    alt = f"Means of networks, by the torques that they were trained on. {told}; the arm {arm:.1f}."
    return illustrate(draw, alt, 7.0, 2.3)


def against_nulls(
    panels: Mapping[str, Mapping[str, Mapping[str, np.ndarray]]], label: str, alt: str
) -> Illustration:
    """Shares of filters under the real torques, as bars, and under nulls, a dot for each draw."""
    if not panels:
        raise ValueError("panels must hold one panel or more, got none")
    for groups in panels.values():
        for name, sets in groups.items():
            for values in sets.values():
                shape = finite_array(f"values of {name!r}", values).shape
                if len(shape) != 1:
                    raise ValueError(f"values of {name!r} must have shape (draws,), got {shape}")
    classes = list(next(iter(panels.values())))
    rows = -(-len(panels) // 3)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 3, squeeze=False, sharey=True)
        for axis, (title, groups) in zip(axes.ravel(), panels.items()):
            for row, sets in enumerate(groups.values()):
                (real, values), *nulls = sets.items()
                axis.barh(row, np.mean(values), 0.86, color=FAINT, alpha=0.35, label=real, lw=0)
                axis.plot([np.mean(values)] * 2, [row - 0.43, row + 0.43], color=INK, lw=2.0)
                for k, (name, draws) in enumerate(nulls):
                    height = row + (k - (len(nulls) - 1) / 2) * 0.26
                    _dots(axis, draws, height, k, name)
            axis.set(title=title, xlim=(-0.03, 1.03), ylim=(len(groups) - 0.5, -0.5))
            axis.grid(visible=False, axis="y")
        for axis in axes[:, 0]:
            axis.set_yticks(range(len(classes)), classes)
        for axis in axes[-1]:
            axis.set_xlabel(check_label(label))
        handles, names = axes[0, 0].get_legend_handles_labels()
        first = {name: handle for handle, name in zip(handles[::-1], names[::-1])}
        order = list(next(iter(next(iter(panels.values())).values())))
        for k, name in enumerate(order[1:]):
            first[name] = Line2D([], [], ls="", marker="os|"[k % 3], ms=4, color=COLOURS[k])
        legend_above(figure, [first[name] for name in order], order)

    return illustrate(draw, alt, 7.0, 0.6 + rows * (0.5 + 0.36 * len(classes)))


def _dots(axis: Axes, values, height: float, k: int, name: str, colour: str = ""):
    """One mark for each value, all in one path, since hundreds of markers are heavy."""
    at = np.unique(np.asarray(values, dtype=float))
    long = 0.09 if k % 3 == 2 else 1e-3  # discs, squares and strokes
    x, y = np.repeat(at, 3), np.tile([height - long, height + long, np.nan], at.size)
    cap = ("round", "projecting", "butt")[k % 3]
    axis.plot(x, y, color=colour or COLOURS[k % len(COLOURS)], alpha=0.7,
              lw=1.5 if k % 3 == 2 else 3.4,
              solid_capstyle=cap, label=name)  # fmt: skip


def by_explained(
    rows: Mapping[str, Mapping[str, np.ndarray]],
    courses: Mapping[str, Mapping[str, np.ndarray]],
    labels: tuple[str, str],
    alt: str,
) -> Illustration:
    """Shares of filters by target, and in mixtures by how much of them the windows explain.

    `rows` has for each target, the topmost first, sets of one value a network: of the first set all
    values and their mean are shown, of the others the means. Of each mixture in `courses` means,
    and the range of nine tenths of the networks, are shown at equal steps.
    """
    for name, sets in [*rows.items(), *courses.items()]:
        for what, values in sets.items():
            shaped(f"{what!r} of {name!r}", values, "(networks,)")

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2)
        for height, sets in enumerate(rows.values()):
            (first, values), *others = sets.items()
            mean = np.mean(values)
            _dots(left, values, height, 0, f"{first}, each network")
            ends = [height - 0.38, height + 0.38]
            left.plot([mean] * 2, ends, color=INK, lw=2.0, label=f"{first}, mean")
            for k, (name, other) in enumerate(others, 1):
                look = {"color": COLOURS[k], "mfc": "none", "ms": 4.5, "ls": ""}
                left.plot([np.mean(other)], [height], "sD^"[k % 3], label=f"{name}, mean", **look)
        left.set_yticks(range(len(rows)), list(rows))
        left.grid(visible=False, axis="y")
        left.set(title="By target", xlabel=check_label(labels[0]), ylim=(len(rows) - 0.4, -0.6))
        for k, (name, sets) in enumerate(courses.items(), 2):
            at = np.arange(len(sets)) + 0.1 * (k - 2)
            look = {"color": COLOURS[k], "marker": "os"[k % 2], "ls": DASHES[k - 2]}
            right.plot(at, [np.mean(x) for x in sets.values()], ms=4, label=name, **look)
            ends = np.transpose([np.quantile(x, (0.05, 0.95)) for x in sets.values()])
            right.vlines(at, *ends, color=COLOURS[k], lw=1.0)
            right.set_xticks(range(len(sets)), list(sets))
        right.set(title="Mixtures", xlabel=check_label(labels[1]), ylabel=labels[0])
        named = {}
        for axis in (left, right):
            handles, names = axis.get_legend_handles_labels()
            named |= dict(zip(names, handles))
        named[next(iter(named))] = Line2D([], [], ls="", marker="o", ms=4, color=COLOURS[0])
        legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 3.6, 4.8)
