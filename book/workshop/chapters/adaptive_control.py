"""*Adaptive control*: numbers, figures and checks; what controllers reach, find and miss."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ddlib.figures import (
    COLOUR_MAP,
    COLOURS,
    DASHES,
    FAINT,
    INK,
    Illustration,
    check_label,
    illustrate,
    legend_above,
)
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.tables import quote
from workshop.beyond.studies.loop.runs.adaptive import _FULL
from workshop.chapters.exercises import judge
from workshop.report import results
from workshop.report.evidence.statements import stated
from workshop.report.evidence.verdicts import Measured, judged


def _courses(
    panels: dict[str, dict[str, np.ndarray]], change: int, told: str, label: str, alt: str
) -> Illustration:
    """Errors ``{title: {controller: (motions, runs)}}``: medians, and the middle half of all runs.

    After the motion `change` something happens, as `told`.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, (title, controllers) in zip(axes, panels.items()):
            for k, errors in enumerate(controllers.values()):
                low, middle, high = np.percentile(errors, (25, 50, 75), axis=1)
                x = 1 + np.arange(len(errors))
                style = {"color": COLOURS[k % len(COLOURS)]}
                axis.fill_between(x, low, high, alpha=0.15, lw=0, **style)
                axis.plot(
                    x, middle, ls=DASHES[k % len(DASHES)], marker="os^Dv*"[k % 6], ms=3.5, **style
                )
            axis.set(title=title, yscale="log", xticks=x)
            axis.axvline(change + 0.5, color=INK, lw=0.8)
            axis.text(
                change + 0.6, 0.02, told, ha="left", va="bottom", fontsize=8,
                transform=axis.get_xaxis_transform(),
            )  # fmt: skip
            axis.set_xlabel("motion, number")
        axes[0].set_ylabel(check_label(label))
        handles = [line for line in axes[0].lines if line.get_marker() not in ("", "None")]
        legend_above(figure, handles, list(next(iter(panels.values()))))

    return illustrate(draw, alt, 7.0, 3.6)


def _stops_map(x, y, panels: dict[str, tuple], labels: tuple[str, ...], alt: str) -> Illustration:
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


def kept(*path) -> np.ndarray | dict:
    """A part of the result; among its numbers, runs that were stopped are infinite."""
    found = results.read("adaptive")
    for key in path:
        found = found[key]
    return found if isinstance(found, dict) else _finite(found)


def _finite(numbers) -> np.ndarray:
    return np.nan_to_num(np.array(numbers, float), nan=np.inf)


def load_row(setup: str, mass: float, late: int = 0) -> dict[str, np.ndarray]:
    """Errors in mm by law, ``(motions, seeds)``, with a load in kg and torques periods late."""
    rows = kept("loads", setup)["rows"]
    (row,) = [r for r in rows if r["load"] == mass and r["late"] == late]
    return {name: _finite(errors) for name, errors in row["settled"].items()}


def _added(effect: str) -> np.ndarray:
    """What an effect adds to the estimates of each day, as shares of the true ones."""
    own, none = (np.array(kept("bed", e, "estimate")) for e in (effect, next(iter(kept("bed")))))
    return own - none


def bias(effect: str) -> np.ndarray:
    """What an effect adds to the seven estimates in the median, as shares of the true ones."""
    return np.median(_added(effect), axis=0)


def _told(parameter: str) -> str:
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
        text=f"{100 * off[k]:+.0f} % of {_told(_FULL[k])}",
    )


# --- the lesson ---------------------------------------------------------------------------

_LINES = {"PD": "PD", "computed torque": "computed torque", "with friction": "Slotine & Li"}
_SETUPS = {"jd": JOINT_DAMPING.name, "sf": STATE_FEEDBACK.name}


def _again(seconds: str, setup: str, law: str) -> np.ndarray:
    """End-point errors (mm), (motions, runs), along a plan with corners of so many seconds."""
    return _finite(kept("same motions", seconds, setup)["hand"][law])


