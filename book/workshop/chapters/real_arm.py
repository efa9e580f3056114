"""*A real arm*: its configured friction; figures of friction and gains, joint by joint."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ddlib._check import integer
from ddlib.figures import COLOURS, FAINT, INK, Illustration, check_label, dots_in_one, illustrate

# from the configuration of the TX40's source
REDUCTION = (32.0, 32.0, 45.0, -48.0, 45.0, 32.0)  # turns of a motor; motor 6 turns joint 5, too
COULOMB = (7.14, 8.26, 6.34, 2.48, 3.03, 0.28)  # friction of the joints, N m


def friction_by_joint(panels: dict[str, tuple], labels: tuple[str, str], alt: str) -> Illustration:
    """Current that friction takes over the speed, one panel a joint: as found and as identified.

    A panel has the speed and the current of all cases, both in the middle of groups of them, and
    the slope and the jump at rest of the identified friction.
    """

    def draw(figure: Figure):
        axes = figure.subplots(-(-len(panels) // 2), 2, squeeze=False).ravel()
        for axis, (title, (speed, current, middle, median, line)) in zip(axes, panels.items()):
            _dots(axis, speed, current, 42, ec=FAINT, lw=1.6, alpha=0.5)
            for side in (-1, 1):
                end = side * np.abs(speed).max()
                far = line[0] * end + side * line[1]
                axis.plot([0, end], [side * line[1], far], color=COLOURS[1], ls="--", lw=1.8)
            _dots(axis, middle, median, 1000, ec=COLOURS[0], lw=3.6, zorder=3)
            axis.set_title(title)
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(check_label(labels[0]))
        figure.supylabel(check_label(labels[1]))

    return illustrate(draw, alt, 5.4, 1.75 * -(-len(panels) // 2) + 0.3)


def _dots(axis: Axes, x, y, cells: int, **look) -> None:
    """Dots, of several in a cell of the plane one."""
    place = np.column_stack([x, y])
    step = np.ptp(place, axis=0) / cells
    _, first = np.unique(np.round(place / np.where(step > 0, step, 1)), axis=0, return_index=True)
    dots_in_one(axis, place[first], **look)
    axis.update_datalim(place)
    axis.autoscale_view()


def gains_by_joint(panels: dict[str, tuple], label: str, alt: str) -> Illustration:
    """Gains of networks over the arm's, joint by joint, beside those on unrelated currents.

    Of ``{title: (real, unrelated)}``, shape (networks, joint), as multiples of the identified
    value, every real one is a dot; a bar holds the middle nine tenths of the others.
    """

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axis, (title, (real, unrelated)) in zip(axes, panels.items()):
            place = np.arange(1, np.shape(real)[1] + 1)
            low, high = np.percentile(unrelated, (5, 95), axis=0)
            axis.bar(
                place, high - low, 0.55, low, color=FAINT, alpha=0.4, label="unrelated currents"
            )
            axis.axhline(1, color=INK, ls="--", lw=1, label="as identified")
            for k, gains in enumerate(real):
                x = place + 0.3 * (k / max(len(real) - 1, 1) - 0.5)
                name = "real currents" if k == 0 else None
                axis.plot(x, gains, "o", color=COLOURS[0], ms=3.5, mew=0, alpha=0.8, label=name)
            axis.set(title=title, xticks=place)
            axis.grid(visible=False, axis="x")
        axes[0].set_ylabel(check_label(label))
        figure.supxlabel("joint")
        handles = axes[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper left", ncols=3)

    return illustrate(draw, alt, 5.4, 3.0)


def binned(speed, current, bins: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Medians of speed and current in groups of equally many cases of like speed."""
    groups = np.array_split(np.argsort(speed), integer("bins", bins, 1, len(speed)))
    return tuple(np.array([np.median(x[g]) for g in groups]) for x in (speed, current))
