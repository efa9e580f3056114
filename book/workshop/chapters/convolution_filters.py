"""The lesson *Convolution filters*: its numbers and answers, and figures of its evidence page."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.analysis import DERIVATIVES, classify, decompose, purest, roughness, shares, upright
from ddlib.figures.style import (
    FAINT,
    INK,
    JOINTS,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    looks,
)
from ddlib.setups import JOINT_DAMPING, split, true_states
from ddlib.simulation import LOG_STEP
from ddlib.tables import Table, quote
from workshop.chapters.exercises import Between, Exercise, judging
from workshop.chapters.index import both
from workshop.chapters.widgets import builder
from workshop.chapters.widgets.bench import FoldBench as FoldBench
from workshop.chapters.widgets.builder import FilterBuilder as FilterBuilder
from workshop.report import results
from workshop.report.measures import filter_trial as trial


def trained_unit() -> np.ndarray:
    """The hidden filter purest in acceleration, of networks of damped joints by the solver."""
    every = results.networks(21, JOINT_DAMPING.name).weights.hidden_weights.reshape(-1, 21)
    return upright(purest(every, "acceleration"))


_REPORT = {
    "Figure 5-4": (21, 1, "velocity", "“a simple velocity filter”"),
    "Figure 5-5": (21, 0, "acceleration", "“a simple acceleration filter”"),
    "Figure 5-6": (21, 1, "velocity + acceleration",
                   "“a linear combination of velocity and acceleration”"),
    "Figure 5-7": (41, 1, "acceleration + jerk", "rough edges; acceleration, jerk, and noise"),
    "Figure 5-8": (41, 0, "not analysable", "weights that “do not decompose cleanly”"),
}  # fmt: skip
"""Window, joint whose positions are weighted, name and words of each of the report's rows."""


def reported() -> dict[str, np.ndarray]:
    """A row for each of the report's Figures 5-4 to 5-8, from networks trained by its recipe.

    Of the report's joint; at window 21 the purest of a name, at 41, where the report shows rough
    edges, the roughest.
    """
    filters = {}
    for figure, (width, joint, name, _) in _REPORT.items():
        rows = results.networks(width).weights.hidden_weights[..., joint, :].reshape(-1, width)
        if width == 21:
            f = purest(rows, name)
        else:
            fitting = rows[classify(rows) == name]
            f = fitting[roughness(fitting).argmax()]
        filters[figure] = upright(f)
    return filters


def panels() -> dict[str, np.ndarray]:
    """The rows of `reported` by figure and joint."""
    return {f"{figure}, {JOINTS[_REPORT[figure][1]]}": f for figure, f in reported().items()}


def said_and_seen() -> Table:
    """What the report says of its Figures 5-4 to 5-8, and what the rows of `reported` hold."""
    rows = []
    for figure, f in reported().items():
        energy = zip((*DERIVATIVES, "rest"), shares(f))
        cell = ", ".join(f"{name} {100 * share:.0f}" for name, share in energy if share > 0.05)
        rows.append((figure, _REPORT[figure][3], cell, str(classify(f))))
    heads = "figure", "what the report says", "what we see, % of the energy", "name by the rule"
    return Table(heads, rows)


def carried() -> np.ndarray:
    """The row that goes on to the next lessons, per radian of its joint."""
    model = results.median_network(21, JOINT_DAMPING.name)
    unit, joint = both(model.weights)
    return model.inputs.gain[joint] * model.weights.hidden_weights[unit, joint]


def puzzles() -> dict[str, np.ndarray]:
    """Our row; then those of Figures 5-6, 5-4 and 5-5 without their names.

    Each is per radian of its joint.
    """
    gain, filters = results.networks(21).inputs.gain, reported()
    rows = {"our row": carried()}
    for label, figure in {"A": "Figure 5-6", "B": "Figure 5-4", "C": "Figure 5-5"}.items():
        rows[label] = gain[_REPORT[figure][1]] * filters[figure]
    return rows


