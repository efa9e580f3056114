"""Averaged equations made independent of each other, as least squares and its intervals want them.

Three kinds of noise reach an equation that is averaged under a bump.

- The torque's is new in each sample, and bumps that overlap share it.
- A wrong reading looks like the torque of the motion that it feigns: inertia times its second
  derivative. Integration by parts moves the derivatives to the bump, so that bumps share this noise
  in another way. With a coarse encoder it is the larger one; an interval that counts only the
  torque's is then too narrow for inertias and too wide for friction.
- Where a joint turns back it may stick, and its friction has any value between the two levels.
"""

from __future__ import annotations

import numpy as np

from ddlib.identification.averaging import notes_on_slow_joints, reading_noise, regressor_blur
from ddlib.identification.regression import Equations
from ddlib.simulation import Recording

_ROUNDS = 12  # after them the noise of the torque has settled
_LEAST = 1e-24  # of the torque's mean square: what is smaller is rounding


def independent_equations(
    recording: Recording, names, averaged, sure, kept, bent, later, hold
) -> Equations:
    """Equations that are averaged under bumps, independent of each other.

    Parameters
    ----------
    recording : Recording
        Arrays (..., run, time, joint).
    names : sequence of str
        The parameters.
    averaged : callable
        Of angles (..., run, time, joint), for each joint the averaged regressor
        (..., run, bump, parameter).
    sure, kept : ndarray of bool, shape (joint, run, time) and (joint, run, bump)
        Where the sign of friction is sure; which bumps count.
    bent : sequence of ndarray
        For readings of each joint the bumps' second derivatives (bump, time).
    later : ndarray, shape (bump, time)
        Means of the bumps while a sample's torque acts.
    hold : float
        For how long that is, s.
    """
    rows, torques = averaged(recording.q), np.moveaxis(recording.tau, -1, 0) @ later.T
    matrices = _whitening(recording, names, rows, torques, sure, kept, bent, later, hold)
    first = matrices.reshape(2, -1, *matrices.shape[-3:])[:, 0]  # of the repetitions
    blur = regressor_blur(recording, lambda q: _independent(averaged(q), first, kept))
    white = tuple(y[..., 0] for y in _independent(torques[..., None], matrices, kept))
    notes = notes_on_slow_joints(kept, names)
    return Equations(tuple(names), _independent(rows, matrices, kept), white, blur, notes=notes)


def _independent(series, matrices, kept) -> tuple[np.ndarray, ...]:
    """For each joint the kept equations (..., equation, column), independent of each other."""
    return tuple(
        np.concatenate([x[..., k, keep, :] for k, keep in enumerate(runs)], -2)
        for x, runs in zip((matrix @ x for matrix, x in zip(matrices, series)), kept)
    )


def _whitening(recording, names, rows, torques, sure, kept, bent, later, hold) -> np.ndarray:
    """Matrices that make averaged equations independent, (joint, ..., run, bump, bump).

    Noise of the readings is that of `reading_noise`. The other two kinds and the inertias follow
    from the equations themselves, in rounds: a weighted least-squares fit, then a step of each
    variance towards its restricted maximum likelihood (the MM algorithm of Zhou et al. 2019). It
    is exact for noise; the sudden errors of friction are less, and their variance begins large.

    A matrix is scaled so that a joint's noise remains as large as that of a torque's sample.
    """
    kept = kept.reshape(2, *[1] * (recording.q.ndim - 3), *kept.shape[1:])
    both, identity = kept[..., None] & kept[..., None, :], np.eye(len(later))
    a, y = np.stack(rows) * kept[..., None], torques[..., None] * kept[..., None]
    slow = (later * ~sure[..., None, :]) @ later.T
    kinds = later @ later.T * both, slow.reshape(*both.shape[:-2], *slow.shape[-2:]) * both
    of_readings = _readings(recording, bent, later, hold)
    power = np.mean(torques**2, (-2, -1))
    power = power + 1e-3 * power.mean(0) + 1e-300  # also of a joint without torque
    variances = [power, power]
    parameters = np.zeros((*power.shape[1:], len(names)))
    for _ in range(_ROUNDS):
        covariance = of_readings(dict(zip(names, np.moveaxis(parameters, -1, 0)))) * both
        for variance, kind in zip(variances, kinds):
            covariance = covariance + variance[..., None, None, None] * kind
        matrices = np.linalg.inv(np.linalg.cholesky(np.where(both, covariance, identity)))
        white_a, white_y = matrices @ a, matrices @ y
        parameters, inverse = _fitted(white_a, white_y)
        left = white_y - white_a @ parameters[..., None, :, None]
        a_back, left_back = (np.swapaxes(matrices, -1, -2) @ x for x in (white_a, left))
        for k, kind in enumerate(kinds):
            found = np.sum(left_back * (kind @ left_back), (-3, -2, -1))
            spent = np.sum(np.swapaxes(a_back, -1, -2) @ kind @ a_back, -3)
            expected = np.sum(matrices @ kind * matrices, (-3, -2, -1))
            expected = expected - np.sum(inverse * spent, (-2, -1))
            ratio = found / np.maximum(expected, 1e-3 * found + 1e-300)
            variances[k] = np.maximum(variances[k] * np.sqrt(ratio), _LEAST * power)
    return np.sqrt(variances[0])[..., None, None, None] * matrices


