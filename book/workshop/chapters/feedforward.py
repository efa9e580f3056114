"""Figures of the chapter *What feedforward adds*."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch

from ddlib.figures.style import COLOURS, FAINT, INK, NARROW, Illustration, illustrate


def feedforward_loop() -> Illustration:
    """Figure 2-1: feedforward torque from the inverse arm, feedback at each joint, the arm."""

    def draw(figure: Figure):
        axis = figure.subplots()
        (_lying_loop if figure.get_figwidth() > NARROW else _standing_loop)(axis)
        axis.axis("off")

    alt = (
        "Block diagram. The reference trajectory feeds two branches: the inverse arm, which "
        "computes the feedforward torque off line, and a comparison with the measured motion, "
        "whose error drives a feedback law at each joint. Both torques are added and drive the "
        "arm; its measured motion returns to the comparison."
    )
    return illustrate(draw, alt, 7.0, 2.5, narrow_height=5.4)


def _lying_loop(axis: Axes):
    """The diagram of `feedforward_loop` from left to right."""
    _block(axis, 1.3, 1.1, "reference\ntrajectory")
    _block(axis, 5.0, 2.75, "inverse arm", colour=COLOURS[1])
    _block(axis, 5.0, 1.1, "feedback\nat each joint", colour=COLOURS[0])
    _block(axis, 9.2, 1.1, "arm")
    _sum(axis, 3.25, 1.1)
    _sum(axis, 7.0, 1.1)
    _arrow(axis, (2.2, 1.1), (3.07, 1.1), r"$q_r,\ \dot q_r$")
    _arrow(axis, (1.3, 1.5), (1.3, 2.75), (4.1, 2.75))
    axis.text(2.6, 2.85, r"$q_r,\ \dot q_r,\ \ddot q_r$", ha="center", va="bottom")
    _arrow(axis, (3.43, 1.1), (4.1, 1.1), "$e$")
    _arrow(axis, (5.9, 1.1), (6.82, 1.1), r"$\tau_{\mathrm{fb}}$")
    _arrow(axis, (5.9, 2.75), (7.0, 2.75), (7.0, 1.28))
    axis.text(6.45, 2.85, r"$\tau_{\mathrm{ff}}$", ha="center", va="bottom")
    _arrow(axis, (7.18, 1.1), (8.3, 1.1), r"$\tau$")
    _arrow(axis, (10.1, 1.1), (11.3, 1.1), r"$q,\ \dot q$")
    _arrow(axis, (10.6, 1.1), (10.6, 0.1), (3.25, 0.1), (3.25, 0.92))
    axis.plot(10.6, 1.1, "o", ms=3.5, color=INK)
    for x, y, sign in ((2.93, 0.9, "+"), (3.42, 0.78, "−"), (6.68, 0.9, "+"), (7.2, 1.4, "+")):
        axis.text(x, y, sign, ha="center", va="center", fontsize=9)
    axis.text(5.0, 3.25, "off line", ha="center", va="bottom", color=FAINT)
    axis.text(6.6, 0.18, "sensors", ha="center", va="bottom", color=FAINT)
    axis.set(xlim=(0.2, 11.5), ylim=(-0.1, 3.6), aspect="equal")


def _standing_loop(axis: Axes):
    """The diagram of `feedforward_loop` from top to bottom, for a narrow page."""
    _block(axis, 1.3, 6.6, "reference\ntrajectory")
    _block(axis, 4.2, 3.8, "inverse arm", colour=COLOURS[1])
    _block(axis, 1.3, 3.8, "feedback\nat each joint", colour=COLOURS[0])
    _block(axis, 1.3, 0.8, "arm")
    _sum(axis, 1.3, 5.2)
    _sum(axis, 1.3, 2.3)
    _arrow(axis, (1.3, 6.2), (1.3, 5.38))
    _arrow(axis, (2.2, 6.6), (4.2, 6.6), (4.2, 4.2))
    _arrow(axis, (1.3, 5.02), (1.3, 4.2))
    _arrow(axis, (1.3, 3.4), (1.3, 2.48))
    _arrow(axis, (4.2, 3.4), (4.2, 2.3), (1.48, 2.3))
    _arrow(axis, (1.3, 2.12), (1.3, 1.2))
    _arrow(axis, (1.3, 0.4), (1.3, -0.6))
    _arrow(axis, (1.3, 0.0), (0.1, 0.0), (0.1, 5.2), (1.12, 5.2))
    axis.plot(1.3, 0.0, "o", ms=3.5, color=INK)
    for x, y, name in (
        (1.45, 5.8, r"$q_r,\ \dot q_r$"), (1.45, 4.6, "$e$"), (1.45, 2.95, r"$\tau_{\mathrm{fb}}$"),
        (1.45, 1.65, r"$\tau$"), (1.45, -0.4, r"$q,\ \dot q$"),
    ):  # fmt: skip
        axis.text(x, y, name, ha="left", va="center")
    axis.text(3.2, 6.7, r"$q_r,\ \dot q_r,\ \ddot q_r$", ha="center", va="bottom")
    axis.text(2.8, 2.4, r"$\tau_{\mathrm{ff}}$", ha="center", va="bottom")
    for x, y, sign in ((1.08, 5.5, "+"), (0.95, 5.02, "−"), (1.08, 2.6, "+"), (1.6, 2.08, "+")):
        axis.text(x, y, sign, ha="center", va="center", fontsize=9)
    axis.text(5.2, 3.25, "off line", ha="right", va="top", color=FAINT)
    axis.text(0.2, 0.1, "sensors", ha="left", va="bottom", color=FAINT)
    axis.set(xlim=(-0.1, 5.3), ylim=(-0.75, 7.3), aspect="equal")


def _block(axis: Axes, x, y, text, colour=INK):
    """A box of the diagram with its centre at `x`, `y`."""
    style = "round,pad=0,rounding_size=0.08"
    box = FancyBboxPatch((x - 0.9, y - 0.4), 1.8, 0.8, style, fc="none", ec=colour, lw=1.6)
    axis.add_patch(box)
    axis.text(x, y, text, ha="center", va="center", linespacing=1.15)


def _sum(axis: Axes, x, y):
    """A summing point."""
    axis.add_patch(Circle((x, y), 0.18, fc="none", ec=INK, lw=1.2))


def _arrow(axis: Axes, *points):
    """A line through `points` with an arrow head at its end; a last text names the first part."""
    *points, name = points if isinstance(points[-1], str) else (*points, "")
    (x0, y0), (x1, _) = points[:2]
    axis.plot(*np.array(points).T, color=INK, lw=1.1, solid_joinstyle="miter")
    head = {"arrowstyle": "-|>", "color": INK, "lw": 1.1, "shrinkA": 0, "shrinkB": 0}
    axis.annotate("", points[-1], points[-2], arrowprops=head)
    axis.text((x0 + x1) / 2, y0 + 0.1, name, ha="center", va="bottom")
