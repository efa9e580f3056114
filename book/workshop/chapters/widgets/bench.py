"""A row of weights as a strip to fold, and a joint's path under it as a wire to bend."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import traitlets as t

from ddlib.figures import INK, TONES, illustrate
from ddlib.widgets.base import PageWidget
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded

_HERE = Path(__file__).parent

PARTS = ("constant", "even", "odd")
REACH = {"lift": 5.0, "tilt": 50.0, "bend": 1000.0}
"""How far the wire goes: °, °/s, °/s². Each lifts an end of the book's window by 5° at most."""


class FoldBench(PageWidget):
    """Fold a row of weights over its centre; move a joint under the three parts that come out.

    The strip's right half turns over the centre. Once it lies on the left half, the row's constant,
    even and odd part are multiplied with the joint's angles, sample by sample, and the products add
    up in three jars. Everything is computed in the page.

    Parameters
    ----------
    rows : mapping
        Label -> weights ``(width,)`` per radian, oldest sample first; of one odd width.
    step : float
        Sampling period of the rows, s; `ddlib.simulation.LOG_STEP` of the book's recordings.
    motion : array_like, shape (time, 3)
        Angle, velocity and acceleration of a joint, rad and s: what is played under the row.
    """

    _esm = bundle(_HERE / "bench.js")
    _css = styles(_HERE / "bench.css")

    row = t.Unicode(help="label of the row").tag(sync=True)
    fold = t.Float(0.08, min=0.0, max=1.0, help="from 0, flat, to 1, folded over").tag(sync=True)
    lift = t.Float(0.0, help="angle in the window's centre, °").tag(sync=True)
    tilt = t.Float(0.0, help="speed in the window's centre, °/s").tag(sync=True)
    bend = t.Float(0.0, help="acceleration, °/s²").tag(sync=True)

    def __init__(self, rows: Mapping[str, np.ndarray], step: float, motion):
        self._rows = {k: np.asarray(f, float) for k, f in rows.items()}
        first = next(iter(self._rows))
        alt = (
            "A strip of paper with the weights of one row as stems; below it a joint's path in the "
            "window as a wire."
        )
        spec = {
            "key": "bench",
            "title": "Fold a row of weights",
            "step": step,
            "reach": REACH,
            "labels": list(self._rows),
            "rows": {label: f.tolist() for label, f in self._rows.items()},
            "motion": np.round(np.transpose(motion), 5).tolist(),
        }
        self._keep(spec=spec, still=_still(self._rows[first], step, alt), still_alt=alt)
        super().__init__(row=first)

    @t.validate("lift", "tilt", "bend")
    def _within(self, proposal):
        name, value = proposal.trait.name, proposal.value
        if not abs(value) <= REACH[name]:
            raise t.TraitError(f"{name} must lie within ±{REACH[name]:g}, got {value:g}")
        return value

    @t.validate("row")
    def _known(self, proposal):
        if proposal.value not in self._rows:
            known = ", ".join(self._rows)
            raise t.TraitError(f"row must be among {known}, got {proposal.value!r}")
        return proposal.value


def _still(f, step, alt) -> str:
    """The flat strip with its stems over the wire of a joint at rest."""
    x = 1e3 * step * (np.arange(f.size) - f.size // 2)

    def draw(figure):
        strip, wire = figure.subplots(2, 1, sharex=True)
        strip.vlines(x, 0, f, color=TONES["network"])
        strip.plot(x, f, "o", ms=4, color=TONES["network"])
        strip.axvline(0, color=INK, linestyle="--", linewidth=0.8)
        strip.set(title="The row: fold it here", yticks=[])
        wire.plot(x, np.zeros(f.size), "o-", ms=3, color=TONES["shoulder"])
        wire.set(title="The joint: its angle, °", xlabel="time from the centre, ms")
        wire.set_ylim(-10, 10)

    return START + encoded(illustrate(draw, alt, width=5.8, height=4.2).svg)
