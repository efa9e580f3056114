"""The parity function of section 1.1: as a polynomial, as networks of units, and learned.

Parity is "1 or 0 depending on whether the number of 1 bits in an input string of length n is
even or odd". `monomials` counts what a polynomial needs, exactly; `_one_layer`, `_direct`,
`_counter` and `_tree` are networks with weights set by hand; `learn` trains networks from
random weights by batch descent with acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ddlib._check import finite_array, integer, number, one_of, shaped
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


def monomials(values, coding: str = "bits") -> np.ndarray:
    """Coefficients of the polynomial that equals a function of bits on all its inputs.

    No variable appears squared in it, since a bit (or a sign) squared is nothing new; so the
    polynomial is unique. Its coefficients come from the Möbius transform for bits and from the
    Walsh-Hadamard transform for signs, and are exact: whole numbers for bits, whole numbers over
    ``2**bits`` for signs.
    """
    values, coding = finite_array("values", values), one_of("coding", coding, CODINGS)
    bits = values.size.bit_length() - 1
    shaped("values", values, (2 ** integer("bits of values", bits, 1, _MOST_BITS),))
    if (values != np.round(values)).any():
        raise ValueError("values must be whole numbers")
    table = values.astype(np.int64).reshape((2,) * bits)  # one axis for each bit
    for axis in range(bits):
        off, on = np.split(table, 2, axis)
        pair = (off, on - off) if coding == "bits" else (off + on, off - on)
        table = np.concatenate(pair, axis)
    flat = table.ravel()
    return flat if coding == "bits" else flat / 2**bits


@dataclass(frozen=True)
class _UnitNetwork:
    """Units one after the other, each seeing the inputs and any unit before it.

    The last unit is the output. Weights and biases are small whole or half numbers; `activity`
    multiplies them by a gain.
    """

    weights: np.ndarray  # (units, inputs + units); 0 means no connection
    bias: np.ndarray  # (units,)

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return self.weights.shape[1] - self.bias.size

    @property
    def connections(self) -> int:
        """Number of weights that are not zero, biases not counted."""
        return int(np.count_nonzero(self.weights))

    @property
    def coefficients(self) -> int:
        """Number of weights and biases."""
        return self.connections + self.bias.size

    @property
    def word(self) -> int:
        """Bits that the largest weight or bias needs: counted in halves, with its sign."""
        largest = max(np.abs(self.weights).max(), np.abs(self.bias).max())
        return int(np.ceil(2 * largest)).bit_length() + 1

    @property
    def depth(self) -> int:
        """Units on the longest way from an input to the output."""
        depth = np.zeros(self.bias.size, int)
        for k, row in enumerate(self.weights[:, self.inputs :]):
            depth[k] = 1 + max(depth[row != 0], default=0)
        return int(depth[-1])

    def activity(self, x, gain: float = np.inf) -> np.ndarray:
        """Activities of all units, shape (..., units)."""
        x = finite_array("x", x, self.inputs)
        if gain != np.inf:
            number("gain", gain, 0.0, open_low=True)
        seen = np.concatenate([x, np.zeros((*x.shape[:-1], self.bias.size))], -1)
        for k, (row, bias) in enumerate(zip(self.weights, self.bias)):
            net = seen @ row + bias
            on = net > 0 if gain == np.inf else 0.5 * (1 + np.tanh(0.5 * gain * net))
            seen[..., self.inputs + k] = on
        return seen[..., self.inputs :]

    def output(self, x, gain: float = np.inf) -> np.ndarray:
        """Activity of the last unit, shape (...), for inputs and gain as for `activity`."""
        return self.activity(x, gain)[..., -1]


def _build(inputs: int, rows) -> _UnitNetwork:
    """A network from a pair for each unit: weights by place, units after the inputs, and bias."""
    weights = np.zeros((len(rows), inputs + len(rows)))
    for k, (links, _) in enumerate(rows):
        weights[k, list(links)] = list(links.values())
    return _UnitNetwork(weights, np.array([bias for _, bias in rows], float))


def _one_layer(bits: int) -> _UnitNetwork:
    """Parity by one hidden layer: unit k is on if k bits or more are on (Rumelhart et al. 1986)."""
    bits = integer("bits", bits, 1)
    hidden = [(dict.fromkeys(range(bits), 1), 0.5 - k) for k in range(1, bits + 1)]
    return _build(bits, [*hidden, ({bits + k: -((-1) ** k) for k in range(bits)}, 0.5)])


def _direct(bits: int) -> _UnitNetwork:
    """Parity by half as many hidden units and direct weights (Hohil, Liu & Smith 1999)."""
    bits = integer("bits", bits, 1)
    hidden = [(dict.fromkeys(range(bits), 1), 0.5 - 2 * k) for k in range(1, bits // 2 + 1)]
    above = dict.fromkeys(range(bits, bits + len(hidden)), 2)
    return _build(bits, [*hidden, (dict.fromkeys(range(bits), -1) | above, 0.5)])


def _counter(bits: int) -> _UnitNetwork:
    """Parity by a counter: each unit is a binary digit of the number of bits that are on.

    A unit sees all inputs and the higher digits, which take their value away from the number;
    the lowest digit is parity. About ``bits log2(bits)`` weights, in a depth of ``log2(bits)``.
    """
    bits = integer("bits", bits, 1)
    higher = [2**j for j in range(bits.bit_length() - 1, 0, -1)]
    places, inputs = range(bits, bits + len(higher)), dict.fromkeys(range(bits), 1)
    known = dict(zip(places, (-value for value in higher)))
    rows = [(inputs | {i: known[i] for i in range(bits, p)}, 0.5 + known[p]) for p in places]
    lowest = {place: -weight for place, weight in (inputs | known).items()}
    return _build(bits, [*rows, (lowest, 0.5)])


def _tree(bits: int) -> _UnitNetwork:
    """Parity by a tree of two-bit parities, two units each: seven coefficients for a bit more."""
    bits = integer("bits", bits, 1)
    rows, ends = [], list(range(bits))  # places of what is still to be joined
    while len(ends) > 1:
        joined = []
        for a, b in zip(ends[::2], ends[1::2]):
            both = bits + len(rows)
            rows.append(({a: 1, b: 1}, -1.5))
            rows.append(({a: 1, b: 1, both: -2}, -0.5))
            joined.append(both + 1)
        ends = joined + ends[len(joined) * 2 :]
    if not rows:  # a single bit
        rows = [({0: 1}, -0.5)]
    links, bias = rows[-1]
    rows[-1] = ({place: -weight for place, weight in links.items()}, -bias)  # odd to even
    return _build(bits, rows)


# Networks that compute parity, by name: functions of the number of bits
NETWORKS = {
    "one hidden layer": _one_layer,
    "with direct weights": _direct,
    "binary counter": _counter,
    "tree of pairs": _tree,
}


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
