"""A weight function of a trained network, taken apart (section 5.1)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import traitlets as t

from ddlib._check import integer
from ddlib.analysis import (
    CLASSES,
    basis,
    classify,
    content,
    decompose,
    frequency_response,
    purest,
    shares,
)
from ddlib.analysis.filters import NAMED_CLASSES
from ddlib.learning import TorqueModel, Weights
from ddlib.widgets.base import Panel
from ddlib.widgets.hinton import (
    CENTRE,
    JOINTS,
    _check_models,
    _diagram,
    _HintonWidget,
    common_step,
    share_panel,
    unit_names,
    weight_functions,
    width_choice,
    zero_padded,
)
from ddlib.widgets.parts.parameters import Choice, Presets
from ddlib.widgets.scripts import bundle, styles

# Where the gain is shown, over the sampling rate: the widest window has a zero every 0.024.
_FREQUENCIES = np.linspace(0.005**0.5, 0.2**0.5, 121) ** 2
_FLOOR = 1e-3  # lowest gain shown, as a part of the largest: a zero of the response has none


class FilterExplorer(_HintonWidget):
    """Choose a weight function on a Hinton diagram; see its parts, shares and gain.

    Filters of different windows share one axis: a filter of 11 samples is one of 41 samples
    with zeros on both sides. The window itself is shaded.

    Parameters
    ----------
    models : mapping
        Window size -> `TorqueModel` of an ensemble; with one size there is no menu of sizes.
    members : sequence of int
        Which networks of each ensemble can be chosen, by their seed; two or more.
    step : float, optional
        Sampling period of the windows, s. Default: the one that the models know.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = bundle("hinton.js", "explorer.js")
    _css = styles("hinton.css", "explorer.css")

    classes = t.List(list(CLASSES), read_only=True, help="names by the rule").tag(sync=True)

    def __init__(
        self,
        models: Mapping[int, TorqueModel],
        members: Sequence[int] = (0, 1, 2),
        *,
        step: float | None = None,
        **options,
    ):
        models = _check_models(models)
        self._step = step = common_step(models.values(), step)
        self._weights = {width: model.weights for width, model in models.items()}
        for weights in self._weights.values():
            for member in members:
                integer("members", member, 0, len(weights) - 1)
        some = next(iter(self._weights.values()))
        self._reach = reach = max(self._weights) // 2
        time = np.arange(-reach, reach + 1) * step * 1e3
        parts = {name: name for name in ("even", "odd", "constant")}
        energy = dict(enumerate(("pos.", "vel.", "acc.", "jerk", "rest")))
        gains = {"gain": "whole", "gain, varying": "without its constant"}
        gains |= {"gain, ideal": "ideal derivative"}
        window = {"cursor": ("first", "last"), "y_fit": True}
        sizes = [width_choice(self._weights)] if len(self._weights) > 1 else []
        super().__init__(
            some[0],
            reach,
            self._curves,
            [
                *sizes,
                Choice("seed", "Network", {k: f"seed {k}" for k in members}, members[0]),
                Choice("unit", "Unit", unit_names(some[0]), next(iter(unit_names(some[0])))),
                Choice("joint", "Window of", JOINTS, JOINTS[0]),
            ],
            [
                Panel("Weights", "weights", CENTRE, time, kind="stems", **window),
                Panel("Parts of the weights", parts, CENTRE, time, **window),
                share_panel("Share of the energy", "responds to", energy),
                Panel(
                    "Gain",
                    gains,
                    "frequency, Hz",
                    _FREQUENCIES / step,
                    x_scale="log",
                    y_scale="power",
                    y_range=("lowest gain", "highest gain"),
                ),
            ],
            title="Filter explorer",
            alt=(
                "The weights from the shoulder's window to the shoulder torque as stems. Their "
                "constant, even and odd parts. The share of position, velocity, acceleration and "
                "jerk in their energy. Their gain over frequency."
            ),
            note=(
                "Both axes of the gain are logarithmic, so a derivative is a straight line. The "
                "line shows the filter's main derivative, as the filter takes it of slow signals. "
                "From 1 to 10 Hz it rises by a factor of 10 for velocity, and by a factor of 100 "
                "for acceleration."
            ),
            presets=Presets(_named(self._weights, members, bool(sizes)), "Named filters"),
            **options,
        )

    def _filter(self, seed, unit, joint, width):
        weights = self._weights[width][seed]
        return weight_functions(weights)[list(unit_names(weights)).index(unit), JOINTS.index(joint)]

    def _curves(self, seed, unit, joint, width=None) -> dict:
        width = width or next(iter(self._weights))
        f = self._filter(seed, unit, joint, width)
        parts = decompose(f)
        half = (width // 2 + 0.5) * self._step * 1e3
        constant = np.broadcast_to(parts.constant, f.shape)
        filters = {"weights": f, "constant": constant, "even": parts.even, "odd": parts.odd}
        return {
            **{name: zero_padded(part, self._reach) for name, part in filters.items()},
            "shares": shares(f),
            **_gains(f, self._step),
            "class": CLASSES.index(classify(f)),
            "first": -half,
            "last": half,
            "weights of all units": _diagram(self._weights[width][seed], self._reach),
        }


def _named(weights: Mapping[int, Weights], members: Sequence[int], sized: bool) -> dict[str, dict]:
    """The purest hidden filters of the middle window size, by the names that the rule gives."""
    width = sorted(weights)[len(weights) // 2]
    every = weights[width].hidden_weights[list(members)]
    names = classify(every)
    presets = {}
    for name in NAMED_CLASSES:
        if (names == name).any():
            place = np.argwhere((every == purest(every, name)).all(-1))[0]
            member, unit, joint = map(int, place)
            presets[name] = {
                **({"width": width} if sized else {}),
                "seed": members[member],
                "unit": f"hidden {unit}",
                "joint": JOINTS[joint],
            }
    return presets


def _gains(f, step: float) -> dict[str, np.ndarray]:
    """Gains as powers of ten: of a filter, of its varying part, of its main derivative; ends."""
    frequencies = _FREQUENCIES / step
    gain = np.abs(frequency_response([f, f - f.mean()], frequencies, step))
    highest = gain.max()
    gain = np.log10(np.maximum(gain, _FLOOR * highest))
    main = 1 + np.argmax(np.abs(content(f)[1:]))
    samples = np.arange(f.size) - f.size // 2
    moment = (samples * step) ** main @ basis(f.size)[main] * content(f)[main]
    ideal = np.abs(moment) / math.factorial(main) * (2 * np.pi * frequencies) ** main
    return {
        **dict(zip(("gain", "gain, varying"), gain)),
        "gain, ideal": np.log10(np.maximum(ideal, _FLOOR * highest)),
        "lowest gain": np.floor(gain.min()),
        "highest gain": np.ceil(np.log10(highest)),
    }
