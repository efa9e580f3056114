"""States from noisy positions: a Kalman smoother, and a zero-phase Butterworth filter."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import factorial

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.optimize import minimize_scalar
from scipy.signal import butter, savgol_filter, sosfiltfilt

from ddlib._check import filled, instance, integer, number, shaped
from ddlib.identification.averaging import (
    BY_SAMPLE,
    acting_time,
    bumps_held,
    bumps_over,
    encoder_step,
    kept_bumps,
    mean_sign,
    notes_on_slow_joints,
    reading_noise,
    where_sign_is_sure,
    with_runs,
)
from ddlib.identification.regression import FRICTION, RIGID, Equations, from_states, known_names
from ddlib.identification.whitening import independent_equations
from ddlib.logs import warn_of
from ddlib.simulation import Recording

_SMOOTHEST, _ROUGHEST = 1e-12, 1e4  # shares of process in encoder noise; rounding allows no less
_ENOUGH = 20_000  # samples of one joint from which a share is found
_COARSER = 2  # steps: noise that is larger hides an encoder's step, and decimals of a text
_ORDER = 3  # The acceleration is a random walk.


def by_butterworth(
    recording: Recording,
    cutoff: float,
    names: Sequence[str] = RIGID + FRICTION,
    order: int = 4,
    width: float | None = 0.6,
    hold: float | None = None,
    rows: Recording | None = None,
) -> Equations:
    """Equations with the states of `butterworth_states`, as is usual for robots (Gautier 1997).

    Parameters
    ----------
    recording : Recording
        Angles (rad) and torques (N m) on an even grid.
    cutoff : float
        Where the filter's gain is one half, Hz: several times the motion's own frequencies, below
        half the sampling rate.
    names : sequence of str
        Parameters, from `RIGID`, `GRAVITY`, `FRICTION` and `OFFSETS`.
    order : int
        Of the filter, which runs forwards and backwards.
    width : float or None
        Width of smooth bumps under which both sides of the equations are averaged, s, as in
        `by_modulation`: torque and motion then lose the same frequencies, which biases nothing.
        None: an equation for each sample, which gives no intervals.
    hold : float, optional
        Time for which a logged torque acts, s, from its sample on: the shorter of the log's step
        and the controller's period. Default: as the recording says; 0 if it says nothing.
    rows : Recording, optional
        Whose speeds decide at which samples Coulomb friction has a sure sign, if that is among
        `names`. Default: this one. `instrumental_variables` needs the same rows twice.

    Returns
    -------
    Equations
        Of the motion; without samples within ``1 / cutoff`` of the recording's ends.
    """
    instance("recording", recording, Recording)
    known_names(names)
    step = recording.step
    again = partial(_filtered, step=step, cutoff=cutoff, order=order)
    number("cutoff", cutoff, 0.0, 0.499 / step, open_low=True)
    margin = int(np.ceil(1 / (cutoff * step)))
    return _motion(recording, again, names, margin, rows, width, hold)


def by_kalman(
    recording: Recording,
    names: Sequence[str] = RIGID + FRICTION,
    noise: float | None = None,
    width: float | None = 0.6,
    hold: float | None = None,
    rows: Recording | None = None,
) -> Equations:
    """Equations with the states of `kalman_states`: nothing has to be tuned.

    Parameters
    ----------
    recording : Recording
        Angles (rad) and torques (N m) on an even grid.
    names : sequence of str
        Parameters, from `RIGID`, `GRAVITY`, `FRICTION` and `OFFSETS`.
    noise : float, optional
        As in `kalman_states`.
    width, hold, rows
        As in `by_butterworth`.

    Returns
    -------
    Equations
        Of the motion; without samples so near to the recording's ends that the smoother sees one
        side only.
    """
    instance("recording", recording, Recording)
    known_names(names)
    shares = _shares(recording.q, noise, recording.motion)
    again = partial(_smoothed, step=recording.step, shares=shares)
    margin = int(np.ceil(2 * max(shares) ** (-0.5 / _ORDER)))  # a joint at rest has no ends
    return _motion(recording, again, names, margin, rows, width, hold)


def butterworth_states(q, step: float, cutoff: float, order: int = 4) -> np.ndarray:
    """Position, velocity and acceleration by a zero-phase low-pass and central differences.

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
    return _later(_filtered(q, step, cutoff, order))


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
    return _later(_smoothed(q, step, _shares(q, noise, slice(None))))


def _filtered(q, step, cutoff, order) -> np.ndarray:
    """Low-passed angles and four derivatives of fourth order, (order, ..., time, joint)."""
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
    return np.stack([savgol_filter(q, 5, 4, k, step, axis=-2) for k in range(5)])


