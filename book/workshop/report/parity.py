"""The parity function of section 1.1, and networks that learn it.

Parity is "1 or 0 depending on whether the number of 1 bits in an input string of length n is
even or odd".
"""

from __future__ import annotations

import numpy as np

from ddlib._check import finite_array, integer, number, one_of
from ddlib.learning.descent import Descent
from ddlib.learning.network import Weights
from ddlib.learning.training import TARGET_RANGE

_INITIAL, _RATE = 1.0, 8.0  # Range of the initial weights, step size times cases, in `learn`

_MOST_BITS = 16  # Most bits for which all inputs are listed

# Ways to write an input for a polynomial: 0 and 1, or 1 and -1 (-1 for a bit that is on)
CODINGS = ("bits", "signs")


def patterns(bits: int) -> np.ndarray:
    """All inputs of a length, shape ``(2**bits, bits)``: input i holds the binary digits of i."""
    integer("bits", bits, 1, _MOST_BITS)
    return np.arange(2**bits)[:, None] >> np.arange(bits) & 1


def parity(x) -> np.ndarray:
    """1 where an even number of bits is on, else 0, shape (...)."""
    x = finite_array("x", x)
    if x.ndim == 0 or not np.isin(x, (0, 1)).all():
        raise ValueError("x must hold zeros and ones only, along its last axis")
    return (x.sum(-1) % 2 == 0).astype(int)


def parity_cases(bits: int, coding: str = "bits") -> tuple[np.ndarray, np.ndarray]:
    """All inputs and their parity as cases for training."""
    bit, coding = patterns(bits), one_of("coding", coding, CODINGS)
    low, high = TARGET_RANGE
    x = bit if coding == "bits" else 1 - 2 * bit
    return x[:, None, :].astype(float), low + (high - low) * parity(bit)[:, None]


def right(weights: Weights, x, y) -> np.ndarray:
    """Share of the cases on whose side of the targets' middle the output lies, shape (...)."""
    middle = sum(TARGET_RANGE) / 2
    output = weights.activity(x)[1]
    return ((output > middle) == (finite_array("y", y, 1) > middle)).mean((-2, -1))


def learn(
    bits: int,
    hidden: int,
    *,
    members: int = 30,
    seed: int = 0,
    momentum: float = 0.9,
    epochs: int = 4000,
    every: int = 20,
) -> tuple[Weights, np.ndarray]:
    """Train networks with a hidden layer and direct weights, like the paper's, on parity.

    Returns them and, for each, at which look (`every` so many epochs) it was first right on all
    inputs; infinite if at none.
    """
    number("momentum", momentum, 0.0, 0.999)
    integer("epochs", epochs, integer("every", every, 1))
    x, y = parity_cases(bits)
    start = Weights.random(members, bits, hidden, 1, 1, _INITIAL, seed)
    descent = Descent(start, x, y, _RATE / len(x), momentum)
    learned = np.full(members, np.inf)
    for epoch in range(1, epochs + 1):
        descent.epoch()
        if epoch % every == 0:
            done = right(descent.weights(), x, y) == 1
            learned[done & np.isinf(learned)] = epoch
    return descent.weights(), learned
