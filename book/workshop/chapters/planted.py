"""What networks of known torques show: their shapes, their sizes, their answers to a knob."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.figures.style import COLOURS, INK, Illustration, illustrate
from ddlib.setups import INITIAL, JOINT_DAMPING
from workshop.report import results

KINDS = {
    "the arm": "the arm's own",
    "inertia alone": "inertia alone",
    "another arm along this motion": "another arm's",
    "position alone": "position alone",
    "velocity alone": "velocity alone",
    "shifted": "shifted in time",
    "random phases": "random phases",
}
"""Kinds of torques in the order of the figure, and what it calls them; with inertia first."""

_WITH_INERTIA = 3


@cache
def of_kinds(long: bool = True, reading: str = JOINT_DAMPING.name) -> Mapping[str, Mapping]:
    """Networks of each kind of torques from the book's start, by descent as long as the lessons'.

    Or, in the study with most networks, five times as `long`.
    """
    rows = results.read("planted")["long" if long else "grid"]
    wanted = {"reading": reading, "width": 21, "initial": INITIAL}
    (row,) = (x for x in rows if {k: x["setting"][k] for k in wanted} == wanted)
    return row["kinds"]


def acceleration(kind: str, long: bool = False) -> float:
    """Share of acceleration names among what training added to hidden filters, per cent."""
    return 100 * float(of_kinds(long)[kind]["names"]["hidden"]["added"]["acceleration"])


def every(kind: str, what: str) -> np.ndarray:
    """Of each network of a kind its read "M11", kg m², or the answer to the parabola's "knob"."""
    return np.asarray(of_kinds()[kind]["every"][what])


def elbow_of_the_other(reading: str) -> float:
    """How much too heavy another arm's elbow is read on its own recording, as a share."""
    kind = of_kinds(False, reading)["another arm along its own motion"]
    return float(kind["read"]["mean"][1][1][2] / kind["truth"][1][1][2] - 1)


def loaded(reading: str, model: str) -> float:
    """RMSS of networks, or what else, on trajectory 6 of the arm with 3 kg in its hand."""
    wanted = {"reading": reading, "width": 21, "method": "descent"}
    (row,) = (x for x in results.read("written")["rows"] if x["setting"] == wanted)
    return float(np.mean(row["changes"]["3 kg"]["error"][model]["mean"]))


def shapes_and_sizes() -> Illustration:
    """Shapes, sizes and answers of networks, by the torques that they learnt."""
    own = float(of_kinds()["the arm"]["truth"][0][0][2])
    panels = {
        "acceleration shapes, %": (
            {k: [acceleration(k), acceleration(k, True)] for k in KINDS},
            None,
        ),
        "inertia read, kg m²": ({kind: every(kind, "M11") for kind in KINDS}, own),
        "answer to the knob": ({kind: every(kind, "knob") for kind in KINDS}, 1.0),
    }

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True)
        for axis, (label, (shown, arm)) in zip(axes, panels.items()):
            for k, values in enumerate(shown.values()):
                colour = COLOURS[0 if k < _WITH_INERTIA else 1]
                if arm is None:
                    axis.plot(values, [k, k], color=colour, lw=1)
                    axis.plot(values[:1], [k], "o", color=colour, ms=7)
                    axis.plot(values[1:], [k], "o", color=colour, ms=7, mfc="none")
                else:
                    axis.plot(values, np.full(len(values), k), "o", color=colour, ms=4)
                    axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
                    axis.axvline(arm, color=INK, ls="--", lw=1.0)
            axis.axvline(0, color=INK, lw=0.7)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(KINDS) - 0.5, -0.6))
        axes[0].set_yticks(range(len(KINDS)), list(KINDS.values()))

    means = "; ".join(
        f"{label}: " + ", ".join(f"{KINDS[k]} {np.mean(x):.2g}" for k, x in shown.items())
        for label, (shown, _) in panels.items()
    )
    alt = f"Means of networks by the torques that they learnt. {means}.".replace("-", "−")
    return illustrate(draw, alt, 7.0, 3.0, narrow_height=3 * 2.6)
