"""The window network of section 3 as arrays, and with its scaling: radians to newton metres.

All weights stand in two matrices. `Weights.rows` has a row for each unit that sees the window, with
its bias in the last column; the other one is from hidden units to outputs. Descent,
Levenberg-Marquardt and the tangent compute with these two. The five arrays that section 3 names are
views of them. Files and PyTorch modules hold the five.
"""

from __future__ import annotations

import importlib
import io
import os
from dataclasses import dataclass, replace
from math import prod
from pathlib import Path

import numpy as np

from ddlib._check import finite_array, instance, integer, number, seed_number, shaped, told
from ddlib.learning.windows import Scaler

INITIAL = 0.03
"""Initial weights are uniform in plus or minus this. Assumed: the report prints no range. Of five
from 0.01 to 1 it agrees best with what the report saw in its weights."""

# names of the arrays of `Weights`
WEIGHT_NAMES = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")


def _sigmoid(x):
    return 0.5 * (1 + np.tanh(0.5 * x))


def _numbers(name, value):
    """`value` as an array, of whatever kind of real numbers; ValueError otherwise."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = None
    if array is None or array.dtype.kind not in "fiu":
        raise ValueError(f"{name} must be an array of numbers, got {told(value)}")
    return array


@dataclass(frozen=True, repr=False)
class Weights:
    """Weights of one network, or of many with leading axes.

    The arrays that are given are copied. What is written into a field is written into `rows`, too.
    """

    hidden_weights: np.ndarray  #: (..., hidden, joint, width): from the window, oldest first.
    hidden_bias: np.ndarray  #: (..., hidden)
    output_weights: np.ndarray  #: (..., output, hidden): from the hidden units.
    direct_weights: np.ndarray  #: (..., output, joint, width): from the window.
    output_bias: np.ndarray  #: (..., output)

    def __post_init__(self):
        given = {name: _numbers(name, getattr(self, name)) for name in WEIGHT_NAMES}
        filters, outputs = given["hidden_weights"], given["output_bias"]
        if filters.ndim < 3:
            raise ValueError(
                "hidden_weights must be numbers of shape (..., hidden, joint, width), got "
                f"{told(filters)}"
            )
        if outputs.ndim < 1:
            raise ValueError(f"output_bias must have shape (..., output), got {outputs}")
        *lead, hidden, joints, width = filters.shape
        wanted = {
            "hidden_bias": (*lead, hidden),
            "output_weights": (*lead, outputs.shape[-1], hidden),
            "direct_weights": (*lead, outputs.shape[-1], joints, width),
            "output_bias": (*lead, outputs.shape[-1]),
        }
        for name, shape in wanted.items():
            if given[name].shape != shape:
                raise ValueError(f"{name} must have shape {shape}, got {given[name].shape}")

        def rows_of(weights, bias):
            flat = given[weights].reshape(*given[bias].shape, joints * width)
            return np.concatenate([flat, given[bias][..., None]], -1)

        layers = rows_of("hidden_weights", "hidden_bias"), rows_of("direct_weights", "output_bias")
        output_weights = given["output_weights"].copy()
        self._stand_in(np.concatenate(layers, -2), output_weights, (joints, width))

    def _stand_in(self, rows, output_weights, window):
        """Hold two matrices, and views of them by their names."""
        hidden = output_weights.shape[-1]
        filters = rows[..., :-1].reshape(*rows.shape[:-1], *window)
        arrays = (
            filters[..., :hidden, :, :],
            rows[..., :hidden, -1],
            output_weights,
            filters[..., hidden:, :, :],
            rows[..., hidden:, -1],
        )
        for name, array in zip((*WEIGHT_NAMES, "_rows"), (*arrays, rows)):
            object.__setattr__(self, name, array)

    def __reduce__(self):  # what is copied or sent to another process has its own two matrices
        return from_rows, (self.rows, self.output_weights, self.hidden_weights.shape[-2:])

    def __repr__(self):
        *lead, hidden, joints, width = self.hidden_weights.shape
        members = " x ".join(map(str, lead)) + " networks" if lead else "one network"
        return f"Weights({members}, {hidden} hidden units, {joints} joints, window {width})"

    @classmethod
    def random(cls, members, width, hidden=10, joints=2, outputs=2, initial=INITIAL, seed=0):
        """Weights and biases of `members` networks, drawn uniformly from [-initial, initial].

        `width` is the window size in samples; member k depends on `seed + k` only.
        """
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
        return _joined(np.concatenate, list(parts))

    @classmethod
    def stack(cls, parts) -> Weights:
        """Several of one shape along a new leading axis."""
        return _joined(np.stack, list(parts))

    def __getitem__(self, index) -> Weights:
        """The network(s) at `index` of the leading axis.

        Raises
        ------
        IndexError
            If there is none at `index`, or if it goes on into the weights of a network.
        TypeError
            For an index into a single network.
        """
        lead = self.hidden_bias.shape[:-1]
        try:
            np.broadcast_to(True, lead)[index]
        except IndexError as error:
            if lead:
                raise
            raise TypeError("weights must be of an ensemble: this is a single network") from error
        window = self.hidden_weights.shape[-2:]
        return from_rows(self.rows[index], self.output_weights[index], window)

    def __len__(self) -> int:
        if self.hidden_bias.ndim < 2:
            raise TypeError("weights must be of an ensemble: a single network has no length")
        return len(self.hidden_bias)

    @property
    def rows(self) -> np.ndarray:
        """Weights from the window to each unit and its bias, ``(..., unit, joint * width + 1)``.

        Hidden units come first, then the outputs with their direct weights.
        """
        return self._rows

    @property
    def width(self) -> int:
        """Window size in samples."""
        return self.hidden_weights.shape[-1]

    @property
    def largest(self) -> np.ndarray:
        """Magnitude of the largest weight or bias of each network, shape (...)."""
        layers = (np.abs(matrix).max((-2, -1)) for matrix in (self.rows, self.output_weights))
        return np.maximum(*layers)

    def count(self, biases: bool = False) -> int:
        """Number of weights of one network, with or without `biases`."""
        units, columns = self.rows.shape[-2:]
        return units * (columns if biases else columns - 1) + prod(self.output_weights.shape[-2:])

    def activity(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Hidden and output activities, ``(..., cases, unit)``, for windows scaled to 0..1."""
        joints, width = self.hidden_weights.shape[-2:]
        x = shaped("x", x, f"(cases, {joints}, {width})")
        x = x.reshape(len(x), -1)

        def dot(rows):  # (..., unit, joint * width + 1) -> (..., cases, unit)
            return np.swapaxes(rows[..., :-1] @ x.T, -1, -2)

        units = self.hidden_bias.shape[-1]
        hidden = _sigmoid(dot(self.rows[..., :units, :]) + self.hidden_bias[..., None, :])
        direct = dot(self.rows[..., units:, :])
        net = direct + hidden @ np.swapaxes(self.output_weights, -1, -2)
        return hidden, _sigmoid(net + self.output_bias[..., None, :])


