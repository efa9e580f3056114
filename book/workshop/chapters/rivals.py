"""*Rivals*: errors by seed and day, the window network as a convolution, a figure of costs."""

from __future__ import annotations

import numpy as np
import torch
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from torch import nn

from ddlib.figures import COLOURS, FAINT, INK, Illustration, check_label, illustrate, legend_above
from ddlib.learning import Weights
from workshop.report import results

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


def tested(rival: str, part: str = "torque", split: str = "loader") -> np.ndarray:
    """Errors of a rival on the test characters, one for each seed: squares, in (N m)²."""
    rows = results.read("characters")["rivals"][split][rival]["test"]
    return np.array([row[part] for row in rows])


def asked(process: str, part: str = "trajectory 6", what: str = "covered") -> np.ndarray:
    """What ``gaussian-intervals`` found each day: the share covered, or the "rmss"."""
    rows = results.read("gaussian-intervals")["processes"][process][part]
    return np.array([row[what] for row in rows])


def as_convolution(weights: Weights) -> nn.Module:
    """The window network as a convolutional one, in double precision.

    It takes scaled positions ``(recordings, joint, time)`` to output activities ``(recordings,
    output, time - width + 1)``: no window is cut, and none is computed twice.
    """
    if weights.hidden_bias.ndim != 1:
        raise ValueError(f"weights must be of one network, got {weights!r}")
    return _Slid(weights)


class _Slid(nn.Module):
    """Two convolutions of the window's width, and one of width 1 from hidden to output units."""

    def __init__(self, weights: Weights):
        super().__init__()
        (hidden, joints, width), outputs = weights.hidden_weights.shape, weights.output_bias.size
        self.hidden = nn.Conv1d(joints, hidden, width)
        self.direct = nn.Conv1d(joints, outputs, width)
        self.output = nn.Conv1d(hidden, outputs, 1, bias=False)
        given = {
            self.hidden.weight: weights.hidden_weights,
            self.hidden.bias: weights.hidden_bias,
            self.direct.weight: weights.direct_weights,
            self.direct.bias: weights.output_bias,
            self.output.weight: weights.output_weights[..., None],
        }
        for parameter, values in given.items():
            parameter.data = torch.tensor(values, dtype=torch.float64)

    def forward(self, x):
        return torch.sigmoid(self.direct(x) + self.output(torch.sigmoid(self.hidden(x))))
