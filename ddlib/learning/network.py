"""The window network of section 3 as arrays, and with its scaling: radians to newton metres.

Weights have two forms. `Weights` has five arrays with the names of section 3: this is what is read,
drawn and saved. Descent, Levenberg-Marquardt and the tangent compute with two matrices: `rows`,
a row for each unit that sees the window, with its bias in the last column, and the weights from
hidden units to outputs; `from_rows` leads back. PyTorch modules have the five arrays as parameters.
"""

from __future__ import annotations

import importlib
import io
import os
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np

from ddlib._check import finite_array, integer, like, number, seed_number, shaped, told
from ddlib.learning.windows import Scaler

INITIAL = 0.03
"""Initial weights are uniform in plus or minus this. Assumed: the report prints no range. Of five
from 0.01 to 1 it agrees best with what the report saw in its weights."""

# names of the arrays of `Weights`
WEIGHT_NAMES = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")


def _sigmoid(x):
    return 0.5 * (1 + np.tanh(0.5 * x))


@dataclass(frozen=True, repr=False)
class Weights:
    """Weights of one network, or of many with leading axes."""

    hidden_weights: np.ndarray  #: (..., hidden, joint, width): from the window, oldest first.
    hidden_bias: np.ndarray  #: (..., hidden)
    output_weights: np.ndarray  #: (..., output, hidden): from the hidden units.
    direct_weights: np.ndarray  #: (..., output, joint, width): from the window.
    output_bias: np.ndarray  #: (..., output)

    def __post_init__(self):
        for field in fields(self):
            object.__setattr__(self, field.name, np.asarray(getattr(self, field.name)))
        if self.hidden_weights.dtype.kind not in "fiu" or self.hidden_weights.ndim < 3:
            raise ValueError(
                "hidden_weights must be numbers of shape (..., hidden, joint, width), got "
                f"{told(self.hidden_weights)}"
            )
        if self.output_bias.ndim < 1:
            raise ValueError(f"output_bias must have shape (..., output), got {self.output_bias}")
        *lead, hidden, joints, width = self.hidden_weights.shape
        outputs = self.output_bias.shape[-1]
        wanted = {
            "hidden_bias": (*lead, hidden),
            "output_weights": (*lead, outputs, hidden),
            "direct_weights": (*lead, outputs, joints, width),
            "output_bias": (*lead, outputs),
        }
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {getattr(self, name).shape}")

    def __repr__(self):
        *lead, hidden, joints, width = self.hidden_weights.shape
        members = " x ".join(map(str, lead)) + " networks" if lead else "one network"
        return f"Weights({members}, {hidden} hidden units, {joints} joints, window {width})"

    @classmethod
    def random(cls, members, width, hidden=10, joints=2, outputs=2, initial=INITIAL, seed=0):
        """Weights and biases of `members` networks, drawn uniformly from [-initial, initial].

        `width` is the window size in samples; member k depends on `seed + k` only.
        """
        for name, value in (("members", members), ("width", width), ("hidden", hidden)):
            integer(name, value, 1)
        integer("members", members, 1, 10**6)
        integer("width", width, 1, 10**5)
        integer("hidden", hidden, 1, 10**5)
        integer("joints", joints, 1, 100)
        integer("outputs", outputs, 1, 100)
        number("initial", initial, 0.0, open_low=True)
        shapes = ((hidden, joints, width), (hidden,), (outputs, hidden))
        shapes += ((outputs, joints, width), (outputs,))
        draws = []
        for k in range(members):
            rng = np.random.default_rng(seed_number("seed", seed) + k)
            draws.append([rng.uniform(-initial, initial, shape) for shape in shapes])
        return cls(*(np.stack(parts) for parts in zip(*draws)))

    @classmethod
    def concatenate(cls, parts) -> Weights:
        """One ensemble of several: their members in order."""
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in WEIGHT_NAMES))

    @classmethod
    def stack(cls, parts) -> Weights:
        """Several of one shape along a new leading axis."""
        return cls(*(np.stack([getattr(p, name) for p in parts]) for name in WEIGHT_NAMES))

    def __getitem__(self, index) -> Weights:
        """The network(s) at `index` of the leading axis."""
        return Weights(*(getattr(self, name)[index] for name in WEIGHT_NAMES))

    def __len__(self) -> int:
        if self.hidden_bias.ndim < 2:
            raise TypeError("weights must be of an ensemble: a single network has no length")
        return len(self.hidden_bias)

    @property
    def width(self) -> int:
        """Window size in samples."""
        return self.hidden_weights.shape[-1]

    @property
    def largest(self) -> np.ndarray:
        """Magnitude of the largest weight or bias of each network, shape (...)."""
        lead = self.hidden_bias.ndim - 1
        each = [np.abs(getattr(self, name)) for name in WEIGHT_NAMES]
        return np.max([x.max(axis=tuple(range(lead, x.ndim))) for x in each], axis=0)

    def count(self, biases: bool = False) -> int:
        """Number of weights of one network, with or without `biases`."""
        names = [n for n in WEIGHT_NAMES if biases or not n.endswith("bias")]
        lead = self.hidden_bias.ndim - 1
        return sum(int(np.prod(getattr(self, n).shape[lead:])) for n in names)

    def activity(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Hidden and output activities, ``(..., cases, unit)``, for windows scaled to 0..1."""
        joints, width = self.hidden_weights.shape[-2:]
        x = shaped("x", x, f"(cases, {joints}, {width})")
        x = x.reshape(len(x), -1)

        def dot(weights):  # (..., units, joint, width) -> (..., cases, units)
            flat = weights.reshape(*weights.shape[:-2], -1)
            return np.swapaxes(flat @ x.T, -1, -2)

        hidden = _sigmoid(dot(self.hidden_weights) + self.hidden_bias[..., None, :])
        net = dot(self.direct_weights) + hidden @ np.swapaxes(self.output_weights, -1, -2)
        return hidden, _sigmoid(net + self.output_bias[..., None, :])


def rows(weights: Weights) -> np.ndarray:
    """Weights from the window to each unit and its bias, ``(..., unit, joint * width + 1)``.

    Hidden units come first, then the outputs with their direct weights.
    """
    like("weights", weights, "Weights")
    parts = [
        np.concatenate([w.reshape(*w.shape[:-2], -1), b[..., None]], -1)
        for w, b in (
            (weights.hidden_weights, weights.hidden_bias),
            (weights.direct_weights, weights.output_bias),
        )
    ]
    return np.concatenate(parts, -2)


def from_rows(first: np.ndarray, output_weights: np.ndarray, window: tuple) -> Weights:
    """Networks of their `rows` and hidden-to-output weights, `window` being (joints, width)."""
    hidden = output_weights.shape[-1]
    filters = first[..., :-1].reshape(*first.shape[:-1], *window)
    return Weights(
        filters[..., :hidden, :, :],
        first[..., :hidden, -1],
        output_weights,
        filters[..., hidden:, :, :],
        first[..., hidden:, -1],
    )


@dataclass(frozen=True)
class TorqueModel:
    """Trained networks with their scaling: positions in rad to torques in N m."""

    weights: Weights  #: One network or an ensemble.
    inputs: Scaler  #: Positions, rad, to 0..1.
    outputs: Scaler  #: Torques, N m, to the output units' range.
    step: float | None = None  #: Sampling period of its training windows, s, if known.

    def scaled(self, windows) -> np.ndarray:
        """Windows in rad, ``(cases, joint, width)``, scaled for the input units."""
        like("inputs", self.inputs, "Scaler")
        like("weights", self.weights, "Weights")
        shaped(
            "windows", windows, "(cases, {}, {})".format(*self.weights.hidden_weights.shape[-2:])
        )
        return self.inputs.scale(finite_array("windows", windows), joint_axis=-2)

    def torque(self, windows) -> np.ndarray:
        """Torques, N m, ``(..., cases, joint)``, for windows, rad, ``(cases, joint, width)``."""
        like("weights", self.weights, "Weights")
        like("outputs", self.outputs, "Scaler")
        return self.outputs.unscale(self.weights.activity(self.scaled(windows))[1])

    def __repr__(self) -> str:
        period = "" if self.step is None else f", {self.step:g} s apart"
        return f"TorqueModel({repr(self.weights)[8:-1]}{period})"

    def module(self):
        """The same as a `ddlib.learning.TorqueNetwork`, a PyTorch module with the scaling inside.

        Raises
        ------
        ImportError
            Without PyTorch.
        """
        # asked for by name: no result hangs on what the module looks like
        return importlib.import_module("ddlib.learning").TorqueNetwork(self)

    def __getitem__(self, index) -> TorqueModel:
        """The model(s) at `index` of the ensemble."""
        return replace(self, weights=self.weights[index])

    def save(self, path) -> None:
        """Write the model to an ``.npz`` file (float32), replacing it in one step."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        arrays = {name: getattr(self.weights, name).astype(np.float32) for name in WEIGHT_NAMES}
        for name in ("inputs", "outputs"):
            scaler = getattr(self, name)
            arrays |= {f"{name}_low": scaler.low, f"{name}_high": scaler.high}
            arrays[f"{name}_target"] = np.array(scaler.target)
        if self.step is not None:
            arrays["step"] = np.array(self.step)
        temporary = path.with_name(path.name + ".part")
        with open(temporary, "wb") as file:
            np.savez_compressed(file, **arrays)
        os.replace(temporary, path)

    @classmethod
    def load(cls, path) -> TorqueModel:
        """Read what `save` wrote; OSError if there is no file, ValueError if it is another one."""
        content = io.BytesIO(Path(path).read_bytes())
        try:
            with np.load(content) as file:
                weights = Weights(*(file[name].astype(float) for name in WEIGHT_NAMES))
                scalers = [
                    Scaler(file[f"{n}_low"], file[f"{n}_high"], tuple(file[f"{n}_target"]))
                    for n in ("inputs", "outputs")
                ]
                step = float(file["step"]) if "step" in file else None
        except Exception as error:  # damage shows in many ways: zip, zlib, numpy, shapes
            raise ValueError(f"path {str(path)!r} is not a model file: {error}") from error
        return cls(weights, *scalers, step)
