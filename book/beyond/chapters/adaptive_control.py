"""*Adaptive control*: numbers, figures and checks; what controllers reach, find and miss."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from beyond.studies.loop import fair_rivals
from beyond.studies.loop.adaptive_laws import WITH_FRICTION
from ddlib.figures import (
    COLOUR_MAP,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    looks,
)
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.tables import Table, quote, significant
from workshop.chapters.exercises import Exercise, judging
from workshop.report import results
from workshop.report.evidence.verdicts import Measured, judged

_PLAIN = FuncFormatter(lambda value, place: f"{value:g}")


def courses(
    panels: dict[str, dict[str, np.ndarray]], change: int, event: str, label: str, alt: str
) -> Illustration:
    """Errors ``{title: {controller: (motions, runs)}}``: medians, and the middle half of all runs.

    After the motion `change` something happens, the `event`.
    """

    look = looks(name for controllers in panels.values() for name in controllers)

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, (title, controllers) in zip(axes, panels.items()):
            for k, (name, errors) in enumerate(controllers.items()):
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                x = 1 + np.arange(len(errors))
                axis.fill_between(x, low, high, alpha=0.15, lw=0, color=look[name].colour)
                axis.plot(x, middle, marker="os^Dv*"[k % 6], ms=3.5, **look[name].line)
            axis.set(title=title, yscale="log", xticks=x)
            axis.axvline(change + 0.5, color=INK, lw=0.8)
            axis.text(
                change + 0.6, 0.02, event, ha="left", va="bottom", fontsize=8,
                transform=axis.get_xaxis_transform(),
            )  # fmt: skip
            axis.set_xlabel("motion, number")
        axes[0].set_ylabel(check_label(label))
        axes[0].yaxis.set_major_formatter(_PLAIN)
        handles = [line for line in axes[0].lines if line.get_marker() not in ("", "None")]
        legend_above(figure, handles, list(next(iter(panels.values()))))

    return illustrate(draw, alt, 7.0, 3.6)


def stops_map(x, y, panels: dict[str, tuple], labels: tuple[str, ...], alt: str) -> Illustration:
    """Errors over two settings, ``{title: (errors, stopped)}`` with a row for each of `y`.

    A run that was stopped gets a cross. The labels are of x, y and the errors.
    """
    shown = np.concatenate([errors[~stopped] for errors, stopped in panels.values()])

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        norm = LogNorm(shown.min(), shown.max())
        places = np.arange(len(x))
        for axis, (title, (errors, stopped)) in zip(axes, panels.items()):
            masked = np.ma.masked_array(errors, stopped)
            picture = axis.pcolormesh(places, np.arange(len(y)), masked, norm=norm, cmap=COLOUR_MAP)
            rows, columns = np.nonzero(stopped)
            axis.plot(columns, rows, "x", color=FAINT, ms=6, mew=1.6)
            ticks = [k for k in places if abs(np.log10(x[k]) % 1) < 1e-6]
            axis.set_xticks(ticks, [f"{x[k]:g}" for k in ticks])
            axis.tick_params("x", labelsize=7.5)
            axis.set_yticks(np.arange(len(y)), [f"{v:g}" for v in y])
            axis.grid(visible=False)
            axis.set_title(title)
        axes[0].set_ylabel(check_label(labels[1]))
        figure.supxlabel(check_label(labels[0]))
        figure.colorbar(picture, ax=list(axes), label=check_label(labels[2]), shrink=0.95)

    return illustrate(draw, alt, 7.0, 2.9)


def part(*path) -> np.ndarray | dict:
    """A part of the result; among its numbers, runs that were stopped are infinite."""
    branch = results.read("adaptive")
    for key in path:
        branch = branch[key]
    return branch if isinstance(branch, dict) else _finite(branch)


def _finite(numbers) -> np.ndarray:
    return np.nan_to_num(np.array(numbers, float), nan=np.inf)


def load_row(setup: str, mass: float, late: int = 0) -> dict[str, np.ndarray]:
    """Errors in mm by law, ``(motions, seeds)``, with a load in kg and torques periods late."""
    rows = part("loads", setup)["rows"]
    (row,) = [r for r in rows if r["load"] == mass and r["late"] == late]
    return {name: _finite(errors) for name, errors in row["settled"].items()}


def _added(effect: str) -> np.ndarray:
    """What an effect adds to the estimates of each day, as shares of the true ones."""
    own, none = (np.array(part("bed", e, "estimate")) for e in (effect, next(iter(part("bed")))))
    return own - none


def bias(effect: str) -> np.ndarray:
    """What an effect adds to the seven estimates in the median, as shares of the true ones."""
    return np.median(_added(effect), axis=0)


def _in_words(parameter: str) -> str:
    """A parameter of adaptive controllers in words, if it is a friction or a moment."""
    kinds = {"F_v": "viscous friction", "F_c": "Coulomb friction", "g": "gravity moment"}
    kind, joint = kinds.get(parameter[:-1]), parameter[-1]
    return f"the {('shoulder', 'elbow')[int(joint) - 1]}'s {kind}" if kind else parameter


def bent(effect: str) -> Measured:
    """Largest such bias."""
    off = bias(effect)
    k = int(np.abs(off).argmax())
    return judged(
        lambda x: np.abs(np.median(x, axis=1)).max(-1),
        _added(effect),
        text=f"{100 * off[k]:+.0f} % of {_in_words(WITH_FRICTION[k])}",
    )


# --- the lesson ---------------------------------------------------------------------------

_LINES = {"PD": "PD", "computed torque": "computed torque", "with friction": "Slotine & Li"}
_SETUPS = {"jd": JOINT_DAMPING.name, "sf": STATE_FEEDBACK.name}


def _again(seconds: str, setup: str, law: str) -> np.ndarray:
    """End-point errors (mm), (motions, runs), along a plan with corners of so many seconds."""
    return _finite(part("same motions", seconds, setup)["hand"][law])


def _quoted() -> None:
    """The numbers of the prose."""
    for tail, setup in _SETUPS.items():
        for law, key in (("PD", "pd"), ("computed torque", "ct"), ("with friction", "sl")):
            for seconds, plan in (("0", "jump"), ("0.1", "tenth"), ("0.2", "fifth")):
                errors = np.median(_again(seconds, setup, law), -1)
                quote(f"adaptive-{key}-{tail}-{plan}", errors[3])
                quote(f"adaptive-{key}-{tail}-{plan}-load", errors[7])
    errors, coarse = _fair(), _fair(12.5)
    for name, key in _FAIR.items():
        for k, when in ((0, "first"), (3, "empty"), (4, "load-first"), (7, "load")):
            quote(f"fair-{key}-{when}", errors[name][k])
        quote(f"fair-{key}-margin", 1e3 * fair_rivals.delay_margin(fair_rivals.RIVALS[name]))
        quote(f"fair-{key}-encoder", coarse[name][3])
    excited = {n: np.array(x, float) for n, x in part("excitation", "settled").items()}
    quote("adaptive-five-a", 100 * abs(part("excitation", "estimate")[4][0] - 1))
    quote("adaptive-five-old", excited["not learning"][-1, 4])
    quote("adaptive-five-new", excited["learning"][-1, 4])
    difference = part("sensors", "difference")["Slotine & Li"]["settled"]
    coarse = list(part("bits")).index(12.5)
    quote("adaptive-difference", float(np.median(_finite(difference)[coarse])))
    for effect in ("dead zone", "backlash"):
        row = {n: np.median(_finite(x)) for n, x in part("bed", effect, "settled").items()}
        quote(f"adaptive-bed-{effect.replace(' ', '-')}", row["adapted"] / row["held"])


def rounded_figure() -> Illustration:
    """The first figure: whole motions before and after a load, by how the plan is rounded."""
    titles = {"0": "the report's plan", "0.1": "rounded over 0.1 s", "0.2": "over 0.2 s"}
    panels = {
        title: {name: _again(seconds, JOINT_DAMPING.name, law) for law, name in _LINES.items()}
        for seconds, title in titles.items()
    }
    medians = "; ".join(
        f"{title}: " + ", ".join(f"{n} {np.median(x[3]):.1f}, {np.median(x[7]):.1f}"
                                 for n, x in rows.items())
        for title, rows in panels.items()
    )  # fmt: skip
    alt = f"Errors over eight motions, three plans. In the fourth and the last, mm: {medians}."
    return courses(panels, 4, "5 kg", "end-point error, mm", alt)


# --- the same set of rivals ------------------------------------------------------------------

_FAIR = {
    "PD, the book's gains": "pd",
    "PD, ten times as stiff": "stiff",
    "PD and a disturbance observer": "observer",
    "exact numbers, held": "held",
    "exact numbers, and an observer": "observed",
    "adaptive (Slotine & Li)": "learnt",
    "all of them 10 % too large": "wrong",
}


@cache
def _fair(bits: float | None = None, filtered: float = 0.0) -> dict[str, np.ndarray]:
    return fair_rivals.errors(bits=bits, filtered=filtered)


def fair_figure() -> Illustration:
    """A row for each rival: its first and its last error with an empty hand, and with a load."""
    errors, last = _fair(), fair_rivals.TRIALS - 1
    pairs = (("empty hand", 0, last, "o"), ("5 kg in the hand", last + 1, 2 * last + 1, "D"))

    def draw(figure: Figure):
        axis, rows = figure.subplots(), np.arange(len(errors))[::-1]
        for k, (_, first, final, mark) in enumerate(pairs):
            ends = np.array([[e[first], e[final]] for e in errors.values()])
            height, look = rows + (0.16, -0.16)[k], {"color": (INK, FAINT)[k], "ls": "", "ms": 6}
            axis.hlines(height, *ends.T, color=look["color"], lw=1.2)
            axis.plot(ends[:, 0], height, mark, mfc="none", **look)
            axis.plot(ends[:, 1], height, mark, **look)
        axis.set(xscale="log", ylim=(-0.6, len(errors) - 0.4))
        axis.set_yticks(rows, list(errors))
        axis.set_xlabel(check_label("end-point error, mm"))
        axis.xaxis.set_major_formatter(_PLAIN)
        names = [f"{load}, {when}" for load, *_ in pairs for when in ("1st motion", "4th motion")]
        legend_above(figure, axis.lines, names)

    medians = "; ".join(
        f"{name} {e[last]:.2g}, then {e[last + 1]:.2g} and {e[-1]:.2g}"
        for name, e in errors.items()
    )
    alt = f"Errors in the fourth motion, then in the first and fourth with 5 kg, mm: {medians}."
    return illustrate(draw, alt, 7.0, 3.6)


def fair_table() -> Table:
    """The same set in numbers, with other sensors and with delay margins."""
    sensors = [_fair(), _fair(16.0), _fair(12.5), _fair(12.5, 0.01)]
    rows = []
    for name, rival in fair_rivals.RIVALS.items():
        errors = [significant(float(sensors[0][name][k]), 2) for k in (0, 3, 4, 7)]
        others = [significant(float(by_rival[name][3]), 2) for by_rival in sensors[1:]]
        rows.append((name, f"{1e3 * fair_rivals.delay_margin(rival):.0f}", *errors, *others))
    heads = ("delay margin, ms", "1st", "4th", "5 kg: 1st", "5 kg: 4th")
    heads += ("16 bits alone", "12.5 bits alone", "12.5 bits, filtered")
    return Table(("error, mm", *heads), rows)


def _exercise(number: int, given=None) -> Exercise:
    """An exercise; `given` the gains, or by corners the share that they ask of the motors."""
    if number == 1:
        gains, s = np.array(given), np.array([0.2, -0.1])
        falls = -gains @ s**2
        slips = [
            (-falls, "the sign: does V grow?"),
            (-gains @ np.abs(s), "K multiplies the squares of s."),
        ]
        reason = "wrong estimates do not come in; they are paid for by the update."
        return Exercise("number", falls, reason, slips, "All terms but one cancel.", unit="W")
    elif number == 2:
        slips = [(other, "which torques does that one act on?") for other in ("b", "d")]
        otherwise = "one of the letters a, b, d."
        return Exercise(
            "word",
            "a",
            "the shoulder never accelerates.",
            slips,
            otherwise,
            options=("a", "b", "d"),
        )
    else:

        def short(seconds):
            return 0.05 < seconds <= 0.9 and given(seconds) <= 1 < given(0.85 * seconds)

        otherwise = "too much for a motor, or longer than needed. What is the impulse?"
        return Exercise("number", short, "the elbow's motor decides.", [], otherwise, unit="s")


check = judging(_exercise)
