"""What whole units and networks respond to along a motion, in signals and in physical units.

(`ddlib.analysis.following` looks at each joint's filter by itself.)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import orth

from ddlib._check import finite_array, instance
from ddlib.analysis.following import Responses, gains, mean_gradient
from ddlib.analysis.hidden_units import net_inputs
from ddlib.learning import TorqueModel


def unit_responses(outputs, states) -> Responses:
    """R² of quantities ``(cases, joint, quantities)`` for signals ``(..., cases, units)``.

    Alone is of both joints; unique: by how much R² on all falls without it (semi-partial).
    """
    outputs, states = finite_array("outputs", outputs), finite_array("states", states)
    if states.ndim != 3 or outputs.ndim < 2 or outputs.shape[-2] != len(states):
        raise ValueError(
            "outputs and states must have shapes (..., cases, units) and (cases, joint, "
            f"quantities), got {outputs.shape} and {states.shape}"
        )
    y = np.moveaxis(outputs, -2, 0)
    y = (y - y.mean(0)).reshape(len(states), -1)
    power = (y**2).sum(0)
    if (power < 1e-20 * len(y)).any():
        raise ValueError("outputs must vary over the cases")

    def share(quantities):
        x = states[:, :, quantities].reshape(len(states), -1)
        axes = orth((x - x.mean(0)) / x.std(0), rcond=1e-9)
        return ((axes.T @ y) ** 2).sum(0) / power

    quantity_count = states.shape[-1]
    alone = np.stack([share([k]) for k in range(quantity_count)], -1)
    together = share(list(range(quantity_count)))
    without = np.stack(
        [share([i for i in range(quantity_count) if i != k]) for k in range(quantity_count)], -1
    )
    unique = np.clip(together[:, None] - without, 0, 1)
    shape = np.moveaxis(outputs, -2, 0).shape[1:]
    return Responses(
        alone.reshape(*shape, quantity_count),
        unique.reshape(*shape, quantity_count),
        together.reshape(shape),
    )


def unit_inputs(model: TorqueModel, windows) -> dict[str, np.ndarray]:
    """Net inputs of the "hidden" units, and what the "direct" weights give to the outputs."""
    instance("model", model, TorqueModel)
    x = model.scaled(windows)
    direct = np.einsum("...ojw,njw->...no", model.weights.direct_weights, x)
    return {"hidden": net_inputs(model, windows), "direct": direct}


class PhysicalGains(NamedTuple):
    """Stiffness (N m/rad), damping (N m s/rad), inertia (kg m^2), ``(..., output, joint, 3)``."""

    direct: np.ndarray  # through the direct weights alone
    whole: np.ndarray  # through all of the network, averaged over cases


def calibrated(model: TorqueModel, windows, step: float) -> PhysicalGains:
    """Gains of networks in physical units, from their torques' gradient averaged over windows.

    `step` is the sampling period of the windows, s.
    """
    instance("model", model, TorqueModel)
    weights = model.weights
    output = weights.activity(model.scaled(windows))[1]
    slope = (output * (1 - output)).mean(-2)  # of the whole network's outputs
    scale = model.inputs.gain[:, None] / model.outputs.gain[:, None, None]
    direct = slope[..., None, None] * weights.direct_weights * scale
    return PhysicalGains(gains(direct, step), gains(mean_gradient(model, windows), step))
