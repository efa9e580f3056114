"""How much of an arm's inertia regression on windows finds, and what regularisation leaves of it.

A window shows an acceleration only as far as positions do not explain it: along one sine both are
the same signal.
"""

from __future__ import annotations

import numpy as np

from ddlib._check import filled, finite_array, instance, integer, non_negative, shaped
from ddlib.learning import TrainingSet


def ridge_filters(data: TrainingSet, penalties) -> np.ndarray:
    """Linear filters of windows by ridge regression (Hoerl & Kennard 1970), for several penalties.

    They minimise the mean square error of the scaled torques plus the penalty times the sum of the
    squared weights of the scaled windows; a bias is free.

    Parameters
    ----------
    data : TrainingSet
        Scaled windows and torques.
    penalties : array_like, shape (penalties,)
        0 or more. With 0 the windows' directions must all vary.

    Returns
    -------
    ndarray, shape (penalties, output, joint, width)
        Torque by position, N m/rad.
    """
    instance("data", data, TrainingSet)
    filled("penalties", penalties)
    penalties = shaped("penalties", non_negative("penalties", penalties), "(penalties,)")
    x, y = (a.reshape(len(a), -1) for a in (data.x, data.y))
    x, y = x - x.mean(0), y - y.mean(0)
    variance, axes = np.linalg.eigh(x.T @ x / len(x))
    if (penalties == 0).any() and variance[0] <= 1e-14 * variance[-1]:
        raise ValueError(
            "penalties must be above 0 for these windows, which vary in "
            f"{int((variance > 1e-14 * variance[-1]).sum())} of {len(variance)} directions, got 0"
        )
    slopes = axes.T @ (x.T @ y) / len(x)
    f = axes @ (slopes / (variance[:, None] + penalties[:, None, None]))
    f = np.moveaxis(f, -1, 1).reshape(len(penalties), y.shape[1], *data.x.shape[1:])
    return f * data.inputs.gain[:, None] / data.outputs.gain[:, None, None]


def half_penalty(data: TrainingSet, states, joint: int = 0) -> float:
    """Penalty of `ridge_filters` at which half of a joint's inertia is left, by a short theory.

    Position is the steepest direction of the windows by far. Let r be what is left of the joint's
    acceleration when the positions of all joints are regressed out. It moves a window along the
    parabola ``x^2 / 2`` less its mean, of length l, and ridge leaves ``v / (v + penalty)`` of what
    lies along a direction of variance v: here ``l^2 var(r)``, in units of the scaled windows.
    Friction, rounding and the other joints are left out, and so is a swing that is fast for the
    window: where they outweigh r, the mass goes at a far smaller penalty.

    Parameters
    ----------
    data : TrainingSet
        Scaled windows, with their sampling period (`step` of `TrainingSet.from_arrays`).
    states : array_like, shape (cases, joint, 3)
        Position, velocity and acceleration at their centres, as of `ddlib.setups.true_states`.
    joint : int
        Whose inertia.

    Raises
    ------
    ValueError
        If the windows' sampling period is not known.
    """
    instance("data", data, TrainingSet)
    if data.step is None:
        raise ValueError("data must know its step: give TrainingSet.from_arrays a step, in s")
    states = shaped("states", finite_array("states", states), f"({len(data.x)}, joint, 3)")
    integer("joint", joint, 0, states.shape[1] - 1)
    width = data.x.shape[-1]
    x = data.step * (np.arange(width) - width // 2)
    length = data.inputs.gain[joint] * np.linalg.norm(x**2 / 2 - (x**2 / 2).mean())
    q, qdd = states[..., 0], states[:, joint, 2]
    known = np.column_stack([q, np.ones(len(q))])
    residual = qdd - known @ np.linalg.lstsq(known, qdd, rcond=None)[0]
    return float(length**2 * residual.var())
