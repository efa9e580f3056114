"""The Hinton diagram of section 5 as a part of widgets: all weights, and a unit to choose."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import traitlets as t

from ddlib._check import number, one_of, told
from ddlib.figures import JOINTS
from ddlib.learning import TorqueModel, Weights
from ddlib.widgets.base import CurveWidget
from ddlib.widgets.parts.panels import Panel
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles

CENTRE = "time from the centre, ms"


def unit_names(weights: Weights) -> dict[str, str]:
    """A network's units, outputs first: key of each -> what the page calls it.

    Keys stand in readers' links and count hidden units from 0; the page counts them from 1.
    """
    outputs = [f"{joint} torque" for joint in JOINTS]
    hidden = range(weights.hidden_bias.shape[-1])
    return dict(zip(outputs, outputs)) | {f"hidden {k}": f"hidden {k + 1}" for k in hidden}


def weight_functions(weights: Weights) -> np.ndarray:
    """Weights from both windows to all units, ``(..., unit, joint, width)``, outputs first."""
    return np.concatenate([weights.direct_weights, weights.hidden_weights], axis=-3)


def zero_padded(f, reach: int) -> np.ndarray:
    """A filter (..., width) with zeros on both sides: `reach` samples beside its centre."""
    f = np.asarray(f)
    zeros = reach - f.shape[-1] // 2
    if zeros < 0:
        raise ValueError(f"reach must be {f.shape[-1] // 2} samples or more, got {reach}")
    return np.pad(f, [(0, 0)] * (f.ndim - 1) + [(zeros, zeros)])


def _check_models(models) -> dict[int, TorqueModel]:
    """`models` if it maps window sizes to ensembles, otherwise an error."""
    if not isinstance(models, Mapping) or not models:
        raise TypeError(f"models must map window sizes to models, got {told(models)}")
    for width, model in models.items():
        if not isinstance(model, TorqueModel):
            raise TypeError(f"models must hold TorqueModels, got {told(model)} for {told(width)}")
        if model.weights.width != width or model.weights.hidden_bias.ndim != 2:
            shape = model.weights.hidden_weights.shape
            raise ValueError(
                f"models must map each window size to an ensemble of that size, got weights of "
                f"shape {shape} for {width!r}"
            )
    return dict(models)


def common_step(models, step: float | None = None) -> float:
    """The sampling period of models, s: `step`, or what they say themselves; an error in doubt."""
    known = [model.step for model in models if model.step is not None]
    if step is not None:
        number("step", step, 0.0, open_low=True)
    elif not known:
        raise ValueError("models do not know their sampling period: give step, in s")
    else:
        step = known[0]
    if not np.allclose(known, step, rtol=1e-6, atol=0.0):
        raise ValueError(f"models must have a sampling period of {step:g} s, got {known}")
    return float(step)


def width_choice(sizes) -> Choice:
    """The menu of window sizes; the middle one is chosen at the start."""
    sizes = sorted(sizes)
    labels = {width: f"{width} samples" for width in sizes}
    return Choice("width", "Window size", labels, sizes[len(sizes) // 2])


def share_panel(title: str, x_label: str, parts: Mapping[float, str]) -> Panel:
    """Bars of the function's "shares" of a whole."""
    ticks, ends = list(parts.items()), (0.0, 1.0)
    return Panel(title, "shares", x_label, list(parts), kind="bars", ticks=ticks, y_range=ends)


def _diagram(weights: Weights, reach: int) -> np.ndarray:
    """All weights of one network, unit by unit, as `hinton.js` draws them.

    Bias, weights on top (an output's from the hidden units, a hidden unit's to the outputs), and
    the zero-padded window of each joint.
    """
    windows = zero_padded(weight_functions(weights), reach)
    biases = [*weights.output_bias, *weights.hidden_bias]
    tops = [*weights.output_weights, *weights.output_weights.T]
    units = [np.concatenate([[b], u, *w]) for b, u, w in zip(biases, tops, windows)]
    return np.concatenate(units)


class _HintonWidget(CurveWidget):
    """A `CurveWidget` with a Hinton diagram on which a unit, or one of its windows, is chosen.

    The function's result has `_diagram` under the name "weights of all units".

    Parameters
    ----------
    weights : Weights
        Any of the networks: it tells how many units there are.
    reach : int
        Samples on either side of the windows' centre in the diagram.
    largest : {"now", "ever"}
        The weight of full size: the largest at present, or of all settings.
    *args, **options
        Passed on to `CurveWidget`. A parameter "unit" is needed; with one named "joint" a
        window is chosen; one named "width" is the window size shown.
    """

    _esm = bundle("hinton.js")
    _css = styles("hinton.css")

    hinton = t.Dict(help="layout of the diagram", read_only=True).tag(sync=True)

    def __init__(self, weights: Weights, reach: int, *args, largest: str = "now", **options):
        one_of("largest", largest, ("now", "ever"))
        names = unit_names(weights)
        layout = {
            "units": list(names),
            "names": list(names.values()),
            "outputs": weights.output_bias.shape[-1],
            "joints": list(JOINTS),
            "reach": reach,
            "largest": largest,
        }
        self.set_trait("hinton", layout)
        super().__init__(*args, **options)
