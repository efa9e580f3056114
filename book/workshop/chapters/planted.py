"""What networks of known torques show: their shapes, their sizes, their answers to a knob."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from ddlib.figures.style import COLOURS, INK, Illustration, illustrate
from ddlib.setups import JOINT_DAMPING
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
"""Kinds of torques in the order of the figure, and what it calls them."""


@cache
def of_kinds(reading: str = JOINT_DAMPING.name) -> Mapping[str, Mapping]:
    """Networks of each kind of torques, trained for long from the book's start."""
    (row,) = (x for x in results.read("planted")["long"] if x["setting"]["reading"] == reading)
    return row["kinds"]


def acceleration(kind: str, layer: str = "hidden") -> float:
    """Share of acceleration names among what training added to filters, per cent."""
    return 100 * float(of_kinds()[kind]["names"][layer]["added"]["acceleration"])


def every(kind: str, what: str) -> np.ndarray:
    """Of each network of a kind its read "M11", kg m², or the answer to the parabola's "knob"."""
    return np.asarray(of_kinds()[kind]["every"][what])


def shapes_and_sizes() -> Illustration:
    """Shapes, sizes and answers of networks, by the torques that they learnt."""
    own = float(of_kinds()["the arm"]["truth"][0][0][2])
    panels = {
        "acceleration shapes, %": ({kind: [acceleration(kind)] for kind in KINDS}, None),
        "inertia read, kg m²": ({kind: every(kind, "M11") for kind in KINDS}, own),
        "answer to the knob": ({kind: every(kind, "knob") for kind in KINDS}, 1.0),
    }

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True)
        for axis, (label, (shown, arm)) in zip(axes, panels.items()):
            for k, values in enumerate(shown.values()):
                axis.plot(values, np.full(len(values), k), "o", color=COLOURS[min(k, 1)], ms=4)
                axis.plot([np.mean(values)] * 2, [k - 0.3, k + 0.3], color=INK, lw=2)
            axis.axvline(0, color=INK, lw=0.7)
            if arm is not None:
                axis.axvline(arm, color=INK, ls="--", lw=1.0)
            axis.grid(visible=False, axis="y")
            axis.set(xlabel=label, ylim=(len(KINDS) - 0.5, -0.6))
        axes[0].set_yticks(range(len(KINDS)), list(KINDS.values()))

    means = "; ".join(
        f"{label}: " + ", ".join(f"{KINDS[k]} {np.mean(x):.2g}" for k, x in shown.items())
        for label, (shown, _) in panels.items()
    )
    alt = f"Means of networks by the torques that they learnt. {means}.".replace("-", "−")
    return illustrate(draw, alt, 7.0, 3.0, narrow_height=3 * 2.6)
