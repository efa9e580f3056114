"""*Learning in the loop*: its results seed by seed, in mm; figures trial by trial, by motion."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from ddlib.dynamics import PUMA_560, count, newton_euler
from ddlib.figures import COLOURS, FAINT, INK, Illustration, check_label, illustrate, legend_above
from ddlib.tables import spread
from workshop.report import results
from workshop.report.evidence.verdicts import Measured

PLAIN = "no feedforward"  # the feedback alone, as the study calls it

_MARKERS = "os^DvPX"
_PLAIN = FuncFormatter(lambda value, place: f"{value:g}")


def by_trial(
    panels: dict[str, dict[str, tuple]],
    labels: tuple[str, str],
    alt: str,
    *,
    change: tuple[float, str] | None = None,  # where a dotted line stands, and what is said there
    x_log: bool = False,
) -> Illustration:
    """Errors over trials, or over a rate, logarithmic: medians, and the middle half of the seeds.

    Of ``{title: {learner: (x, errors)}}``, errors of shape (points, seeds), the first learner of
    each panel is in the page's ink: what the others are compared with.
    """
    first = {next(iter(learners)) for learners in panels.values()}
    names = dict.fromkeys(n for each in panels.values() for n in each if n not in first)
    looks = dict(zip(names, zip(COLOURS, _MARKERS)))

    def draw(figure: Figure):
        axes = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for axis, (title, learners) in zip(axes, panels.items()):
            axis.set(yscale="log", xscale="log" if x_log else "linear")
            axis.set_title(title, loc="left")
            for name, (x, errors) in learners.items():
                colour, marker = looks.get(name, (INK, None))
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                axis.fill_between(x, low, high, color=colour, alpha=0.15, lw=0)
                look = {"marker": marker, "ms": 4} if marker else {"ls": "--"}
                axis.plot(x, middle, color=colour, lw=1.6, label=name, **look)
            if change:
                axis.axvline(change[0], color=FAINT, ls=":", lw=1.2)
                axis.annotate(
                    change[1], (change[0], 0.97), xycoords=("data", "axes fraction"), fontsize=8,
                    xytext=(3, 0), textcoords="offset points", va="top", color=FAINT,
                )  # fmt: skip
            axis.legend(
                loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=8, labelcolor="linecolor"
            )
            axis.set_ylabel(check_label(labels[1]))
            axis.yaxis.set_major_formatter(_PLAIN)
        axes[-1].xaxis.set_major_formatter(_PLAIN)
        if not x_log:
            axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
        axes[-1].set_xlabel(check_label(labels[0]))

    return illustrate(draw, alt, 6.4, 2.5 * len(panels) + 0.4)


def by_motion(motions: dict[str, dict[str, np.ndarray]], label: str, alt: str) -> Illustration:
    """Errors of learners, over that of the feedback alone: a row for each motion.

    Of ``{motion: {learner: (seeds,)}}`` a mark is the median, a bar reaches over all seeds.
    """

    def draw(figure: Figure):
        axis = figure.subplots()
        learners = list(next(iter(motions.values())))
        for row, ratios in enumerate(motions.values()):
            for k, name in enumerate(learners):
                colour, values = COLOURS[k % len(COLOURS)], ratios[name]
                place = row + 0.13 * (k - len(learners) / 2 + 0.5)
                ends = [np.min(values), np.max(values)]
                axis.plot(ends, [place] * 2, color=colour, lw=1.2, alpha=0.6)
                axis.plot(
                    np.median(values), place, _MARKERS[k % len(_MARKERS)], color=colour, ms=4.5,
                    label=None if row else name,
                )  # fmt: skip
        axis.axvline(1.0, color=INK, ls="--", lw=1.0)
        axis.set(xscale="log", xlabel=check_label(label))
        axis.xaxis.set_major_formatter(_PLAIN)
        axis.set_yticks(range(len(motions)), motions)
        axis.set_ylim(len(motions) - 0.5, -0.5)
        axis.grid(visible=False, axis="y")
        legend_above(figure, *axis.get_legend_handles_labels())

    return illustrate(draw, alt, 6.0, 0.75 * len(motions) + 1.1)


def part(name: str, setup: str = "joint damping") -> dict:
    """The study's "motion", "family" or "rates" under a reading of the controller."""
    setups = results.read("learning-in-the-loop")["setups"]
    if setup not in setups or name not in setups[setup]:
        raise ValueError(f"name and setup must be of the study, got {name!r}, {setup!r}")
    return setups[setup][name]


