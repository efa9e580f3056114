"""Targets that look like torques and have nothing to do with the motion: null controls.

Kept is: in "shifted" each run, moved in time around its ends; in "other run" the runs, exchanged;
in "phases" spectra and cross-spectrum (Prichard & Theiler, Physical Review Letters 73 (1994),
951-954); in "shuffled" the samples. Along the paper's family all runs have one shape, so that the
first two are not quite unrelated to the motion (`related` measures it).
"""

from __future__ import annotations

import numpy as np

from ddlib._check import finite_array, integer, number, one_of, seed_number

MATCHED = ("shifted", "other run", "phases")
"""Kinds of surrogates that are as smooth as the torques."""

_KINDS = (*MATCHED, "shuffled")
_LEAST_SHIFT = 0.1  # as a share of a run: 0.3 s of the paper's 3 s, in either direction


def surrogate(kind: str, torque, seed: int = 0) -> np.ndarray:
    """One draw of surrogate torques, of a kind from `MATCHED` or "shuffled".

    `torque` holds the motion run by run, ``(runs, time, joint)``, in any unit; so do the
    surrogates.
    """
    one_of("kind", kind, _KINDS)
    torque = finite_array("torque", torque)
    if torque.ndim != 3 or torque.shape[1] < 4:
        raise ValueError(
            f"torque must have shape (runs, time, joint) with 4 samples or more, got {torque.shape}"
        )
    rng = np.random.default_rng(seed_number("seed", seed))
    return _DRAWS[kind](torque, rng)


def surrogates(kind: str, torque, draws: int, seed: int = 0) -> np.ndarray:
    """Several draws, shape ``(draws, runs, time, joint)``; draw k depends on ``seed + k`` only."""
    integer("draws", draws, 1, 10**6)
    seed_number("seed", seed)
    return np.stack([surrogate(kind, torque, seed + k) for k in range(integer("draws", draws, 1))])


def p_value(value: float, draws, side: str = "two") -> float:
    """Probability of a value as far out as this one among `draws` from a null.

    Out is "more" (as large or larger), "less", or "two": either. The value itself counts as a draw,
    so that it is never zero (Phipson & Smyth 2010): of 20 draws 1/21 at least.
    """
    number("value", value)
    draws = finite_array("draws", draws)
    one_of("side", side, ("more", "less", "two"))
    if draws.ndim != 1 or not draws.size:
        raise ValueError(f"draws must be one number or more in a row, got shape {draws.shape}")
    more, less = ((1 + far.sum()) / (1 + draws.size) for far in (draws >= value, draws <= value))
    return float({"more": more, "less": less, "two": min(1.0, 2 * min(more, less))}[side])


def related(target, windows) -> np.ndarray:
    """Share of the variance of targets ``(cases, joint)`` that a filter of the windows explains.

    Nearly 1 for recorded torques. For surrogates it is what they still share with the motion, and
    what as many taps as ``(cases, joint, width)`` has fit to anything that is smooth.
    """
    target, windows = finite_array("target", target), finite_array("windows", windows)
    if target.ndim != 2 or windows.ndim != 3 or len(target) != len(windows):
        raise ValueError(
            "target and windows must have shapes (cases, joint) and (cases, joint, width), "
            f"got {target.shape} and {windows.shape}"
        )
    x = windows.reshape(len(windows), -1)
    x, y = x - x.mean(0), target - target.mean(0)
    square = x.T @ x
    square[np.diag_indices_from(square)] += 1e-6 * np.trace(square) / len(square)
    residual = y - x @ np.linalg.solve(square, x.T @ y)
    return 1 - (residual**2).sum(0) / (y**2).sum(0)


def _shifted(torque, rng):
    time = torque.shape[1]
    least = int(np.ceil(_LEAST_SHIFT * time))
    by = rng.integers(least, time - least + 1, len(torque))
    return np.stack([np.roll(run, k, 0) for run, k in zip(torque, by)])


def _other_run(torque, rng):
    if len(torque) < 2:
        raise ValueError("torque must have two runs or more for the torques of another, got 1")
    own = np.arange(len(torque))
    while True:  # a permutation without fixed points, all equally likely
        order = rng.permutation(own)
        if (order != own).all():
            return torque[order]


def _phases(torque, rng):
    runs, time, _ = torque.shape
    spectrum = np.fft.rfft(torque, axis=1)
    turn = np.exp(2j * np.pi * rng.random((runs, spectrum.shape[1], 1)))
    turn[:, 0] = 1  # the mean is real, and so is the highest frequency of an even length
    if time % 2 == 0:
        turn[:, -1] = 1
    return np.fft.irfft(spectrum * turn, time, axis=1)


def _shuffled(torque, rng):
    return np.stack([run[rng.permutation(len(run))] for run in torque])


_DRAWS = {
    "shifted": _shifted, "other run": _other_run, "phases": _phases, "shuffled": _shuffled,
}  # fmt: skip
