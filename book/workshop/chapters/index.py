"""The landing page: the walk as a picture of eight stations."""

from __future__ import annotations

import numpy as np
from matplotlib.patches import Rectangle

from ddlib import figures
from ddlib.analysis import shares, upright
from ddlib.figures.weights import dots
from ddlib.learning import TrainingSet, Weights, train_ensemble
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK, split

_STATIONS = "arm equations loop recording window network weights filters".split()


def stations(width: int = 21) -> figures.Illustration:
    """Eight small pictures, from the arm to the filters in a network that is trained for them."""
    setup, start = JOINT_DAMPING, Weights.random(1, width)
    recording = setup.record()
    data = TrainingSet.from_recording(split(recording)[0], width)
    how = {"momentum": 0.98, "warm_up": 500, "epochs": 4000, "progress": False}
    network, run = train_ensemble(start, data, **how)[0][0], recording[5]
    motion, time = run.motion, run.t[run.motion] - run.t[run.motion][0]
    q = np.rad2deg(run.q_true[motion])
    blue, orange, green, pink, *_ = figures.COLOURS

    def arm(axis):
        for k, at in enumerate((0, 60, 140)):
            points = setup.arm.lengths * np.exp(1j * np.cumsum(run.q_true[motion][at]))
            hand = np.cumsum([0, *points])
            axis.plot(hand.real, hand.imag, "o-", color=blue, alpha=(0.35, 0.6, 1)[k], ms=5, lw=3)
        axis.set(aspect="equal", xlim=(-0.1, 1.0), ylim=(-0.75, 0.1))

    def equations(axis):
        axis.text(0, 0.5, r"$\tau = M(q)\,\ddot{q} + c(q, \dot{q})$", fontsize=11, va="center")
        axis.set(xlim=(0, 1), ylim=(0, 1))

    def loop(axis):
        for one, colour in ((STATE_FEEDBACK, green), (setup, orange)):
            other = one.record()[5]
            off = other.tracking_error[other.motion][:120, 0]
            axis.plot(off / np.abs(off).max(), color=colour)
        axis.axhline(0, color=figures.FAINT, lw=0.7)

    def recording(axis):
        axis.plot(time[::6], q[::6, 0], ".", color=blue, ms=3)
        axis.plot(time[::6], q[::6, 1], ".", color=orange, ms=3)

    def window(axis):
        axis.plot(time, q[:, 0], color=blue, lw=1)
        box = Rectangle((0.85, q[:, 0].min()), 0.5, np.ptp(q[:, 0]), color=green, alpha=0.35, lw=0)
        axis.add_patch(box)

    def units(axis):
        inputs, hidden, outputs = (
            np.column_stack([np.full(n, x), np.linspace(-1, 1, n)])
            for x, n in ((0, 6), (1, 4), (2, 2))
        )
        for before, after in ((inputs, hidden), (hidden, outputs), (inputs, outputs)):
            for a in before:
                for b in after:
                    axis.plot(*zip(a, b), color=figures.FAINT, lw=0.4)
        for layer, colour in ((inputs, blue), (hidden, pink), (outputs, orange)):
            axis.plot(*layer.T, "o", color=colour, ms=5)

    def weights(axis):
        shown = np.concatenate([network.weights.direct_weights[0], *network.weights.hidden_weights])
        shown = shown[:8, ::2]
        axis.add_patch(Rectangle((-1, -1), shown.shape[1] + 1, 9, facecolor="#8c8c8c", lw=0))
        dots(axis, shown, 0, 0, 1, 1, np.abs(shown).max())
        axis.set(xlim=(-1, shown.shape[1]), ylim=(-1, 8))

    def filters(axis):
        own = (network.weights.hidden_weights - start.hidden_weights[0]).reshape(-1, width)
        for derivative, colour in ((1, green), (2, pink)):
            f = upright(max(own, key=lambda f: shares(f)[derivative]))
            axis.plot(f / np.abs(f).max(), color=colour)
        axis.axhline(0, color=figures.FAINT, lw=0.7)

    def draw(figure):
        pictures = arm, equations, loop, recording, window, units, weights, filters
        whole = figure.subplots()
        whole.axis("off")
        columns = 4 if figure.get_figwidth() > 5 else 2
        rows = len(pictures) // columns
        for k, picture in enumerate(pictures):
            x, y = k % columns / columns, 1 - (1 + k // columns) / rows
            place = (x + 0.02, y + 0.03, 1 / columns - 0.04, 1 / rows - 0.11)
            picture(axis := whole.inset_axes(place))
            axis.set_title(f"{k + 1} {_STATIONS[k]}")
            axis.set_xticks([])
            axis.set_yticks([])
            axis.grid(False)
            for side in axis.spines.values():
                side.set_visible(False)

    alt = (
        "Eight stations: 1, an arm of two links in three poses; 2, its equation of motion; 3, the "
        "errors of two loops, one that rings and one that does not; 4, dots of a recorded motion; "
        "5, a window laid on it; 6, a network with hidden units and direct links; 7, its weights "
        "as black and white squares; 8, two filters: what learning added to two rows of them."
    )
    return figures.illustrate(draw, alt, 7.4, 3.2, narrow_height=6.0)
