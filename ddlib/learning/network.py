"""The window network of section 3: sigmoid hidden units and direct input-output weights.

`WindowNetwork` is the network as a PyTorch module, for reading and for small runs.
`Weights` is the same network (or many of them) as plain arrays, for analysis, files
and figures. `TorqueModel` adds the scaling, so that radians go in and N m come out.
"""

from __future__ import annotations

import io
import os
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np
import torch
from torch import nn

from ddlib._check import finite_array, integer, number, shaped
from ddlib.learning.windows import Scaler

_FIELDS = ("hidden_weights", "hidden_bias", "output_weights", "direct_weights", "output_bias")


def kernels() -> str:
    """Instruction set of PyTorch's kernels here, like "AVX512": it decides how sums are rounded."""
    return torch.backends.cpu.get_cpu_capability()


def _sigmoid(x):
    return 0.5 * (1 + np.tanh(0.5 * x))


@dataclass(frozen=True, repr=False)
class Weights:
    """Weights of one network, or of many with leading axes.

    Attributes
    ----------
    hidden_weights : ndarray, shape (..., hidden, joint, width)
        From the input window to the hidden units; oldest sample first.
    hidden_bias : ndarray, shape (..., hidden)
    output_weights : ndarray, shape (..., output, hidden)
        From the hidden to the output units.
    direct_weights : ndarray, shape (..., output, joint, width)
        Direct weights from the input window to the output units.
    output_bias : ndarray, shape (..., output)
    """

    hidden_weights: np.ndarray
    hidden_bias: np.ndarray
    output_weights: np.ndarray
    direct_weights: np.ndarray
    output_bias: np.ndarray

    def __post_init__(self):
        for field in fields(self):
            object.__setattr__(self, field.name, np.asarray(getattr(self, field.name)))
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
    def random(cls, members, width, hidden=10, joints=2, outputs=2, initial=0.3, seed=0):
        """Uniform random weights of `members` networks; member k depends on `seed + k` only.

        Parameters
        ----------
        members, width, hidden, joints, outputs : int
            Number of networks, of samples per joint, and of units.
        initial : float
            Weights and biases are drawn from [-initial, initial].
        seed : int
            Seed of the first member.
        """
        for name, value in (("members", members), ("width", width), ("hidden", hidden)):
            integer(name, value, 1)
        number("initial", initial, 0.0, open_low=True)
        shapes = ((hidden, joints, width), (hidden,), (outputs, hidden))
        shapes += ((outputs, joints, width), (outputs,))
        draws = []
        for k in range(members):
            rng = np.random.default_rng(integer("seed", seed, 0) + k)
            draws.append([rng.uniform(-initial, initial, shape) for shape in shapes])
        return cls(*(np.stack(parts) for parts in zip(*draws)))

    @classmethod
    def concatenate(cls, parts) -> Weights:
        """One ensemble of several: their members in order."""
        return cls(*(np.concatenate([getattr(p, name) for p in parts]) for name in _FIELDS))

    @classmethod
    def stack(cls, parts) -> Weights:
        """Several of one shape along a new leading axis."""
        return cls(*(np.stack([getattr(p, name) for p in parts]) for name in _FIELDS))

    def __getitem__(self, index) -> Weights:
        """The network(s) at `index` of the leading axis."""
        return Weights(*(getattr(self, name)[index] for name in _FIELDS))

    def __len__(self) -> int:
        if self.hidden_bias.ndim < 2:
            raise TypeError("a single network has no length")
        return len(self.hidden_bias)

    @property
    def width(self) -> int:
        """Window size in samples."""
        return self.hidden_weights.shape[-1]

    @property
    def largest(self) -> np.ndarray:
        """Magnitude of the largest weight or bias of each network, shape (...)."""
        lead = self.hidden_bias.ndim - 1
        each = [np.abs(getattr(self, name)) for name in _FIELDS]
        return np.max([x.max(axis=tuple(range(lead, x.ndim))) for x in each], axis=0)

    def count(self, biases: bool = False) -> int:
        """Number of weights of one network, with or without `biases`."""
        names = [n for n in _FIELDS if biases or not n.endswith("bias")]
        lead = self.hidden_bias.ndim - 1
        return sum(int(np.prod(getattr(self, n).shape[lead:])) for n in names)

    def activity(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Hidden and output activities for scaled windows.

        Parameters
        ----------
        x : array_like, shape (cases, joint, width)
            Windows scaled to 0..1.

        Returns
        -------
        hidden : ndarray, shape (..., cases, hidden)
        output : ndarray, shape (..., cases, output)
        """
        joints, width = self.hidden_weights.shape[-2:]
        x = shaped("x", x, f"(cases, {joints}, {width})")
        x = x.reshape(len(x), -1)

        def dot(weights):  # (..., units, joint, width) -> (..., cases, units)
            flat = weights.reshape(*weights.shape[:-2], -1)
            return np.swapaxes(flat @ x.T, -1, -2)

        hidden = _sigmoid(dot(self.hidden_weights) + self.hidden_bias[..., None, :])
        net = dot(self.direct_weights) + hidden @ np.swapaxes(self.output_weights, -1, -2)
        return hidden, _sigmoid(net + self.output_bias[..., None, :])


class WindowNetwork(nn.Module):
    """One window network as a PyTorch module (Figure 3-1).

    Parameters
    ----------
    width : int
        Window size in samples.
    hidden, joints, outputs : int
        Number of hidden units, of joints in the window and of output units.
    initial : float
        Weights and biases are drawn uniformly from [-initial, initial].
    seed : int
        Seed of that draw.
    """

    def __init__(self, width, hidden=10, joints=2, outputs=2, *, initial=0.3, seed=0):
        super().__init__()
        draw = Weights.random(1, width, hidden, joints, outputs, initial, seed)[0]
        for name in _FIELDS:
            tensor = torch.tensor(getattr(draw, name), dtype=torch.float32)
            self.register_parameter(name, nn.Parameter(tensor))

    def forward(self, x):
        """Output activities, shape (cases, output), for windows (cases, joint, width)."""
        x = x.flatten(1)
        hidden = torch.sigmoid(x @ self.hidden_weights.flatten(1).T + self.hidden_bias)
        net = x @ self.direct_weights.flatten(1).T + hidden @ self.output_weights.T
        return torch.sigmoid(net + self.output_bias)

    def weights(self) -> Weights:
        """The weights as plain arrays."""
        return Weights(*(getattr(self, name).detach().numpy().copy() for name in _FIELDS))


@dataclass(frozen=True)
class TorqueModel:
    """Trained networks with their scaling: positions in rad to torques in N m.

    Attributes
    ----------
    weights : Weights
        One network or an ensemble.
    inputs, outputs : Scaler
        Scaling of positions to 0..1 and of torques to the output units' range.
    step : float, optional
        Sampling period of the windows it was trained on, s. Default: not known.
    """

    weights: Weights
    inputs: Scaler
    outputs: Scaler
    step: float | None = None

    def scaled(self, windows) -> np.ndarray:
        """Windows in rad, ``(cases, joint, width)``, scaled for the input units."""
        return self.inputs.scale(finite_array("windows", windows), joint_axis=-2)

    def torque(self, windows) -> np.ndarray:
        """Predicted torque for windows of positions.

        Parameters
        ----------
        windows : array_like, shape (cases, joint, width)
            Positions in rad, from `ddlib.learning.windows.sliding_windows`.

        Returns
        -------
        ndarray, shape (..., cases, joint)
            Torques in N m; leading axes are the ensemble's.
        """
        return self.outputs.unscale(self.weights.activity(self.scaled(windows))[1])

    def __getitem__(self, index) -> TorqueModel:
        """The model(s) at `index` of the ensemble."""
        return replace(self, weights=self.weights[index])

    def save(self, path) -> None:
        """Write the model to an ``.npz`` file (float32), replacing it in one step."""
        path = Path(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        arrays = {name: getattr(self.weights, name).astype(np.float32) for name in _FIELDS}
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
        """Read what `save` wrote.

        Raises
        ------
        OSError
            If the file cannot be read: there is none, or no right to read it.
        ValueError
            If it is not a model file.
        """
        content = io.BytesIO(Path(path).read_bytes())
        try:
            with np.load(content) as file:
                weights = Weights(*(file[name].astype(float) for name in _FIELDS))
                scalers = [
                    Scaler(file[f"{n}_low"], file[f"{n}_high"], tuple(file[f"{n}_target"]))
                    for n in ("inputs", "outputs")
                ]
                step = float(file["step"]) if "step" in file else None
        except Exception as error:  # damage shows in many ways: zip, zlib, numpy, shapes
            raise ValueError(f"path {str(path)!r} is not a model file: {error}") from error
        return cls(weights, *scalers, step)
