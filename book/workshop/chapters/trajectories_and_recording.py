"""Figures of the chapter *Trajectories and recording*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from ddlib._check import finite_array, number, shaped
from ddlib.figures.style import COLOURS, FAINT, INK, Illustration, illustrate, legend_above


def reached(states: Mapping[str, np.ndarray], radius: float) -> Illustration:
    """Where recordings lie in the cube of states: shoulder against elbow, three planes."""
    number("radius", radius, 0.0, open_low=True)
    checked = {n: shaped(f"states[{n!r}]", x, "(runs, time, 6)") for n, x in states.items()}
    if not checked:
        raise ValueError("states must hold one set or more, got none")
    units = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s²"}
    edge = 1.15 * radius

    def draw(figure: Figure):
        axes = figure.subplots(1, 3)
        for k, (axis, (title, unit)) in enumerate(zip(axes, units.items())):
            box = Rectangle((-radius, -radius), 2 * radius, 2 * radius, fill=False)
            box.set(edgecolor=INK, lw=1.0)
            axis.add_patch(box)
            for j, (name, x) in enumerate(checked.items()):
                for run, line in enumerate(x[..., 2 * k : 2 * k + 2]):
                    label = name if run == 0 else None
                    axis.plot(*line.T, color=COLOURS[j], lw=0.6 + 0.5 * j, label=label)
            axis.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal", title=title)
            axis.axhline(0, color=FAINT, lw=0.5)
            axis.axvline(0, color=FAINT, lw=0.5)
            axis.set(xlabel=f"shoulder, {unit}", ylabel=f"elbow, {unit}")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)

    largest = ", ".join(
        f"{name}: {np.abs(x[..., :2]).max():.1f} rad, {np.abs(x[..., 2:4]).max():.1f} rad/s, "
        f"{np.abs(x[..., 4:]).max():.1f} rad/s²"
        for name, x in checked.items()
    )
    alt = (
        "Three squares, shoulder against elbow, for position, velocity and acceleration, each "
        f"with the box of ±{radius:.2f}; the recordings are thin curves in a part of it. Largest "
        f"values: {largest}."
    )
    return illustrate(draw, alt, 7.0, 2.9)


def rounding(t, steps, estimates: Mapping[str, np.ndarray]) -> Illustration:
    """Readings of an encoder sample by sample, and accelerations computed from them."""
    t = shaped("t", t, "(time,)")
    steps = shaped("steps", steps, t.shape)
    drawn = {name: shaped(f"estimates[{name!r}]", x, t.shape) for name, x in estimates.items()}

    def draw(figure: Figure):
        top, bottom = figure.subplots(2, 1, sharex=True)
        top.step(t, steps, where="mid", color=FAINT, lw=0.9)
        top.plot(t, steps, ".", color=COLOURS[0], ms=5)
        top.set_ylabel("angle, encoder steps")
        for k, (name, x) in enumerate(drawn.items()):
            look = dict(ls="", marker=".", ms=5) if k == 0 else dict(lw=2)
            bottom.plot(t, x, color=COLOURS[k + 1], label=name, **look)
            if k == 0:
                bottom.vlines(t, 0, x, color=COLOURS[1], lw=0.7, alpha=0.6)
        bottom.set(xlabel="time, s", ylabel="acceleration, rad/s²")
        figure.legend(*bottom.get_legend_handles_labels(), loc="outside upper left", ncols=3)

    sizes = ", ".join(f"{name} {np.std(x):.3f}" for name, x in drawn.items())
    alt = (
        f"Above, readings that change by whole steps, {int(np.ptp(steps))} in all; below, "
        f"accelerations computed from them, with standard deviations in rad/s²: {sizes}."
    )
    return illustrate(draw, alt, 7.0, 4.0)


def tied(panels: Mapping[str, Mapping[str, np.ndarray]]) -> Illustration:
    """Acceleration against position: a line where one follows from the other, a cloud where not."""
    checked = {
        title: {n: shaped(f"points of {n!r}", x, "(runs, samples, 2)") for n, x in named.items()}
        for title, named in panels.items()
    }
    look = {n: k for k, n in enumerate(dict.fromkeys(n for p in checked.values() for n in p))}
    if not look:
        raise ValueError("panels must hold points, got none")

    def draw(figure: Figure):
        axes = figure.subplots(1, len(checked), squeeze=False, sharex=True)[0]
        for axis, (title, named) in zip(axes, checked.items()):
            for place, (name, points) in enumerate(named.items()):
                q, qdd = np.rad2deg(points[..., 0]), points[..., 1]
                if place:
                    k = look[name] - 1
                    axis.plot(q.ravel(), qdd.ravel(), "os^"[k % 3], color=COLOURS[k], ms=1.6,
                              mew=0, alpha=0.7, label=name)  # fmt: skip
                else:
                    lines = axis.plot(q.T, qdd.T, color=INK, lw=1.3, zorder=3)
                    lines[0].set_label(name)
            axis.set(xlabel="position, °", title=title)
        axes[0].set_ylabel("acceleration, rad/s²")
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, markerscale=3)

    def told(points):
        q, qdd = points[..., 0].ravel(), points[..., 1].ravel()
        return f"correlation {np.corrcoef(q, qdd)[0, 1]:.2f}"

    parts = [
        f"{title}: " + ", ".join(f"{name}, {told(points)}" for name, points in named.items())
        for title, named in checked.items()
    ]
    alt = f"Acceleration against position. {'; '.join(parts)}."
    return illustrate(draw, alt, 7.0, 3.0)


def extents_square(training, test, extra=None) -> Illustration:
    """The square of extents with the training and test trajectories and their hull."""
    from scipy.spatial import ConvexHull

    training, test = finite_array("training", training, 2), finite_array("test", test, 2)
    hull = training[ConvexHull(training).vertices]

    def draw(figure: Figure):
        axis = figure.subplots()
        axis.add_patch(Rectangle((0, 0), 45, 45, fill=False, edgecolor=INK, lw=0.8))
        shade = Polygon(hull, facecolor=COLOURS[0], alpha=0.18, edgecolor="none")
        axis.add_patch(shade)
        if extra is not None:
            axis.plot(*np.asarray(extra).T, ".", color=FAINT, ms=4, label="random members")
        axis.plot(*training.T, "o", color=COLOURS[0], ms=8, label="training", clip_on=False)
        axis.plot(*test, "D", color=COLOURS[1], ms=8, label="test", clip_on=False)
        for i, (x, y) in enumerate([*training, test], 1):
            axis.annotate(str(i), (x, y), (7, 5), textcoords="offset points")
        axis.set(xlabel="shoulder extent, degrees", ylabel="elbow extent, degrees")
        axis.set(xlim=(-2, 50), ylim=(-2, 50), aspect="equal", xticks=range(0, 46, 15))
        axis.set_yticks(range(0, 46, 15))
        legend_above(figure, *axis.get_legend_handles_labels())

    alt = (
        "Square of extents from 0 to 45 degrees for shoulder and elbow with five training "
        f"trajectories and test trajectory 6 at {test[0]:g} and {test[1]:g} degrees; the convex "
        "hull of the training trajectories is shaded."
    )
    return illustrate(draw, alt, 4.4, 3.9)
