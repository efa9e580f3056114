"""Instrumental variables: parameters without the bias that noise in the motion makes."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import convolve1d

from ddlib._check import instance, integer
from ddlib.identification.regression import Equations, Estimate


def instrumental_variables(
    equations: Equations, instruments: Equations, rounds: int = 4, memory: int | None = None
) -> Estimate:
    """Parameters from equations whose regressor is noisy, with a second account of the motion.

    Noise in positions becomes noise in accelerations. Least squares then finds parameters that are
    too small, however long it measures. Instruments are the same columns, built from another
    account of the same motion whose noise is independent: with ``Z`` for instruments and ``Y`` for
    the equations, ``parameters = (Z' Y)^-1 Z' torque`` (Reiersøl 1941; Young 1970; for robots
    Janot, Vandanjon & Gautier 2014). Such an account is

    - the reference, if the arm follows it well: ``replace(recording, q=recording.reference.q)``;
    - a second recording of the same motion;
    - a simulation with a first estimate of the parameters in the same control loop.

    It is *not* the same recording, filtered in another way: that has the same noise.

    Parameters
    ----------
    equations : Equations
        As for `least_squares`. Leading axes are repetitions.
    instruments : Equations
        The same names and rows; their torques are not used. With Coulomb friction among the names
        give `by_kalman` or `by_butterworth` the same ``rows=`` for both.
    rounds : int
        How often the joints' weights are settled, as in `least_squares`.
    memory : int, optional
        Number of equations over which noise is shared with its neighbours. Default: 1.5 times the
        cube root of the number of equations of a joint.

    Returns
    -------
    Estimate
        Standard errors are those of Newey & West (1987), or of White (1980) where these are larger,
        from what each equation would leave if it were not fitted (MacKinnon & White 1985):
        they allow for noise that differs in size, is shared by neighbours, and, where both joints
        have equations at the same samples, by the joints. There are no intervals from equations of
        single samples: instruments take away the bias of noise, not that of smoothing.
    """
    instance("equations", equations, Equations)
    instance("instruments", instruments, Equations)
    integer("rounds", rounds, 1)
    names, regressors, torques = equations[:3]
    others = instruments.regressor
    if tuple(instruments.names) != tuple(names):
        raise ValueError(f"instruments must have the names {names}, got {instruments.names}")
    shapes, given = [x.shape[-2] for x in regressors], [z.shape[-2] for z in others]
    if shapes != given:
        raise ValueError(f"instruments must have {shapes} equations by joint, got {given}")
    equation_count = sum(shapes)
    if equation_count <= len(names):
        raise ValueError(
            f"equations must be more than the {len(names)} parameters, got {equation_count}"
        )
    memory = round(1.5 * max(shapes) ** (1 / 3)) if memory is None else memory
    integer("memory", memory, 0, max(shapes) - 1)
    noise = [np.ones(y.shape[:-1]) for y in torques]
    smallest = 1e-12 * np.sqrt(sum(np.sum(y**2, -1) for y in torques) / equation_count) + 1e-300
    for _ in range(rounds):
        weights = [np.maximum(s, smallest)[..., None, None] ** -2 for s in noise]
        seen = sum(w * (_t(z) @ x) for w, z, x in zip(weights, others, regressors))
        size = np.linalg.norm(seen, axis=-2, keepdims=True)
        if not (size > 0).all() or np.linalg.cond(seen / size).max() > 1e10:
            raise ValueError(f"instruments must determine all of {', '.join(names)}; they do not")
        felt = sum(w * (_t(z) @ y[..., None]) for w, z, y in zip(weights, others, torques))
        inverse = np.linalg.inv(seen)
        values = (inverse @ felt)[..., 0]
        residuals = [y - (x @ values[..., None])[..., 0] for x, y in zip(regressors, torques)]
        free = max(1 - len(names) / equation_count, 1e-9)
        noise = [
            np.sqrt(np.mean(u**2, -1) / free) if u.size else s for u, s in zip(residuals, noise)
        ]
    # an equation draws the fit to itself: what it would leave without (MacKinnon & White 1985)
    drawn = [
        w[..., 0] * np.sum((x @ inverse) * z, -1) for w, x, z in zip(weights, regressors, others)
    ]
    residuals = [u / (1 - np.clip(h, 0, 0.9)) for u, h in zip(residuals, drawn)]
    scores = [w * z * u[..., None] for w, z, u in zip(weights, others, residuals)]
    scores = [sum(scores)] if len(set(shapes)) == 1 else scores
    variances = []
    for near in (np.ones(1), np.bartlett(2 * memory + 3)[1:-1]):
        spread = sum(_t(s) @ convolve1d(s, near, axis=-2, mode="constant") for s in scores)
        covariance = inverse @ spread @ _t(inverse)
        variances.append(np.diagonal(covariance, axis1=-2, axis2=-1))
    errors = np.sqrt(np.maximum(*variances))
    return Estimate(
        tuple(names), values, errors, np.stack(noise, -1), equation_count - len(names),
        unsure=np.ones(values.shape, bool) if equations.biased else None, notes=equations.notes,
    )  # fmt: skip


def _t(x) -> np.ndarray:
    return np.swapaxes(x, -1, -2)
