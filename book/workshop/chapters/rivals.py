"""*Rivals*: errors by seed and day, the window network as a convolution, a figure of errors."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import torch
from matplotlib.figure import Figure
from torch import nn

from ddlib.figures import COLOURS, FAINT, Illustration, check_label, illustrate
from ddlib.figures.style import NARROW
from ddlib.learning import Weights
from workshop.report import results


def dots(
    rivals: Mapping[str, tuple], marked: str, floor: float, labels: tuple, alt: str
) -> Illustration:
    """Errors of rivals on a logarithmic axis, the least on top: the median, and least to largest.

    Of ``{rival: (errors, text, ...)}`` the texts stand in columns on the right, headed by
    ``labels[1:]``; a narrow page leaves them out.
    """
    order = sorted(rivals, key=lambda name: np.median(rivals[name][0]))
    if marked not in order:
        raise ValueError(f"marked must be one of {', '.join(order)}, got {marked!r}")
    places = np.arange(len(order))

    def draw(figure: Figure):
        wide = figure.get_figwidth() > NARROW
        axis, *beside = np.atleast_1d(
            figure.subplots(1, 1 + wide, sharey=True, width_ratios=(3.5, 1)[: 1 + wide])
        )
        axis.set(xscale="log", ylim=(len(order) - 0.4, -0.6), xlabel=check_label(labels[0]))
        axis.axvline(floor, color=FAINT, ls=":", lw=1.4)
        for k, name in enumerate(order):
            errors, look = np.asarray(rivals[name][0], float), COLOURS[int(name == marked)]
            axis.plot([errors.min(), errors.max()], [k, k], color=look, lw=1.4)
            axis.plot(np.median(errors), k, "D" if name == marked else "o", color=look, ms=5)
        axis.set_yticks(places, [check_label(name) for name in order])
        axis.tick_params(axis="y", length=0)
        axis.grid(axis="y", color=FAINT, lw=0.4, alpha=0.5)
        axis.minorticks_off()
        axis.set_xticks((0.03, 0.1, 0.3, 1.0), ("0.03", "0.1", "0.3", "1"))
        for words in beside:
            words.set_axis_off()
            for column, label in enumerate(labels[1:], 1):
                x = column / (len(labels) - 1)
                words.text(x, -0.8, label, ha="right", va="bottom")
                for k, name in enumerate(order):
                    words.text(x, k, rivals[name][column], ha="right", va="center")

    return illustrate(draw, alt, 7.0, 0.23 * len(order) + 0.7)


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
