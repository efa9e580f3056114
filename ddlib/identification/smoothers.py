"""States from noisy positions: a Kalman smoother, and a zero-phase Butterworth filter."""

from __future__ import annotations

from math import factorial

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.optimize import minimize_scalar
from scipy.signal import butter, savgol_filter, sosfiltfilt

from ddlib._check import filled, integer, number, shaped
from ddlib.identification.averaging import encoder_step, reading_noise

_SMOOTHEST, _ROUGHEST = 1e-12, 1e4  # shares of process in encoder noise; rounding allows no less
_ENOUGH = 20_000  # samples of one joint from which a share is found
_COARSER = 2  # steps: noise that is larger hides an encoder's step, and decimals of a text
_ORDER = 3  # The acceleration is a random walk.


def butterworth_states(q, step: float, cutoff: float, order: int = 4) -> np.ndarray:
    """Position, velocity and acceleration by a zero-phase low-pass and central differences.

    As is usual for robots (Gautier 1997).

    Parameters
    ----------
    q : array_like, shape (..., time, joint)
        Angles, rad.
    step : float
        Sampling period, s.
    cutoff : float
        Where the filter's gain is one half, Hz. It runs forwards and backwards, so that nothing is
        delayed.
    order : int
        Of the Butterworth filter in each direction.

    Returns
    -------
    ndarray, shape (..., time, joint, 3)
        In rad, rad/s and rad/s^2. Differences are of fourth order.
    """
    q = shaped("q", q, "(..., time, joint)")
    filled("q", q)
    step = number("step", step, 0.0, open_low=True)
    number("cutoff", cutoff, 0.0, 0.499 / step, open_low=True)
    sections = butter(integer("order", order, 1, 12), cutoff, fs=1 / step, output="sos")
    pad, samples = int(np.ceil(3 / (cutoff * step))), q.shape[-2]
    if samples <= max(pad, 5):
        least = 3 / (step * samples)
        raise ValueError(
            f"cutoff must be above {least:.3g} Hz for {samples} samples, got {cutoff:g}"
        )
    q = sosfiltfilt(sections, q, axis=-2, padlen=pad)
    return np.stack([savgol_filter(q, 5, 4, k, step, axis=-2) for k in range(3)], -1)


def kalman_states(q, step: float, noise: float | None = None) -> np.ndarray:
    """Position, velocity and acceleration by a fixed-interval Kalman smoother.

    Each joint's acceleration is a random walk whose power maximises the likelihood of all samples.
    The smoothed states are those of Rauch, Tung & Striebel (1965) with a start of which nothing is
    known. All states are found at once, as the solution of one banded system (Bell 1994).

    Parameters
    ----------
    q : array_like, shape (..., time, joint)
        Angles, rad. Leading axes are runs of one joint's noise.
    step : float
        Sampling period, s.
    noise : float, optional
        Standard deviation of a reading, rad. Default: an encoder's step divided by the root of 12
        if all readings are multiples of a step, otherwise by the likelihood, too.

    Returns
    -------
    ndarray, shape (..., time, joint, 3)
        In rad, rad/s and rad/s^2.
    """
    q = shaped("q", q, "(..., time, joint)")
    filled("q", q)
    step = number("step", step, 0.0, open_low=True)
    if noise is not None:
        number("noise", noise, 0.0, open_low=True)
    if q.shape[-2] < 12:
        raise ValueError(f"q must have 12 samples or more, got {q.shape[-2]}")
    by_joint = []
    for j in range(q.shape[-1]):
        runs = q[..., j].reshape(-1, q.shape[-2])
        smoothed = _states(runs, _likeliest(runs, _noise(runs) if noise is None else noise))[0]
        by_joint.append((smoothed / step ** np.arange(_ORDER)).reshape(*q.shape[:-1], _ORDER))
    return np.stack(by_joint, -2)


def _noise(runs) -> float | None:
    """What an encoder's step makes of one joint's readings, rad; None if they show no step."""
    step = encoder_step(runs)
    if step is None or reading_noise(runs[..., None])[0] > _COARSER * step:
        return None
    return step / 12**0.5


def _likeliest(runs, noise) -> float:
    """The share of process noise that makes the readings likeliest; white `noise` if known."""
    runs = runs[: max(1, _ENOUGH // runs.shape[1]), :_ENOUGH]
    samples = runs.shape[1]

    def unlikely(exponent) -> float:
        _, halves, misfit = _states(runs, 10.0**exponent)
        free = samples - _ORDER
        variance = np.mean(misfit) / free + 1e-300 if noise is None else noise**2
        return free * np.log(variance) + halves + np.mean(misfit) / variance

    ends = np.log10([_SMOOTHEST, _ROUGHEST])
    return 10.0 ** minimize_scalar(unlikely, bounds=ends, options={"xatol": 0.03}).x


def _states(runs, share) -> tuple[np.ndarray, float, np.ndarray]:
    """Smoothed derivatives per sample ``(runs, time, order)``; terms of minus twice the likelihood:
    what does not depend on the readings, and each run's sum of squares in units of their noise."""
    samples, order = runs.shape[1], _ORDER
    k = np.arange(order)
    facts = np.array([factorial(n) for n in range(order)], float)
    ahead = np.where(k >= k[:, None], 1 / facts[np.maximum(k - k[:, None], 0)], 0.0)
    back = order - 1 - k
    process = 1 / np.outer(facts[back], facts[back]) / (back + back[:, None] + 1)
    weight = np.linalg.inv(process) / share
    middle = np.zeros((samples, order, order))
    middle[:, 0, 0] = 1.0
    middle[:-1] += ahead.T @ weight @ ahead
    middle[1:] += weight
    below = -weight @ ahead
    bands = np.zeros((2 * order, samples, order))
    for row, column in np.ndindex(order, order):
        if row >= column:
            bands[row - column, :, column] = middle[:, row, column]
        bands[order + row - column, :-1, column] = below[row, column]
    triangle = cholesky_banded(bands.reshape(2 * order, -1), lower=True)
    centre = runs.mean(1, keepdims=True)
    right = np.zeros((samples, order, len(runs)))
    right[:, 0] = (runs - centre).T
    x = cho_solve_banded((triangle, True), right.reshape(-1, len(runs)))
    x = np.moveaxis(x.reshape(right.shape), -1, 0)
    jump = x[:, 1:] - x[:, :-1] @ ahead.T
    misfit = ((runs - centre - x[..., 0]) ** 2).sum(1) + ((jump @ weight) * jump).sum((1, 2))
    x[..., 0] += centre
    log_process = order * np.log(share) + np.linalg.slogdet(process)[1]
    return x, float(2 * np.log(triangle[0]).sum() + (samples - 1) * log_process), misfit
