"""The torque is linear in base parameters and friction: its terms, and what can be adapted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ddlib._check import finite_array, non_negative, one_of, shaped

PARAMETERS = ("a", "b", "d", "g1", "g2", "F_v1", "F_v2", "F_c1", "F_c2")
"""What can be adapted: base parameters (kg m^2), gravity moments (N m), viscous (N m s/rad) and
Coulomb (N m) friction of both joints."""

_SIGN_SPEED = 0.02  # rad/s: below it Coulomb friction is taken for linear in the velocity


def mixed_regressor(q, qd, v, a, names: Sequence[str] = PARAMETERS[:3]) -> np.ndarray:
    """Matrix Y with ``Y @ parameters = M(q) a + C(q, qd) v + g(q) + friction(v)``.

    With ``v = qd`` and ``a = qdd`` it is `ddlib.dynamics.Arm.regressor` and friction. C is the
    matrix that makes ``dM/dt - 2 C`` skew-symmetric (`ddlib.dynamics.Arm.coriolis_matrix`).
    The form is that of Slotine & Li 1987, for two links; its shape is (..., 2, parameters), and
    `names` are some of `PARAMETERS`.
    """
    pairs = zip(("q", "qd", "v", "a"), (q, qd, v, a))
    for name in names:
        one_of("names", name, PARAMETERS)
    return _unchecked_regressor(*(finite_array(n, x, 2) for n, x in pairs), names)


def _unchecked_regressor(q, qd, v, a, names: Sequence[str]) -> np.ndarray:
    """`mixed_regressor` without checks, for the inner loop of a simulation."""
    q, qd, v, a = np.broadcast_arrays(q, qd, v, a)
    c2, s2 = np.cos(q[..., 1]), np.sin(q[..., 1])
    (w1, w2), (v1, v2), (a1, a2) = ((x[..., 0], x[..., 1]) for x in (qd, v, a))
    Y = np.zeros((*q.shape, len(names)))
    for k, name in enumerate(names):
        shoulder, elbow = Y[..., 0, k], Y[..., 1, k]
        if name == "a":
            shoulder[...] = a1
        elif name == "b":
            shoulder[...] = c2 * (2 * a1 + a2) - s2 * (w2 * v1 + (w1 + w2) * v2)
            elbow[...] = c2 * a1 + s2 * w1 * v1
        elif name == "d":
            shoulder[...], elbow[...] = a2, a1 + a2
        elif name == "g1":
            shoulder[...] = np.sin(q[..., 0])
        elif name == "g2":
            shoulder[...] = elbow[...] = np.sin(q[..., 0] + q[..., 1])
        else:
            joint = int(name[-1]) - 1
            rate = v[..., joint]
            own = rate if name.startswith("F_v") else np.clip(rate / _SIGN_SPEED, -1.0, 1.0)
            Y[..., joint, k] = own
    return Y


def _check_parameters(controller) -> None:
    """Refuse names, rates and estimates of a controller that do not fit together."""
    for name in controller.names:
        one_of("names", name, PARAMETERS)
    count = f"(..., {len(controller.names)})"
    non_negative("rate", shaped("rate", controller.rate, count))
    shaped("estimate", controller.estimate, count)