def _readings(recording, bent, later, hold):
    """Covariance of averaged equations from noise of the readings, (joint, ..., run, bump, bump).

    What is returned is a function of the parameters' values by name. A reading of one joint that is
    wrong by 1 rad looks to a joint like the second derivative of its motion times an inertia, whose
    parts are a constant and the elbow's cosine. To its own joint it looks also like the torque by
    which the controller answers it, as far as the log does not see that act.
    """
    noise = reading_noise(recording.q.reshape(-1, *recording.q.shape[-3:])[0][:, recording.motion])
    unseen = _answers(recording) * (1 - min(hold / recording.step, 1.0))
    elbow = np.cos(recording.q[..., None, :, 1])
    products = [
        [[x @ np.swapaxes(y, -1, -2) for y in waves] for x in waves]
        for waves in ((x, elbow * x, later) for x in bent)
    ]

    def of_readings(value: dict) -> np.ndarray:
        none = np.zeros(unseen.shape[:-1])
        a, b, d = (value.get(name, none) for name in ("a", "b", "d"))
        shoulder = (a, 2 * b, unseen[..., 0]), (d, b, none)
        elbow = (d, b, none), (d, none, unseen[..., 1])
        return np.stack([
            sum(
                (size**2 * x * y)[..., None, None, None] * product[m][n]
                for size, product, factors in zip(noise, products, by_reading)
                for m, x in enumerate(factors)
                for n, y in enumerate(factors)
            )
            for by_reading in (shoulder, elbow)
        ])  # fmt: skip

    return of_readings


def _answers(recording) -> np.ndarray:
    """Torque with which each joint's controller answers a wrong reading, (..., joint), N m/rad.

    Noise of a reading goes with the torque that it causes. Sixth differences leave hardly any
    motion of both.
    """
    q, tau = (
        np.diff(x[..., recording.motion, :], 6, axis=-2) for x in (recording.q, recording.tau)
    )
    return -np.sum(q * tau, (-3, -2)) / np.maximum(np.sum(q**2, (-3, -2)), 1e-300)


def _fitted(a, y) -> tuple[np.ndarray, np.ndarray]:
    """Least squares over joints, runs and bumps, (..., parameter), and the inverse of its matrix.

    If many parameters fit, the shortest ones.
    """
    size = np.sqrt(np.sum(a**2, (0, -3, -2)))
    size = np.where(size > 0, size, 1.0)
    scale = size[..., None] * size[..., None, :]
    seen = np.sum(np.swapaxes(a, -1, -2) @ a, (0, -3))
    felt = np.sum(np.swapaxes(a, -1, -2) @ y, (0, -3))
    inverse = np.linalg.pinv(seen / scale, 1e-10, hermitian=True) / scale
    return (inverse @ felt)[..., 0], inverse
