"""The widget of the evidence page *Why the filters are smooth*."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ddlib.analysis import content
from ddlib.learning import Directions, TrainingSet
from ddlib.setups import WINDOWS
from ddlib.simulation import LOG_STEP
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.hinton import CENTRE, JOINTS, share_panel, width_choice, zero_padded
from ddlib.widgets.parts.panels import Panel, Scalar
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles
from workshop.report import results
from workshop.report.studies.span import READINGS

_WHO = ("measured", "predicted")
_FLOOR = -8.0  # lowest change shown, as a power of ten of the random start
_SHARES = dict(enumerate(("bias", "pos.", "vel.", "acc.", "jerk", "rest")))

_CHARTS = 'extras.push((view) => view.el.classList.add("ddlib-spectrum"));\n'
_TWO_BY_TWO = """
.ddlib-spectrum .charts { grid-template-columns: repeat(auto-fit, minmax(min(100%, 17rem), 1fr)); }
"""


_SPECTRUM_CODE = """\
from workshop.report import results

study = results.read("span")
names = list(dict.fromkeys((x["setup"], *x["scaling"]) for x in study["cells"]))
cell = next(
    x
    for x in study["cells"]
    if (x["setup"], *x["scaling"]) == names[{case}] and x["width"] == {width}
)
place, direction = study["epochs"].index({epoch}), {direction} - 1
for who in ("measured", "predicted"):
    print(who, cell[who]["change over start"][place][direction])"""


def explorer() -> _SpectrumExplorer:
    """The widget, of the networks of the study."""
    known = {}
    for setup in READINGS:
        known[setup.name] = known.get(setup.name) or setup.record()[:5]
    sets = (
        TrainingSet.from_recording(known[setup.name], width, scaling=setup.scaling)
        for setup in READINGS
        for width in WINDOWS
    )
    return _SpectrumExplorer(results.read("span"), [*map(Directions.of, sets)], code=_SPECTRUM_CODE)


class _SpectrumExplorer(CurveWidget):
    """Pick a direction of the windows; see its shape, and watch it being learnt.

    Curves are medians over the networks of the study "span". The slider steps over the epochs
    that it kept.

    Parameters
    ----------
    study : mapping
        What `workshop.report.studies.span.span` returns, or `results.read` of it.
    directions : sequence of Directions
        Of the training set of each cell of the study, in their order.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = bundle("player.js") + _CHARTS
    _css = styles("player.css") + _TWO_BY_TWO

    def __init__(self, study: Mapping, directions: Sequence[Directions], **options):
        cells = study["cells"]
        names, self._cells = [], {}
        for cell, along in zip(cells, directions, strict=True):
            name = "{}, inputs {:g} to {:g}".format(cell["setup"], *cell["scaling"])
            names += [name] if name not in names else []
            self._cells[names.index(name), cell["width"]] = cell, along
        epochs = study["epochs"][1:]  # at epoch 0 nothing has changed
        shown = len(cells[0]["measured"]["error"][0])
        self._index = {epoch: k for k, epoch in enumerate(epochs, 1)}
        self._reach = max(width for _, width in self._cells) // 2
        places = np.log10(epochs)
        self._places = np.clip(places, 1e-3 * places[-1], (1 - 1e-3) * places[-1])
        time = np.arange(-self._reach, self._reach + 1) * LOG_STEP * 1e3
        over = {"cursor": "place", "x_scale": "power"}
        shape = [f"{joint} shape" for joint in JOINTS]
        super().__init__(
            self._curves,
            [
                Choice("case", "Recording", dict(enumerate(names)), 0),
                width_choice({width for _, width in self._cells}),
                Choice("direction", "Direction", range(1, shown + 1), 4, display="slider"),
                Choice(
                    "epoch", "Epoch", {e: f"{e:,}" for e in epochs}, epochs[-1], display="slider"
                ),
            ],
            [
                Panel(
                    "The direction as a filter",
                    dict(zip(shape, JOINTS)),
                    CENTRE,
                    time,
                    kind="stems",
                    cursor=("first", "last"),
                    y_fit=True,
                ),
                share_panel("What it responds to, share", "part of the window", _SHARES),
                Panel(
                    "Change over the start, times",
                    {f"change {who}": who for who in _WHO},
                    "epoch",
                    places,
                    fixed={"as large as the start": np.zeros(len(places))},
                    y_scale="power",
                    y_range=(_FLOOR, 3.0),
                    **over,
                ),
                Panel(
                    "Its part of the RMSS",
                    {f"error {who}": who for who in _WHO},
                    "epoch",
                    places,
                    y_fit=True,
                    **over,
                ),
            ],
            title="Learning along a direction",
            alt=(
                "A direction of the windows as a filter, the derivatives that it responds to, and "
                "over the epochs how far training has changed the weights along it, measured and "
                "predicted, and what it leaves of the error."
            ),
            scalars=[
                Scalar("variance", "Variance, times that of direction 1", scale="power"),
                *(
                    Scalar(f"now {who}", f"Change, {who}, times the start", scale="power")
                    for who in _WHO
                ),
            ],
            note="Where the change is below 1, the random start outweighs what was learnt.",
            **options,
        )

    def _curves(self, case, width, direction, epoch) -> dict:
        cell, along = self._cells[case, width]
        k, row = direction - 1, self._index[epoch]
        f, half = along.filters[k], (width // 2 + 0.5) * LOG_STEP * 1e3
        energy = [along.axes[k, -1] ** 2, *(content(f) ** 2).sum(0)]
        curves = {f"{joint} shape": zero_padded(g, self._reach) for joint, g in zip(JOINTS, f)}
        for who in _WHO:
            change = np.array(cell[who]["change over start"])[1:, k]
            change = np.log10(np.maximum(change, 10**_FLOOR))
            curves |= {f"change {who}": change, f"now {who}": change[row - 1]}
            curves[f"error {who}"] = np.array(cell[who]["error"])[1:, k]
        return {
            **curves,
            "shares": np.array([*energy, max(0.0, 1 - sum(energy))]),
            "variance": np.log10(cell["variance"][k]),
            "place": self._places[row - 1],
            "first": -half,
            "last": half,
        }
