"""The weights of a trained network, less those it started from (section 5.1)."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import traitlets as t
from matplotlib.gridspec import GridSpec
from matplotlib.patches import Rectangle

from ddlib.analysis import roughness
from ddlib.figures import JOINTS, TONES, illustrate
from ddlib.figures.weights import dots, hinton_on, relative_weights
from ddlib.learning import Weights
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from ddlib.widgets.still import START, encoded
from workshop.chapters.widgets import CENTRE

_HERE = Path(__file__).parent

_MARGIN = 1.06  # of the axis over the largest weight of a row


def unit_names(weights: Weights) -> dict[str, str]:
    """A network's units, outputs first: key of each -> what the page calls it.

    Keys stand in readers' links and count hidden units from 0; the page counts them from 1.
    """
    outputs = [f"{joint} torque" for joint in JOINTS]
    hidden = range(weights.hidden_bias.shape[-1])
    return dict(zip(outputs, outputs)) | {f"hidden {k}": f"hidden {k + 1}" for k in hidden}


def _rows(weights: Weights) -> np.ndarray:
    """Weights from both windows to all units, ``(unit, joint, width)``, outputs first."""
    return np.concatenate([weights.direct_weights, weights.hidden_weights])


def _diagram(weights: Weights) -> np.ndarray:
    """All weights of one network, unit by unit, as `hinton.js` draws them.

    Bias, weights on top (an output's from the hidden units, a hidden unit's to the outputs), and
    the window of each joint.
    """
    biases = [*weights.output_bias, *weights.hidden_bias]
    tops = [*weights.output_weights, *weights.output_weights.T]
    units = zip(biases, tops, _rows(weights))
    return np.concatenate([np.concatenate([[b], u, *w]) for b, u, w in units])


class WeightReader(CurveWidget):
    """Press a row of a Hinton diagram to see it as a curve, and subtract the random start.

    Parameters
    ----------
    start, trained : Weights
        One network before and after training.
    step : float
        Sampling period of the windows, s; `ddlib.simulation.LOG_STEP` of the book's recordings.
    unit, joint : str, optional
        The row that is shown first: of which unit ("hidden 0" is the first hidden one), from whose
        window. Default: the shoulder's row of the shoulder torque.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = bundle(_HERE / "hinton.js", _HERE / "weights.js")
    _css = styles(_HERE / "hinton.css", _HERE / "weights.css")

    hinton = t.Dict(help="layout of the diagram", read_only=True).tag(sync=True)

    def __init__(
        self,
        start: Weights,
        trained: Weights,
        step: float,
        *,
        unit: str | None = None,
        joint: str = JOINTS[0],
        **options,
    ):
        shapes = [[getattr(w, f.name).shape for f in fields(Weights)] for w in (start, trained)]
        if shapes[0] != shapes[1] or trained.hidden_bias.ndim != 1:
            raise ValueError(f"start and trained must be one network, got {start!r}, {trained!r}")
        parts = [getattr(trained, f.name) - getattr(start, f.name) for f in fields(Weights)]
        self._shown = {False: trained, True: Weights(*parts)}
        names = unit_names(trained)
        self._names = list(names)
        reach, half = trained.width // 2, step * 1e3
        time = np.arange(-reach, reach + 1) * half
        scales = {False: "row", True: "network"}
        self._cells = {
            (subtract, common): _diagram(relative_weights(weights, scale, trained))
            for subtract, weights in self._shown.items()
            for common, scale in scales.items()
        }
        unit = self._names[0] if unit is None else unit
        rows = {name: f"the {name}'s" for name in JOINTS}
        scale_of = {False: "row by row", True: "as in the report"}
        part = {False: "as trained", True: "what training added"}
        layout = {"units": self._names, "names": list(names.values()), "joints": list(JOINTS)}
        self.set_trait("hinton", layout | {"outputs": len(JOINTS), "width": trained.width})
        super().__init__(
            self._curves,
            [
                Choice("subtract", "Subtract the start", part, False, "switch"),
                Choice("common", "One scale for all", scale_of, False, "switch"),
                Choice("unit", "Unit", names, unit),
                Choice("joint", "Window", rows, joint),
            ],
            [
                Panel(
                    "The row as a curve: weights",
                    {"weights": "weight"},
                    CENTRE,
                    time,
                    kind="stems",
                    y_range=("lowest", "highest"),
                    roles={"weight": "network"},
                )
            ],
            title="Read the weights",
            alt=(
                f"All weights of a trained network as squares, in {len(names)} grey blobs, one "
                f"for each unit; and a row of the unit {names.get(unit, unit)}, from the {joint}'s "
                "window, as squares above and as a curve below."
            ),
            scalars=[
                Scalar("largest", "Largest weight of the row", digits=3),
                Scalar("roughness", "Roughness of the row (noise: 1)", digits=3),
            ],
            **options,
        )
        self._keep(still=self._drawn())

    def _row(self, subtract, unit, joint) -> np.ndarray:
        return _rows(self._shown[subtract])[self._names.index(unit), JOINTS.index(joint)]

    def _curves(self, subtract, common, unit, joint) -> dict:
        both = [self._row(subtracted, unit, joint) for subtracted in (False, True)]
        full = self._shown[False].largest if common else np.abs(both[0]).max()
        return {
            "weights": both[subtract],
            "lowest": _MARGIN * min(0.0, np.min(both)),
            "highest": _MARGIN * max(0.0, np.max(both)),
            "largest": np.abs(both[subtract]).max(),
            "roughness": roughness(both[subtract]),
            "full": full,
            "weights of all units": self._cells[subtract, common],
        }

    def _drawn(self) -> str:
        """The starting state as a picture: the diagram, the row, its curve."""
        weights, row = self._shown[False], self._row(False, self.unit, self.joint)
        time = self._panels[0].x
        step = time[1] - time[0]
        place = self._names.index(self.unit), JOINTS.index(self.joint)

        def draw(figure):
            grid = GridSpec(2, 2, figure, height_ratios=(1, 8), width_ratios=(1.1, 1))
            hinton_on(figure.add_subplot(grid[:, 0]), weights, "row", place)
            squares, curve = (figure.add_subplot(grid[k, 1]) for k in range(2))
            squares.add_patch(Rectangle((-0.7, -0.7), row.size + 0.4, 1.4, fc="#8c8c8c", lw=0))
            dots(squares, row, 0, 0, 1, 1, np.abs(row).max())
            ends = -0.5, row.size - 0.5
            squares.set(xlim=ends, ylim=(-0.7, 0.7), aspect="equal")
            squares.set_title(f"{unit_names(weights)[self.unit]}, {self.joint}'s window")
            squares.axis("off")
            curve.vlines(time, 0, row, color=TONES["network"])
            curve.plot(time, row, "o", ms=4, color=TONES["network"])
            curve.set(xlim=(time[0] - step / 2, time[-1] + step / 2), xlabel=CENTRE)
            curve.set_ylabel("weight")

        return START + encoded(illustrate(draw, self.still_alt, 7.0, 4.2).svg)
