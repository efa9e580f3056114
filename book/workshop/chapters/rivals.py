"""Figure of *Rivals*: errors against costs, a panel for each family."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ddlib.figures import COLOURS, FAINT, INK, Illustration, check_label, illustrate, legend_above

_MARKERS = "os^Dv"
_LOWEST, _HIGHEST = 0.009, 20.0  # of the errors: room for noise below, for the legends above


def costs(
    panels: dict[str, dict[str, tuple]],
    reference: tuple[str, tuple],  # name and curve of the rival that every panel shows
    floor: float,  # error that is noise alone
    labels: tuple[str, str],
    alt: str,
) -> Illustration:
    """Errors over a cost, both logarithmic: a panel for each family, one rival in all of them.

    Of ``{family: {rival: (cost, training, test)}}``, errors of shape (sizes, days), bold lines are
    medians of the test errors, bars reach from the least to the largest; dashed lines are medians
    of the training errors.
    """
    rows = -(-len(panels) // 2)

    def draw(figure: Figure):
        axes = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False).ravel()
        for axis, (family, rivals) in zip(axes, panels.items()):
            axis.set(xscale="log", yscale="log")
            axis.set_title(family)
            axis.axhline(floor, color=FAINT, ls=":", lw=1.2)
            axis.axhline(1.0, color=FAINT, lw=0.8)
            _curve(axis, reference[1], {"color": INK, "lw": 1.0, "marker": ""})
            for k, (name, curve) in enumerate(rivals.items()):
                marker = _MARKERS[k % len(_MARKERS)]
                look = {"color": COLOURS[k % len(COLOURS)], "lw": 1.8, "marker": marker}
                _curve(axis, curve, look, name)
            axis.legend(
                loc="upper left", labelcolor="linecolor", fontsize=8, borderpad=0.1,
                labelspacing=0.2, handlelength=1.4, handletextpad=0.4, borderaxespad=0.1,
            )  # fmt: skip
            axis.set_ylim(_LOWEST, _HIGHEST)
            axis.set_yticks((0.01, 0.1, 1.0), ("0.01", "0.1", "1"))
            axis.minorticks_off()
        for axis in axes[len(panels) :]:
            axis.remove()
        figure.supxlabel(check_label(labels[0]))
        figure.supylabel(check_label(labels[1]))
        looks = {
            "test": {"color": FAINT, "lw": 1.8, "marker": "o", "ms": 4},
            "training": {"color": FAINT, "lw": 1.0, "ls": "--"},
            reference[0]: {"color": INK, "lw": 1.0},
            "noise": {"color": FAINT, "ls": ":", "lw": 1.2},
        }
        legend_above(figure, [Line2D([], [], **look) for look in looks.values()], list(looks))

    return illustrate(draw, alt, 5.2, 2.9 * rows + 0.6)


def _curve(axis, curve, look, name=None) -> None:
    cost, training, test = map(np.asarray, curve)
    order = np.argsort(cost)
    cost, training, test = cost[order], training[order], test[order]
    colour, width = look["color"], look["lw"]
    axis.plot(cost, np.median(training, 1), color=colour, ls="--", lw=0.6 * width)
    axis.plot(cost, np.median(test, 1), **look, ms=4, label=name)
    axis.vlines(cost, test.min(1), test.max(1), color=colour, lw=0.8 * width, alpha=0.5)