def on(
    motion: str, learner: str, setup: str = "joint damping", learning: bool = False
) -> np.ndarray:
    """End-point errors on a motion after practice of another one, one for each seed.

    With `learning` it goes on learning during this one trial.
    """
    errors = part("motion", setup)["tests"][motion]
    if learner not in errors:
        errors = errors["learning" if learning else "frozen"]
    return np.array(errors[learner])


def family(learner: str, when: str, setup: str = "joint damping") -> np.ndarray:
    """End-point errors on the family's test motions, one for each seed."""
    found, trials = part("family", setup), results.read("learning-in-the-loop")["trials"]
    if when in ("at the end", "without the load again"):
        return np.array(found[when][learner])
    return np.array(found["tests"][learner])[trials if when == "with the load" else trials - 1]


def _trials_to_half(errors, start) -> np.ndarray:
    """Trials after which errors, ``(trials, seeds)``, stay at half of a first value or below."""
    above = np.asarray(errors) > 0.5 * np.asarray(start)
    last = np.array([np.flatnonzero(each)[-1] if each.any() else -1 for each in above.T])
    return np.where(last == len(above) - 1, np.inf, last + 1.0)


def halved(learner: str, loaded: bool = False, setup: str = "joint damping") -> Measured:
    """Trials of the family to half the error of the feedback alone, or of the first loaded one."""
    number = results.read("learning-in-the-loop")["trials"]
    found = part("family", setup)
    errors = np.array(found["tests"][learner])
    if loaded:
        errors = np.concatenate([errors[number:], [found["at the end"][learner]]])
        start = errors[0]
    else:
        errors, start = errors[:number], np.array(found["tests"][PLAIN])[0]
    counts = _trials_to_half(errors, start)
    got = np.isfinite(counts).sum()
    text = f"{spread(counts)}, {got} of {counts.size} seeds" if got else "no seed"
    return Measured(float(np.median(counts)), text)


def multiplications(hidden: int = 10, inputs: int = 42, every: int = 5, replay: int = 15) -> dict:
    """Multiplications of the torque and of each way to learn, in a control period on average."""
    features = hidden + inputs + 1
    torque = hidden * inputs + 2 * (hidden + inputs)
    # delta: o (1 - o) e; through the output weights and h (1 - h); all products times the rate
    back = 2 * 2 + 2 + 2 * hidden + 2 * hidden + hidden
    gradient = back + 2 * (features - 1) + hidden * inputs
    one = torque + gradient
    squares = features**2
    least = (torque - 2 * (hidden + inputs)) + 2 * (features - 1) + 2 * features
    least += 3 * squares + 2 * features
    plain = inputs + 1
    return {
        "torque": float(torque),
        "one pass": one / every,
        "by feedback": gradient / every,
        "replay": (1 + replay) * one / every,
        "last layer": least / every,
        "linear filter": (3 * plain**2 + 6 * plain - 2) / every,
    }


def affordable(learner: str) -> Measured:
    """Multiplications of torque and learning over what 1986 did in a control period."""
    each = multiplications()
    total = each["torque"] + (each[learner] if learner != "torque" else 0.0)
    could = count(newton_euler, PUMA_560, "arm").multiplications * 2.0 / 1.2
    return Measured(total / could, f"{total:,.0f} of {could:,.0f} in 2 ms")
