"""States from noisy positions: a Kalman smoother, and a zero-phase Butterworth filter."""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.optimize import minimize_scalar
from scipy.signal import butter, savgol_filter, sosfiltfilt

from ddlib._check import integer, number, shaped
from ddlib.identification.equations import _in_runs, _lateness, _steady
from ddlib.identification.regression import FRICTION, RIGID, Equations, from_states
from ddlib.simulation import Recording

_SMOOTHEST, _ROUGHEST = 1e-12, 1e4  # shares of process in encoder noise; rounding allows no less
_ENOUGH = 20_000  # samples of one joint from which a share is found
_UNHARMED = 0.4  # of a smoother's corner frequency: below, its gain is 1 within half a percent
_ORDER = 3  # The acceleration is a random walk.


def by_butterworth(
    recording: Recording,
    cutoff: float,
    names: Sequence[str] = RIGID + FRICTION,
    order: int = 4,
    both_sides: float | None = None,
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
        Parameters, from `RIGID`, `GRAVITY` and `FRICTION`.
    order : int
        Of the filter, which runs forwards and backwards.
    both_sides : float, optional
        Cutoff, Hz, of a second low-pass for both sides of the equations, of which so many are kept
        that their noise is independent ("parallel filtering and decimation" in Gautier 1997). It
        takes away torque at frequencies that the states have lost, and does not bias anything.
        Default: .4 of `cutoff`; infinite: no such filter.
    hold : float, optional
        Time for which the controller holds a torque, s: a sample stands for the torque half of it
        later. Default: as the recording says; 0 if it says nothing.
    rows : Recording, optional
        Whose speeds decide at which samples Coulomb friction has a sure sign, if that is among
        `names`. Default: this one. `instrumental_variables` needs the same rows twice.

    Returns
    -------
    Equations
        Without samples within ``1 / cutoff`` of the recording's ends.
    """
    late = _late(recording, hold)
    states = butterworth_states(recording.q, recording.step, cutoff, order, late)
    margin = int(np.ceil(1 / (cutoff * recording.step)))
    both_sides = _UNHARMED * cutoff if both_sides is None else both_sides
    return _inside(recording, states, names, margin, rows, both_sides)


def by_kalman(
    recording: Recording,
    names: Sequence[str] = RIGID + FRICTION,
    noise: float | None = None,
    both_sides: float | None = None,
    hold: float | None = None,
    rows: Recording | None = None,
) -> Equations:
    """Equations with the states of `kalman_states`: nothing has to be tuned.

    Parameters
    ----------
    recording : Recording
        Angles (rad) and torques (N m) on an even grid.
    names : sequence of str
        Parameters, from `RIGID`, `GRAVITY` and `FRICTION`.
    noise : float, optional
        As in `kalman_states`.
    both_sides : float, optional
        As in `by_butterworth`; default: .4 of the frequency at which the smoother's gain is one
        half, of the joint that is smoothed most.
    hold, rows
        As in `by_butterworth`.

    Returns
    -------
    Equations
        Without samples so near to the recording's ends that the smoother sees one side only.
    """
    late, step = _late(recording, hold), recording.step
    q, motion = recording.q, recording.motion
    states, share = _smoothed(q, step, noise, late, motion)
    corner = share.min() ** (0.5 / _ORDER)  # in 1 / samples
    margin = int(np.ceil(2 / corner))
    if both_sides is None:
        both_sides = min(_UNHARMED * corner / (2 * np.pi), 0.25) / step
    return _inside(recording, states, names, margin, rows, both_sides)


def butterworth_states(
    q, step: float, cutoff: float, order: int = 4, later: float = 0.0
) -> np.ndarray:
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
    later : float
        How much later than its sample a state is wanted, s; less than two periods.

    Returns
    -------
    ndarray, shape (..., time, joint, 3)
        In rad, rad/s and rad/s^2. Differences are of fourth order.
    """
    q = _low_passed("cutoff", shaped("q", q, "(..., time, joint)"), step, cutoff, order)
    later = number("later", later, 0.0, 2 * step)
    orders = [savgol_filter(q, 5, 4, k, step, axis=-2) for k in range(5)]
    return _later(orders, later)


def kalman_states(q, step: float, noise: float | None = None, later: float = 0.0) -> np.ndarray:
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
    later : float
        How much later than its sample a state is wanted, s; less than two periods.

    Returns
    -------
    ndarray, shape (..., time, joint, 3)
        In rad, rad/s and rad/s^2.
    """
    q = shaped("q", q, "(..., time, joint)")
    step = number("step", step, 0.0, open_low=True)
    later = number("later", later, 0.0, 2 * step)
    return _smoothed(q, step, noise, later, slice(None))[0]


def encoder_step(q) -> float | None:
    """The step of which all differences of readings ``(..., time)`` are multiples; or None."""
    gaps = np.abs(np.diff(q, axis=-1)).ravel()
    size = np.abs(q).max(initial=0.0)
    gaps = gaps[gaps > 1e-9 * size + 1e-15]
    if gaps.size < 10:
        return None
    step = gaps.min()
    counts = np.round(gaps / step)
    step = float((gaps * counts).sum() / (counts**2).sum())
    rough = np.abs(gaps / step - np.round(gaps / step)).max() > 0.1
    return None if rough or counts.max() > 1e6 else step


def _low_passed(name, x, step, cutoff, order) -> np.ndarray:
    step = number("step", step, 0.0, open_low=True)
    number(name, cutoff, 0.0, 0.499 / step, open_low=True)
    sections = butter(integer("order", order, 1, 12), cutoff, fs=1 / step, output="sos")
    pad = int(np.ceil(3 / (cutoff * step)))
    if x.shape[-2] <= max(pad, 5):
        raise ValueError(
            f"{name} must be above {3 / (step * x.shape[-2]):.3g} Hz for {x.shape[-2]} samples, "
            f"got {cutoff:g}"
        )
    return sosfiltfilt(sections, x, axis=-2, padlen=pad)


def _later(orders, later) -> np.ndarray:
    """The first three of some derivatives, a little later, by Taylor's polynomial."""
    count = len(orders)
    return np.stack(
        [sum(orders[k + n] * later**n / factorial(n) for n in range(count - k)) for k in range(3)],
        -1,
    )


def _late(recording, hold) -> float:
    if hold is not None:
        return number("hold", hold, 0.0) / 2
    return 0.0 if recording.control_step is None else _lateness(recording)


def _inside(recording, states, names, margin, rows, cutoff) -> Equations:
    """Equations at the samples of the motion that are `margin` away from the recording's ends."""
    steady = _steady(_in_runs(recording if rows is None else rows), names)
    states = states[..., None, :, :, :] if recording.reference.q.ndim == 2 else states
    recording, count, step = _in_runs(recording), recording.t.size, recording.step
    if steady.shape[-1] != count:
        raise ValueError(f"rows must have {count} samples, got {steady.shape[-1]}")
    equations = from_states(*np.moveaxis(states, -1, 0), recording.tau, names)
    regressors, torques, every = equations.regressor, equations.torque, 1
    if cutoff != np.inf:
        regressors, torques = (
            [_low_passed("both_sides", x, step, cutoff, 4) for x in parts]
            for parts in (regressors, [y[..., None] for y in torques])
        )
        torques = [y[..., 0] for y in torques]
        margin += int(np.ceil(1 / (cutoff * step)))
        every = max(1, round(0.5 / (cutoff * step)))
    inside, motion = np.zeros(count, bool), recording.motion
    inside[max(motion.start, margin) : min(motion.stop, count - margin) : every] = True
    keep = steady & inside
    if not keep.any():
        raise ValueError(
            f"recording must have samples of motion {margin * step:.3g} s away from its ends, "
            "got none"
        )
    regressors = tuple(a[..., k, :] for a, k in zip(regressors, keep))
    return Equations(tuple(names), regressors, tuple(y[..., k] for y, k in zip(torques, keep)))


def _smoothed(q, step, noise, later, moving) -> tuple[np.ndarray, np.ndarray]:
    """States, and for each joint the share of process noise per sample in encoder noise."""
    if noise is not None:
        number("noise", noise, 0.0, open_low=True)
    if q.shape[-2] < 12:
        raise ValueError(f"q must have 12 samples or more, got {q.shape[-2]}")
    found, shares = [], []
    for j in range(q.shape[-1]):
        runs = q[..., j].reshape(-1, q.shape[-2])
        grain = encoder_step(runs) if noise is None else None
        known = noise if grain is None else grain / np.sqrt(12)
        share = _likeliest(runs[:, moving], known)
        x = _states(runs, share)[0].reshape(*q.shape[:-1], _ORDER)
        x = np.concatenate([x, np.gradient(x[..., -1:], axis=-2)], -1)
        found.append(_later([x[..., k] / step**k for k in range(_ORDER + 1)], later))
        shares.append(share)
    return np.stack(found, -2), np.array(shares)


def _likeliest(runs, noise) -> float:
    """The share of process noise that makes the readings likeliest; white `noise` if known."""
    runs = runs[: max(1, _ENOUGH // runs.shape[1]), :_ENOUGH]
    count = runs.shape[1]

    def unlikely(exponent) -> float:
        _, halves, left = _states(runs, 10.0**exponent)
        free = count - _ORDER
        variance = np.mean(left) / free + 1e-300 if noise is None else noise**2
        return free * np.log(variance) + halves + np.mean(left) / variance

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
    left = ((runs - centre) * (runs - centre - x[..., 0])).sum(1)
    x[..., 0] += centre
    log_process = order * np.log(share) + np.linalg.slogdet(process)[1]
    return x, float(2 * np.log(triangle[0]).sum() + (samples - 1) * log_process), left
