"""Write on trained networks: physical numbers into rows of weights, and knobs on parts of rows.

A row is a unit's weights along the windows of the joints. Angles count from zero: a window of zeros
(rad) gives each unit the net input that it had, so biases follow what is written.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ddlib.analysis import LAYERS, basis, savitzky_golay
from ddlib.learning import TorqueModel

_BIASES = {"hidden": "hidden_bias", "direct": "output_bias"}  # of the layers


def moment_filters(width: int, step: float) -> np.ndarray:
    """Filters of least energy that have one moment each, shape (3, width).

    `ddlib.analysis.gains` of them is the identity, and their third moments are zero. The filters of
    Savitzky & Golay for position, velocity and acceleration are just these.
    """
    return np.stack([savitzky_golay(width, order, step) for order in range(3)])


def knobs(width: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Two sets of three knobs each: rows that measure a part of a filter, and the part itself.

    "shape": constant, line and (centred) parabola of `ddlib.analysis.basis`, as they are seen in a
    filter. "moment": the filter's stiffness, damping and inertia, which `moment_filters` write. The
    shapes are not quite the moments: a constant has a second moment, too, and who wants a stiffness
    without an inertia has to draw a parabola against it.
    """
    shapes, x = basis(width)[:3], np.arange(width) - width // 2
    moments = np.stack([np.ones(width), x, x**2 / 2])
    return {"shape": (shapes, shapes), "moment": (moments, moment_filters(width, 1.0))}


def added(model: TorqueModel, change: dict[str, np.ndarray]) -> TorqueModel:
    """Networks with `change` added to the filters of some of `LAYERS`, their biases adapted."""
    fields, at_zero = {}, model.inputs.scale(np.zeros(model.inputs.low.size))
    for layer, more in change.items():
        filters, biases = (getattr(model.weights, by[layer]) for by in (LAYERS, _BIASES))
        fields[LAYERS[layer]] = filters + more
        fields[_BIASES[layer]] = biases - more.sum(-1) @ at_zero
    return replace(model, weights=replace(model.weights, **fields))


def turned(model: TorqueModel, knob, factor: float, layers=tuple(LAYERS)) -> TorqueModel:
    """Networks whose rows have one part multiplied by `factor`, in some layers.

    `knob` is a pair ``(measure, part)`` of rows of `knobs`, each of shape (width,).
    """
    measure, part = knob
    rows = {layer: getattr(model.weights, LAYERS[layer]) for layer in layers}
    return added(
        model, {k: (factor - 1) * (f @ measure)[..., None] * part for k, f in rows.items()}
    )


def output_slopes(model: TorqueModel, windows) -> np.ndarray:
    """Mean slope of the output units over windows, ``(..., output)``."""
    output = model.weights.activity(model.scaled(windows))[1]
    return (output * (1 - output)).mean(-2)


def written(model: TorqueModel, windows, change, filters, rounds: int = 1) -> TorqueModel:
    """Networks with stiffness, damping and inertia added to their direct weights, untrained.

    Parameters
    ----------
    model : TorqueModel
        One network or an ensemble.
    windows : array_like, shape (cases, joint, width)
        Positions, rad, over which the slope of the output units is averaged.
    change : array_like, shape (output, joint, 3)
        N m/rad, N m s/rad and kg m^2 to add.
    filters : array_like, shape (3, width)
        What stands for position, velocity and acceleration: `moment_filters`.
    rounds : int
        How often the slope is taken: again from the network as it was written the last time.
    """
    torque = np.asarray(change, dtype=float) @ filters
    scaled = torque * model.outputs.gain[:, None, None] / model.inputs.gain[:, None]
    result = model
    for _ in range(rounds):
        slopes = output_slopes(result, windows)[..., None, None]
        result = added(model, {"direct": scaled / slopes})
    return result
