"""Training as a film: weight functions and errors over the epochs (sections 3.3 and 5.1)."""

from __future__ import annotations

import numpy as np
import traitlets as t

from ddlib._check import filled, finite_array, instance, integer, told
from ddlib.learning import TorqueModel
from ddlib.setups import errors
from ddlib.simulation import Recording
from ddlib.widgets.base import Panel, Scalar
from ddlib.widgets.hinton import (
    CENTRE,
    JOINTS,
    _diagram,
    _HintonWidget,
    common_step,
    unit_names,
    weight_functions,
)
from ddlib.widgets.parts.parameters import Choice
from ddlib.widgets.scripts import bundle, styles

_MOVED = 0.05  # the film begins where the weights have gone this part of their way
_ERRORS = {"training": "training", "test": "trajectory 6"}


class TrainingPlayer(_HintonWidget):
    """Play a training run: from random weights to smooth filters.

    The slider steps over the recorded epochs, which are equally spaced on a log scale.
    Between them the error of a network trained with momentum swings.
    The film begins where the weights have gone a twentieth of their way from start to end.

    Parameters
    ----------
    epochs : array_like, shape (epochs,)
        Epochs after which weights were kept, 0 for the initial ones.
    model : TorqueModel
        Weights with leading axes ``(epochs, members)``, as from `workshop.report.results.course`.
    recording : Recording
        The six runs of Appendix I, on which the errors are taken.
    member : int
        Which network.
    **options
        Passed on to `CurveWidget`.
    """

    _esm = bundle("hinton.js", "player.js")
    _css = styles("hinton.css", "player.css")

    begin = t.Int(help="the film's first epoch", read_only=True).tag(sync=True)

    def __init__(
        self, epochs, model: TorqueModel, recording: Recording, member: int = 0, **options
    ):
        filled("epochs", epochs)
        instance("model", model, TorqueModel)
        instance("recording", recording, Recording)
        epochs = finite_array("epochs", epochs).astype(int)
        if epochs.ndim != 1 or (np.diff(epochs) <= 0).any() or epochs[0] < 0:
            raise ValueError(f"epochs must increase from 0 or later, got {told(epochs)}")
        shape = model.weights.hidden_bias.shape
        if len(shape) != 3 or shape[0] != len(epochs):
            raise ValueError(
                f"model must have leading axes ({len(epochs)} epochs, members), got {shape[:-1]}"
            )
        integer("member", member, 0, shape[1] - 1)
        self._index = {epoch: k for k, epoch in enumerate(epochs.tolist())}
        self._weights = model.weights[:, member]
        every = errors(model[:, member], recording).named()
        self._errors = {name: every[name] for name in _ERRORS}
        names = unit_names(self._weights[0])
        self._names = list(names)
        self._reach = self._weights.width // 2
        self._functions = weight_functions(self._weights)
        period = common_step([model], recording.step)
        time = np.arange(-self._reach, self._reach + 1) * period * 1e3
        begin = int(epochs[_moved(self._weights)])
        self.set_trait("begin", begin)
        places = np.log10(np.maximum(epochs, 1))
        started, last = epochs > 0, places[-1]
        # inside the axis by more than the rounding of the table
        self._places = np.clip(places, 1e-3 * last, (1 - 1e-3) * last)
        super().__init__(
            self._weights[0],
            self._reach,
            self._curves,
            [
                Choice("unit", "Unit", names, self._names[0]),
                Choice(
                    "epoch",
                    "Epoch",
                    {epoch: f"{epoch:,}" for epoch in self._index},
                    begin,
                    display="slider",
                ),
            ],
            [
                Panel(
                    "Weights of the unit",
                    {f"{joint} weights": f"from the {joint}'s window" for joint in JOINTS},
                    CENTRE,
                    time,
                    y_range=("lowest", "highest"),
                ),
                Panel(
                    "RMSS",
                    (),
                    "epoch",
                    places[started],
                    x_scale="power",
                    y_scale="log",
                    y_range=_decades(list(self._errors.values())),
                    fixed={name: self._errors[n][started] for n, name in _ERRORS.items()},
                    cursor="place",
                ),
            ],
            title="Training player",
            alt=(
                f"The weights of the shoulder torque's unit after {begin:,} epochs, and the "
                f"network's RMSS on training runs and trajectory 6 over {epochs[-1]:,} epochs."
            ),
            scalars=[
                *(Scalar(f"{n} RMSS", f"RMSS, {name}") for n, name in _ERRORS.items()),
                Scalar("largest", "Weight of the largest square", digits=2),
            ],
            **options,
        )

    def _curves(self, unit, epoch) -> dict:
        k, u = self._index[epoch], self._names.index(unit)
        return {
            **{f"{j} weights": f for j, f in zip(JOINTS, self._functions[k, u])},
            "lowest": self._functions[:, u].min(),
            "highest": self._functions[:, u].max(),
            **{f"{n} RMSS": errors[k] for n, errors in self._errors.items()},
            "place": self._places[k],
            "largest": np.abs(_diagram(self._weights[k], self._reach)).max(),
            "weights of all units": _diagram(self._weights[k], self._reach),
        }


def _moved(weights) -> int:
    """Place of the first epoch at which the weights have gone a part `MOVED` of their way."""
    ways = [
        (x - x[:1]).reshape(len(x), -1)
        for x in (weights.hidden_weights, weights.direct_weights, weights.output_weights)
    ]
    length = np.linalg.norm(np.hstack(ways), axis=1)
    return int(np.argmax(length >= _MOVED * length[-1]))


def _decades(values) -> tuple[float, float]:
    """The powers of ten around all values."""
    low, high = np.log10(np.min(values)), np.log10(np.max(values))
    return 10.0 ** np.floor(low), 10.0 ** np.ceil(high)
