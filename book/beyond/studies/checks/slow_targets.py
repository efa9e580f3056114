"""Copies of the walking robot's network that learnt for long, from targets slower than the joint.

A referee's three copies left the middle bar shares of 0.6, 0.3 and 0.1 in place of 1.0, with
targets of up to 0.5, 1 and 2 Hz. Expected of ten copies at up to 1 Hz: off by more than a quarter.
"""

from __future__ import annotations

import numpy as np

from beyond.studies.walking import (
    _CASES,
    _FREQUENCIES,
    _MEMBERS,
    _SIZES,
    STEP,
    _trained,
    gradient,
    layers,
    torque,
)
from workshop.report.code_hash import study

_SLOW = (0.1, 1.0)  # Hz


def _slowly_told(cases: int, seed: int) -> np.ndarray:
    """Histories as `walking` has them, but with slow sines in the target."""
    rng, t = np.random.default_rng(seed), -STEP * np.arange(3)
    error, velocity = np.zeros((2, cases, 3))
    for _ in range(3):
        moved, wanted = rng.uniform(*_SIZES, (2, cases, 1))
        w, slow = (2 * np.pi * rng.uniform(*f, (cases, 1)) for f in (_FREQUENCIES, _SLOW))
        first, second = rng.uniform(0, 2 * np.pi, (2, cases, 1))
        error += moved * np.sin(w * t + first) - wanted * np.sin(slow * t + second)
        velocity += moved * w * np.cos(w * t + first)
    return np.concatenate([error, velocity], axis=1)


def _copy(seed: int) -> dict:
    x = _slowly_told(_CASES, 0)
    copy, error = _trained(x, torque(x, layers()), seed, longer=True)
    return {"error": error, "gradient": gradient(x, copy).mean(0)}


@study
def _walking_slow() -> dict:
    """Mean gradients of the network and of its copies, over these histories."""
    own = gradient(_slowly_told(_CASES, 0), layers()).mean(0)
    return {"network": own, "slow": [_copy(seed) for seed in range(_MEMBERS)]}