def _later(orders, late=0.0) -> np.ndarray:
    """States (..., time, joint, 3) a little later, by Taylor's polynomial, from derivatives."""
    order_count = len(orders)
    states = [
        sum(orders[k + n] * late**n / factorial(n) for n in range(order_count - k))
        for k in range(3)
    ]
    return np.stack(states, -1)


def _motion(recording, again, names, margin, rows, width, hold) -> Equations:
    """Equations of the motion, `margin` samples away from the recording's ends.

    What makes derivatives of angles is `again`.
    """
    orders = again(recording.q)
    warn_of(recording)
    acting = acting_time(recording, hold)
    steady = where_sign_is_sure(with_runs(recording if rows is None else rows), names)
    if steady.shape[-1] != recording.t.size:
        raise ValueError(f"rows must have {recording.t.size} samples, got {steady.shape[-1]}")
    (begin, end), step, motion = recording.span, recording.step, recording.motion
    inside = np.zeros(recording.t.size, bool)
    inside[max(motion.start, margin) : min(motion.stop, len(inside) - margin)] = True
    if width is None:
        _some(keep := steady & inside, margin * step)
        states = np.moveaxis(_later(orders, acting[0] + acting[1] / 2), -1, 0)
        if recording.reference.q.ndim == 2:
            states = states[..., None, :, :]
        equations = from_states(*states, with_runs(recording).tau, names)
        regressors = tuple(a[..., k, :] for a, k in zip(equations.regressor, keep))
        torques = tuple(y[..., k] for y, k in zip(equations.torque, keep))
        notes = notes_on_slow_joints(keep, names)
        return Equations(tuple(names), regressors, torques, biased=BY_SAMPLE, notes=notes)
    if end - begin < 12 * step * (1 - 1e-6):
        raise ValueError(f"recording must have 12 samples of motion, got {end - begin:g} s")
    number("width", width, 12 * step * (1 - 1e-6), (end - begin) * (1 + 1e-6))
    width = int(width / (6 * step) + 1e-6) * 6 * step
    place = recording.t - begin, width, end - begin
    bumps, bent = bumps_over(*place, (0, 2))
    later, after = bumps_held(*place, *acting), bumps_held(*place, 0.0, step)
    kept = kept_bumps(steady, bumps) & ((bumps @ ~inside) / bumps.sum(-1) < 0.02)
    _some(kept, margin * step)

    def averaged(q) -> list[np.ndarray]:
        states = _later(again(q))
        rows = from_states(*np.moveaxis(states, -1, 0), np.zeros(2), names)[1]
        means, sign = [bumps @ a for a in rows], mean_sign(states[..., 1])
        for j, mean in enumerate(means):
            if f"F_c{j + 1}" in names:
                mean[..., names.index(f"F_c{j + 1}")] = sign[..., j] @ after.T
        return means

    bent = np.moveaxis(again(np.stack([bent, bent], -1))[0], -1, 0)  # the motion is smoothed, too
    return independent_equations(
        with_runs(recording), names, averaged, steady, kept, bent, later, acting[1]
    )


def _some(keep, margin) -> None:
    if not keep.any():
        raise ValueError(
            f"recording must have motion {margin:.3g} s away from its ends, at speeds at which "
            "friction has a sure sign; got none"
        )


def _shares(q, noise, moving) -> list[float]:
    """For each joint the power of the process, in that of the encoder's noise, per sample."""
    if noise is not None:
        number("noise", noise, 0.0, open_low=True)
    if q.shape[-2] < 12:
        raise ValueError(f"q must have 12 samples or more, got {q.shape[-2]}")
    shares = []
    for j in range(q.shape[-1]):
        runs = q[..., j].reshape(-1, q.shape[-2])
        grain = encoder_step(runs) if noise is None else None
        fine = grain is not None and reading_noise(runs[..., None])[0] > _COARSER * grain
        known = noise if grain is None or fine else grain / 12**0.5
        shares.append(_likeliest(runs[:, moving], known))
    return shares


def _smoothed(q, step, shares) -> np.ndarray:
    """Smoothed angles and three derivatives, (order, ..., time, joint)."""
    by_joint = []
    for j, share in enumerate(shares):
        x = _states(q[..., j].reshape(-1, q.shape[-2]), share)[0]
        x = np.concatenate([x, np.gradient(x[..., -1:], axis=-2)], -1)
        by_joint.append((x / step ** np.arange(_ORDER + 1)).reshape(*q.shape[:-1], -1))
    return np.moveaxis(np.stack(by_joint, -2), -1, 0)


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
