"""The torque is linear in base parameters and friction: its terms, and what can be adapted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddlib._check import finite_array, non_negative, one_of, shaped

PARAMETERS = ("a", "b", "d", "g1", "g2", "F_v1", "F_v2", "F_c1", "F_c2")
"""What can be adapted: base parameters (kg m^2), gravity moments (N m), viscous (N m s/rad) and
Coulomb (N m) friction of both joints."""

SIGN_SPEED = 0.02
"""Coulomb friction is taken for linear in the velocity below this speed, rad/s."""


def mixed_regressor(q, qd, v, a, names: Sequence[str] = PARAMETERS[:3]) -> np.ndarray:
    """Matrix Y with ``Y @ parameters = M(q) a + C(q, qd) v + g(q) + friction(v)``.

    With ``v = qd`` and ``a = qdd`` it is `ddlib.dynamics.Arm.regressor` and friction. C is the
    matrix that makes ``dM/dt - 2 C`` skew-symmetric (`ddlib.dynamics.Arm.coriolis_matrix`).

    Parameters
    ----------
    q, qd : array_like, shape (..., 2)
        Angles (rad) and velocities (rad/s).
    v, a : array_like, shape (..., 2)
        Another velocity (rad/s) and another acceleration (rad/s^2).
    names : sequence of str
        Parameters, from `PARAMETERS`.

    Returns
    -------
    ndarray, shape (..., 2, parameters)

    Source: Slotine & Li 1987, for two links.
    """
    pairs = zip(("q", "qd", "v", "a"), (q, qd, v, a))
    q, qd, v, a = np.broadcast_arrays(*(finite_array(n, x, 2) for n, x in pairs))
    for name in names:
        one_of("names", name, PARAMETERS)
    c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
    (w1, w2), (v1, v2), (a1, a2) = (np.moveaxis(x, -1, 0) for x in (qd, v, a))
    s1, s12, zero = np.sin(q[..., 0]), np.sin(q[..., 0] + q[..., 1]), np.zeros_like(c2)
    sign = np.clip(v / SIGN_SPEED, -1.0, 1.0)
    columns = {
        "a": (a1, zero),
        "b": (c2 * (2 * a1 + a2) - s2 * (w2 * v1 + (w1 + w2) * v2), c2 * a1 + s2 * w1 * v1),
        "d": (a2, a1 + a2),
        "g1": (s1, zero),
        "g2": (s12, s12),
        "F_v1": (v1, zero),
        "F_v2": (zero, v2),
        "F_c1": (sign[..., 0], zero),
        "F_c2": (zero, sign[..., 1]),
    }
    return np.stack([np.stack(columns[name], -1) for name in names], -1)


def check_parameters(controller) -> None:
    """Refuse names, rates and estimates of a controller that do not fit together."""
    for name in controller.names:
        one_of("names", name, PARAMETERS)
    count = f"(..., {len(controller.names)})"
    non_negative("rate", shaped("rate", controller.rate, count))
    shaped("estimate", controller.estimate, count)
