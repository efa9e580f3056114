"""What the outputs of filters follow along a recording, which depends on the motion, too."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array, like, number, shaped
from ddlib.analysis.filters import DERIVATIVES, _odd_width
from ddlib.learning import TorqueModel
from ddlib.simulation import LOG_STEP

QUANTITIES = DERIVATIVES[:3]
"""What outputs are compared with: position, velocity, acceleration."""

LAYERS = {"hidden": "hidden_weights", "direct": "direct_weights"}
"""Attributes of `Weights` that hold filters, by the name of their layer."""


def explained(target, *by) -> float:
    """Share of the variance of a signal that others explain, linearly with a constant."""
    target = finite_array("target", target)
    signals = [finite_array("by", x) for x in by]
    if target.ndim != 1 or not signals or any(x.shape != target.shape for x in signals):
        shapes = [x.shape for x in signals]
        raise ValueError(f"by must hold signals of target's shape {target.shape}, got {shapes}")
    if target.std() == 0:
        raise ValueError("target must vary")
    return float(_explained(target[:, None], np.stack(signals, -1))[0])


def _explained(outputs, signals) -> np.ndarray:
    """The same for several outputs ``(cases, n)`` at once; ``(cases, m)`` signals."""
    outputs, signals = (x - x.mean(0) for x in (outputs, signals))
    size = signals.std(0)
    signals = signals / np.where(size > 0, size, 1)
    left = outputs - signals @ np.linalg.lstsq(signals, outputs, rcond=None)[0]
    return np.clip(1 - (left**2).sum(0) / (outputs**2).sum(0), 0, 1)


class _Responses(NamedTuple):
    """What the outputs of filters follow, along the last axis by `QUANTITIES`."""

    alone: np.ndarray  # squared correlation with each quantity
    unique: np.ndarray  # what all together explain of the output, and all but this one do not
    together: np.ndarray  # what all together explain, without the last axis

    @property
    def strongest(self) -> np.ndarray:
        """Index of the quantity with which the output correlates best, shape (...)."""
        return self.alone.argmax(-1)


def followed(f, windows, states) -> _Responses:
    """What the filters of units follow, each joint's filter by itself; leading shape (..., joint).

    `f` are weights along the windows of the joints, ``(..., joint, width)``; `windows` hold the
    positions that the network sees, ``(cases, joint, width)``, `states` the true position, velocity
    and acceleration at their centres, ``(cases, joint, 3)``.
    """
    f = finite_array("f", f)
    if f.ndim < 2:
        raise ValueError(f"f must have shape (..., joint, width), got {f.shape}")
    joints, width = f.shape[-2:]
    windows = shaped("windows", windows, f"(cases, {joints}, {width})")
    states = shaped("states", states, (len(windows), joints, 3))
    by_joint = []
    for joint in range(f.shape[-2]):
        taps = f[..., joint, :].reshape(-1, f.shape[-1])
        outputs, signals = windows[:, joint] @ taps.T, states[:, joint]
        alone = np.stack([_explained(outputs, signals[:, [k]]) for k in range(3)], -1)
        together = _explained(outputs, signals)
        others = ([1, 2], [0, 2], [0, 1])
        without = np.stack([_explained(outputs, signals[:, two]) for two in others], -1)
        by_joint.append((alone, np.clip(together[:, None] - without, 0, 1), together))
    lead = f.shape[:-2]
    return _Responses(
        *(
            np.stack([x.reshape(*lead, *x.shape[1:]) for x in joints], len(lead))
            for joints in zip(*by_joint)
        )
    )


def mean_gradient(model: TorqueModel, windows) -> np.ndarray:
    """Mean gradient of networks' torques, N m/rad, shape ``(..., output, joint, width)``."""
    like("model", model, "TorqueModel")
    weights = model.weights
    hidden, output = weights.activity(model.scaled(windows))
    hidden, output = hidden * (1 - hidden), output * (1 - output)  # slopes of the sigmoids
    through = np.einsum("...no,...nh->...oh", output, hidden) / len(windows)
    direct = output.mean(-2)[..., None, None] * weights.direct_weights
    indirect = np.einsum(
        "...oh,...hjw->...ojw", through * weights.output_weights, weights.hidden_weights
    )
    return (direct + indirect) * (model.inputs.gain[:, None] / model.outputs.gain[:, None, None])


def gains(f, step: float = LOG_STEP) -> np.ndarray:
    """Gains of filters on position, velocity and acceleration: moments of a Taylor expansion.

    For the gradient of a torque: stiffness (N m/rad), damping (N m s/rad), inertia (kg m^2).
    """
    f = _odd_width(f)
    number("step", step, 0.0, open_low=True)
    x = step * (np.arange(f.shape[-1]) - f.shape[-1] // 2)
    return np.stack([f.sum(-1), f @ x, f @ x**2 / 2], -1)
