"""*Torques at run time*: a model of windows as feedforward; what predicts the error, drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from ddlib.control import ControlLaw, Controller, Feedforward
from ddlib.figures import (
    COLOURS,
    FAINT,
    Illustration,
    check_label,
    illustrate,
    legend_above,
    plain_ticks,
)
from ddlib.trajectories import Trajectory
from workshop.beyond.control.windowed import WindowFeedforward

_MARKERS = "osD^v"


def against(
    panels: dict[str, dict[str, tuple]], label: str, alt: str, equal: tuple[str, ...]
) -> Illustration:
    """A quantity over its predictors, both logarithmic: a panel each, a dot for each member.

    Of ``{x label: {group: (x, y)}}`` a group looks the same in every panel. Panels named in
    `equal`, whose predictor has the unit of the quantity, get a line of equal values.
    """
    names = list(dict.fromkeys(name for groups in panels.values() for name in groups))

    def draw(figure: Figure):
        axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
        handles = {}
        for axis, (title, groups) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            for name, (x, y) in groups.items():
                k = names.index(name)
                look = {"color": COLOURS[k % len(COLOURS)], "ms": 4, "mew": 0, "alpha": 0.8}
                (handles[name],) = axis.plot(x, y, _MARKERS[k % len(_MARKERS)], **look)
            if title in equal:
                both = np.concatenate([np.ravel(values) for values in groups.values()])
                ends = [both.min(), both.max()]
                axis.plot(ends, ends, color=FAINT, ls="--", lw=1)
            axis.set_xlabel(check_label(title))
            plain_ticks(axis.xaxis)
            plain_ticks(axis.yaxis)
        axes[0].set_ylabel(check_label(label))
        legend_above(figure, [handles[name] for name in names], names)

    return illustrate(draw, alt, 7.0, 2.9)


@dataclass(frozen=True)
class PlannedTorque:
    """Torques of a planned motion by a model of windows, added to a feedback law (Figure 2-1).

    `ddlib.control.Feedforward` does the same for any model; this one knows that a model of windows
    has a sampling period, and refuses a loop that does not give it.
    """

    feedforward: WindowFeedforward
    feedback: Controller

    def start(self, reference: Trajectory, step: float) -> ControlLaw:
        """The law that follows `reference`, called every `step` s."""
        self.feedforward.check(step)
        return Feedforward(self.feedforward, self.feedback).start(reference, step)