def motion() -> np.ndarray:
    """Angle, velocity, acceleration of the shoulder on trajectory 6, ``(time, 3)``, rad and s."""
    return true_states(split(JOINT_DAMPING.record())[1], JOINT_DAMPING)[:, 0]


def named_in_trial(name: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
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
        quote(f"filters-{name}", 100 * named_in_trial(name)[0].mean())
    for name, share in zip(("carried", "carried-bend"), shares(carried())[1:3]):
        quote(f"filters-{name}", 100 * share)
    row = carried() / abs(carried()).max()
    quote("filters-row", ", ".join(f"{w:.2f}".replace("-", "−") for w in row))
    parts = decompose(row)
    for name, value in zip(("constant", "even", "odd"), parts):
        quote(f"filters-row-{name}", float(np.ravel(value)[-1]))
        if name != "constant":
            quote(f"filters-row-{name}-energy", 100 * float((value**2).sum() / (row**2).sum()))
    for layer, of, end in (("hidden", 0, ""), ("direct", 2, "-direct")):
        heard = np.mean(trial.row(21)["real"][layer]["strongest"], axis=0)
        quote(f"filters-follow{end}", 100 * heard[of])
    constant = shares(results.networks(21).weights.hidden_weights)[..., 0]
    quote("filters-constant", 100 * float(np.median(constant)))


def _exercise(number: int, given) -> Exercise:
    """An exercise, in a window of as many samples; `given` to the fourth its filters."""
    window = given.shape[1] if number == 4 else given
    k = np.arange(window) - window // 2.0
    if number == 1:
        slips = [
            (1.0, "this holds for a window of three. In a longer window the line runs on."),
            (4 / (k @ k), "divide by the energy of the difference as well."),
        ]
        return Exercise(
            "number",
            2 / (k @ k),
            "it measures velocity, but from two samples only.",
            slips,
            "divide the energy along the line by that of the whole filter.",
        )
    if number == 2:
        early = (k - 3) ** 2
        share = shares(early - early.mean())[2]
        return Exercise(
            "number",
            Between(share - 0.1, share + 0.1),
            f"{share:.2f} of its energy goes to acceleration, and the rest to velocity.",
            otherwise="this is too far off. Expand (k - 3)² and compare the parts.",
        )
    powers = np.stack([k**n / np.linalg.norm(k**n) for n in range(4)])

    def hears(f):
        return np.abs(powers @ f) / np.linalg.norm(f) > 1e-6

    if number == 4:
        right = np.array([np.argmax(hears(f)) for f in given])
        slips = [(right - 1, "a constant gain means position: its slope is 0, not 1.")]
        return Exercise(
            "numbers",
            right,
            "the slope of the gain is the number of the derivative.",
            slips,
            "double the frequency of a slow sine. Is the gain 2, 4 or 8 times as large?",
        )
    return Exercise(
        "array",
        lambda f: hears(f).tolist() == [False] * 3 + [True],
        "your filter answers to jerk, and to nothing of lower order.",
        [
            (
                lambda f: hears(f).tolist() == [False, True, False, True],
                "a cubic contains a line, so your filter also answers to velocity.",
            ),
            (lambda f: not hears(f)[3], "your filter does not answer to jerk."),
        ],
        "its sums with 1, k and k² must all be zero.",
        count=k.size,
    )


check = judging(_exercise)


def against_nulls(
    panels: Mapping[str, Mapping[str, Mapping[str, np.ndarray]]], label: str, alt: str
) -> Illustration:
    """Shares of filters under the real torques, as bars, and under nulls, a dot for each draw."""
    classes = list(next(iter(panels.values())))
    rows = -(-len(panels) // 3)
    order = list(next(iter(next(iter(panels.values())).values())))
    look = looks(order, {order[0]: "measured"})

    def draw(figure: Figure):
        axes = figure.subplots(rows, 3, squeeze=False, sharey=True)
        for axis, (title, groups) in zip(axes.ravel(), panels.items()):
            for row, sets in enumerate(groups.values()):
                (real, values), *nulls = sets.items()
                axis.barh(row, np.mean(values), 0.86, color=FAINT, alpha=0.35, label=real, lw=0)
                axis.plot([np.mean(values)] * 2, [row - 0.43, row + 0.43], color=INK, lw=2.0)
                for k, (name, draws) in enumerate(nulls):
                    height = row + (k - (len(nulls) - 1) / 2) * 0.26
                    _dots(axis, draws, height, k, name, look[name].colour)
            axis.set(title=title, xlim=(-0.03, 1.03), ylim=(len(groups) - 0.5, -0.5))
            axis.grid(visible=False, axis="y")
        for axis in axes[:, 0]:
            axis.set_yticks(range(len(classes)), classes)
        for axis in axes[-1]:
            axis.set_xlabel(check_label(label))
        handles, names = axes[0, 0].get_legend_handles_labels()
        first = {name: handle for handle, name in zip(handles[::-1], names[::-1])}
        for k, name in enumerate(order[1:]):
            mark = {"marker": "os|"[k % 3], "ms": 4, "color": look[name].colour}
            first[name] = Line2D([], [], ls="", **mark)
        legend_above(figure, [first[name] for name in order], order)

    return illustrate(draw, alt, 7.0, 0.6 + rows * (0.5 + 0.36 * len(classes)))


def _dots(axis: Axes, values, height: float, k: int, name: str, colour: str):
    """One mark for each value, all in one path, since hundreds of markers are heavy."""
    at = np.unique(np.asarray(values, dtype=float))
    long = 0.09 if k % 3 == 2 else 1e-3  # discs, squares and strokes
    x, y = np.repeat(at, 3), np.tile([height - long, height + long, np.nan], at.size)
    cap = ("round", "projecting", "butt")[k % 3]
    axis.plot(x, y, color=colour, alpha=0.7,
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

    (own, *_), *_ = rows.values()
    tones = looks([name for sets in rows.values() for name in sets] + [*courses], {own: "measured"})

    def draw(figure: Figure):
        left, right = figure.subplots(1, 2)
        for height, sets in enumerate(rows.values()):
            (first, values), *others = sets.items()
            mean = np.mean(values)
            _dots(left, values, height, 0, f"{first}, each network", INK)
            ends = [height - 0.38, height + 0.38]
            left.plot([mean] * 2, ends, color=INK, lw=2.0, label=f"{first}, mean")
            for k, (name, other) in enumerate(others, 1):
                look = {"color": tones[name].colour, "mfc": "none", "ms": 4.5, "ls": ""}
                left.plot([np.mean(other)], [height], "sD^"[k % 3], label=f"{name}, mean", **look)
        left.set_yticks(range(len(rows)), list(rows))
        left.grid(visible=False, axis="y")
        left.set(title="By target", xlabel=check_label(labels[0]), ylim=(len(rows) - 0.4, -0.6))
        for k, (name, sets) in enumerate(courses.items(), 2):
            at = np.arange(len(sets)) + 0.1 * (k - 2)
            look = {"marker": "os"[k % 2], **tones[name].line}
            right.plot(at, [np.mean(x) for x in sets.values()], ms=4, label=name, **look)
            ends = np.transpose([np.quantile(x, (0.05, 0.95)) for x in sets.values()])
            right.vlines(at, *ends, color=tones[name].colour, lw=1.0)
            right.set_xticks(range(len(sets)), list(sets))
        right.set(title="Mixtures", xlabel=check_label(labels[1]), ylabel=labels[0])
        named = {}
        for axis in (left, right):
            handles, names = axis.get_legend_handles_labels()
            named |= dict(zip(names, handles))
        named[next(iter(named))] = Line2D([], [], ls="", marker="o", ms=4, color=INK)
        legend_above(figure, list(named.values()), list(named))

    return illustrate(draw, alt, 7.0, 3.6, 4.8)