def from_rows(rows: np.ndarray, output_weights: np.ndarray, window: tuple) -> Weights:
    """Networks that stand in these two matrices, uncopied, `window` being (joints, width)."""
    units = sum(output_weights.shape[-2:])
    if rows.shape != (wanted := (*output_weights.shape[:-2], units, prod(window) + 1)):
        raise ValueError(f"rows must have shape {wanted}, got {rows.shape}")
    weights = Weights.__new__(Weights)
    weights._stand_in(rows, output_weights, window)
    return weights


def _joined(join, parts) -> Weights:
    """What numpy's `join` makes of several ensembles' matrices."""
    for part in parts:
        instance("parts", part, Weights)
    if len({(part.output_weights.shape[-2:], part.rows.shape[-1]) for part in parts}) != 1:
        raise ValueError("parts must be networks of one size, and one at least")
    if join is np.concatenate and any(part.hidden_bias.ndim < 2 for part in parts):
        raise ValueError("parts must be ensembles, of one network at least: weights[None]")
    rows = join([part.rows for part in parts])
    output_weights = join([part.output_weights for part in parts])
    return from_rows(rows, output_weights, parts[0].hidden_weights.shape[-2:])


@dataclass(frozen=True)
class TorqueModel:
    """Trained networks with their scaling: positions in rad to torques in N m."""

    weights: Weights  #: One network or an ensemble.
    inputs: Scaler  #: Positions, rad, to 0..1.
    outputs: Scaler  #: Torques, N m, to the output units' range.
    step: float | None = None  #: Sampling period of its training windows, s, if known.

    def scaled(self, windows) -> np.ndarray:
        """Windows in rad, ``(cases, joint, width)``, scaled for the input units."""
        instance("inputs", self.inputs, Scaler)
        instance("weights", self.weights, Weights)
        shaped(
            "windows", windows, "(cases, {}, {})".format(*self.weights.hidden_weights.shape[-2:])
        )
        return self.inputs.scale(finite_array("windows", windows), joint_axis=-2)

    def torque(self, windows) -> np.ndarray:
        """Torques, N m, ``(..., cases, joint)``, for windows, rad, ``(cases, joint, width)``."""
        instance("weights", self.weights, Weights)
        instance("outputs", self.outputs, Scaler)
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
