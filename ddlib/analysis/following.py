"""What the outputs of filters follow along a recording, which depends on the motion, too."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array, number, shaped, told
from ddlib.analysis.filters import DERIVATIVES, with_centre
from ddlib.learning import TorqueModel

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
    residual = outputs - signals @ np.linalg.lstsq(signals, outputs, rcond=None)[0]
    return np.clip(1 - (residual**2).sum(0) / (outputs**2).sum(0), 0, 1)


class Responses(NamedTuple):
    """What the outputs of filters follow, along the last axis by `QUANTITIES`."""

    alone: np.ndarray  # squared correlation with each quantity
    unique: np.ndarray  # what all together explain of the output, and all but this one do not
    together: np.ndarray  # what all together explain, without the last axis

    @property
    def strongest(self) -> np.ndarray:
        """Index of the quantity with which the output correlates best, shape (...)."""
        return self.alone.argmax(-1)


def filter_responses(f, windows, states) -> Responses:
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
    return Responses(
        *(
            np.stack([x.reshape(*lead, *x.shape[1:]) for x in joints], len(lead))
            for joints in zip(*by_joint)
        )
    )


def mean_gradient(model: TorqueModel | Callable, windows) -> np.ndarray:
    """Mean gradient of networks' torques, N m/rad, shape ``(..., output, joint, width)``.

    Parameters
    ----------
    model : TorqueModel, torch.nn.Module or callable
        A module takes a tensor ``(cases, joint, width)`` in rad and returns torques ``(...,
        cases, output)`` in N m, each case by itself; its gradient comes from autograd. Any other
        callable does the same with arrays; its gradient comes from central differences, so it must
        be smooth (no trees), and it is called twice for each sample of a window.
    windows : array_like, shape (cases, joint, width)
        Positions, rad, over which the mean is taken.
    """
    if not isinstance(model, TorqueModel):
        return _of_any(model, windows)
    weights = model.weights
    hidden, output = weights.activity(model.scaled(windows))
    hidden, output = hidden * (1 - hidden), output * (1 - output)  # slopes of the sigmoids
    through = np.einsum("...no,...nh->...oh", output, hidden) / len(windows)
    direct = output.mean(-2)[..., None, None] * weights.direct_weights
    indirect = np.einsum(
        "...oh,...hjw->...ojw", through * weights.output_weights, weights.hidden_weights
    )
    return (direct + indirect) * (model.inputs.gain[:, None] / model.outputs.gain[:, None, None])


def _of_any(model: Callable, windows) -> np.ndarray:
    """`mean_gradient` of a PyTorch module or another callable."""
    if not callable(model):
        raise TypeError(f"model must be a TorqueModel, a module or callable, got {told(model)}")
    if any(kind.__module__.startswith("torch.nn.") for kind in type(model).__mro__):
        from ddlib.learning import module_gradient

        return module_gradient(model, windows)
    windows = np.array(shaped("windows", windows, "(cases, joint, width)"))

    def torque() -> np.ndarray:
        torques = np.asarray(model(windows.copy()))
        if torques.ndim < 2 or torques.shape[-2] != len(windows):
            shape = f"(..., {len(windows)}, output)"
            raise ValueError(f"model must return torques of shape {shape}, got {torques.shape}")
        return torques

    torques = torque()
    rounding = np.finfo(torques.dtype if torques.dtype.kind == "f" else float).eps
    reach = np.cbrt(rounding) * np.maximum(
        np.abs(windows - windows.mean((0, 2))[:, None]).max((0, 2)), 1e-3
    )
    gradient = np.empty((*windows.shape[1:], *torques.shape[:-2], torques.shape[-1]))
    for joint, sample in np.ndindex(windows.shape[1:]):
        before, ends = windows[:, joint, sample].copy(), []
        for sign in (1, -1):
            windows[:, joint, sample] = before + sign * reach[joint]
            ends.append(torque().astype(float).mean(-2))
        windows[:, joint, sample] = before
        gradient[joint, sample] = (ends[0] - ends[1]) / (2 * reach[joint])
    return finite_array("gradient of model", np.moveaxis(gradient, (0, 1), (-2, -1)))


def gains(f, step: float) -> np.ndarray:
    """Gains of filters on position, velocity and acceleration: moments of a Taylor expansion.

    For the gradient of a torque: stiffness (N m/rad), damping (N m s/rad), inertia (kg m^2).

    Parameters
    ----------
    f : array_like, shape (..., width)
        Filters of odd width, oldest sample first.
    step : float
        Sampling period of their windows, s: 0.010 (`ddlib.simulation.LOG_STEP`) of the book's
        recordings, else that of your log. An inertia goes with its square.

    Returns
    -------
    ndarray, shape (..., 3)
    """
    f = with_centre(f)
    number("step", step, 0.0, open_low=True)
    x = step * (np.arange(f.shape[-1]) - f.shape[-1] // 2)
    return np.stack([f.sum(-1), f @ x, f @ x**2 / 2], -1)
