"""One hidden unit's weights, trained from random starts of several sizes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ddlib.analysis import decompose, shares
from ddlib.figures import JOINTS
from ddlib.learning import Weights
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from workshop.chapters.widgets import CENTRE
from workshop.chapters.widgets.knob import SCRIPT, STYLE

_SHARES = list(enumerate(("pos.", "vel.", "acc.", "jerk", "rest")))


class UnitFromFiveStarts(CurveWidget):
    """Move the size of the start, and see what training makes of one row of weights.

    Parameters
    ----------
    networks : mapping
        Size of the start -> `Weights` of one network before training, and of the same one after.
    """

    _esm, _css = SCRIPT, STYLE

    def __init__(self, networks: Mapping[float, tuple[Weights, Weights]]):
        self._networks = dict(networks)
        sizes = sorted(self._networks)
        width = self._networks[sizes[0]][0].hidden_weights.shape[-1]
        units = self._networks[sizes[0]][0].hidden_weights.shape[-3]
        time = (np.arange(width) - width // 2) * LOG_STEP * 1e3
        super().__init__(
            self._curves,
            [
                Choice("size", "Start, up to", {s: f"±{s:g}" for s in sizes}, sizes[-1], "slider"),
                Choice("unit", "Hidden unit", range(1, units + 1), 1),
                Choice("joint", "Window of", JOINTS, JOINTS[0]),
            ],
            [
                Panel(
                    "Weights", {"after": "after training", "before": "before training"},
                    CENTRE, time, y_fit=True, roles={"after training": "network"},
                ),
                Panel(
                    "Parts, after training", {"even": "even", "odd": "odd", "constant": "constant"},
                    CENTRE, time, y_fit=True,
                ),
                Panel(
                    "Share of the energy", "shares", "responds to", range(len(_SHARES)),
                    kind="bars", ticks=_SHARES, y_range=(0.0, 1.0),
                ),
            ],
            alt="One row of weights before and after training, from a start of one size. "
            "Its even and odd part. The derivatives that it responds to.",
            title="One unit, five starts",
            note="All starts use the same random numbers, made larger or smaller. The "
            "recording and the number of epochs stay the same. The last bar is the share that "
            "follows neither the constant nor one of the three derivatives.",
        )  # fmt: skip

    def _curves(self, size, unit, joint) -> dict:
        pair = (w.hidden_weights for w in self._networks[size])
        before, after = (w.reshape(-1, *w.shape[-2:])[unit - 1, JOINTS.index(joint)] for w in pair)
        parts = decompose(after)
        return {
            "after": after, "before": before, "even": parts.even, "odd": parts.odd,
            "constant": np.zeros(after.shape) + parts.constant,
            "shares": shares(after),
        }  # fmt: skip