def _quoted() -> None:
    """The numbers of the prose."""
    for tail, setup in _SETUPS.items():
        for law, key in (("PD", "pd"), ("computed torque", "ct"), ("with friction", "sl")):
            for seconds, plan in (("0", "jump"), ("0.1", "tenth"), ("0.2", "fifth")):
                found = np.median(_again(seconds, setup, law), -1)
                quote(f"adaptive-{key}-{tail}-{plan}", found[3])
                quote(f"adaptive-{key}-{tail}-{plan}-load", found[7])
    excited = {n: np.array(x, float) for n, x in kept("excitation", "settled").items()}
    quote("adaptive-five-a", 100 * abs(kept("excitation", "estimate")[4][0] - 1))
    quote("adaptive-five-old", excited["not learning"][-1, 4])
    quote("adaptive-five-new", excited["learning"][-1, 4])
    difference = kept("sensors", "difference")["Slotine & Li"]["settled"]
    coarse = list(kept("bits")).index(12.5)
    quote("adaptive-difference", float(np.median(_finite(difference)[coarse])))
    for effect in ("dead zone", "backlash"):
        row = {n: np.median(_finite(x)) for n, x in kept("bed", effect, "settled").items()}
        quote(f"adaptive-bed-{effect.replace(' ', '-')}", row["adapted"] / row["held"])


def _said() -> None:
    """What stands behind words of the prose."""
    few, heavy, slow = (
        [np.median(_again(seconds, s, "with friction") / _again(seconds, s, "PD"), -1)[at]
         for s in _SETUPS.values()]
        for seconds, at in (("0.1", 3), ("0.1", 7), ("0.2", 7))
    )  # fmt: skip
    stated("adaptive-few", max(*few, *slow) < 0.06)
    stated("adaptive-heavy", min(heavy) > 2 * max(slow))
    settled = [kept("same motions", "0", s)["settled"]["with friction"] for s in _SETUPS.values()]
    first, second = (np.median(_finite(x), -1) for x in settled)
    stated("adaptive-back", first[7] < 1.5 * first[3] and second[7] > 1.5 * second[3])
    excited = {n: np.array(x, float) for n, x in kept("excitation", "settled").items()}
    stated("adaptive-five-fell", excited["learning"][-1, 4] < excited["not learning"][-1, 4])


def _rounded_figure() -> Illustration:
    """The first figure: whole motions before and after a load, by how the plan is rounded."""
    titles = {"0": "the report's plan", "0.1": "rounded over 0.1 s", "0.2": "over 0.2 s"}
    panels = {
        title: {name: _again(seconds, JOINT_DAMPING.name, law) for law, name in _LINES.items()}
        for seconds, title in titles.items()
    }
    told = "; ".join(
        f"{title}: " + ", ".join(f"{n} {np.median(x[3]):.1f}, {np.median(x[7]):.1f}"
                                 for n, x in rows.items())
        for title, rows in panels.items()
    )  # fmt: skip
    alt = f"Errors over eight motions, three plans. In the fourth and the last, mm: {told}."
    return _courses(panels, 4, "5 kg", "end-point error, mm", alt)


_SHOWN = {"rounded": _rounded_figure, "courses": _courses, "map": _stops_map}


def show(name: str, *what, **how) -> Illustration:
    """A figure of the lesson or its evidence page."""
    return _SHOWN[name](*what, **how)


def check(number: int, mine, asked=None) -> None:
    """Judge an answer; `asked` gives the share of the motors' limits that a corner asks for."""
    if number == 1:
        slips = [(1.5, "the sign: does V grow?"),
                 (-2.5, "K multiplies the squares of s.")]  # fmt: skip
        told = "wrong estimates do not come in; they are paid for by the update."
        judge(mine, -1.5, told, slips, "All terms but one cancel.")
    elif number == 2:
        slips = [(other, "which torques does that one act on?") for other in ("b", "d")]
        otherwise = "one of the letters a, b, d."
        judge(mine, "a", "the shoulder never accelerates.", slips, otherwise)
    else:

        def short(seconds):
            return 0.05 < seconds <= 0.9 and asked(seconds) <= 1 < asked(0.85 * seconds)

        otherwise = "too much for a motor, or longer than needed. What is the impulse?"
        judge(mine, short, "the elbow's motor decides.", [], otherwise)
