"""Parity: exact polynomials, networks that are right on every input, and learning."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.learning import Weights
from workshop.report import parity_networks
from workshop.report.parity_networks import NETWORKS, monomials, patterns


def in_words(row) -> int:
    """Parity by counting ones in a text: "1 or 0 depending on whether ... even or odd"."""
    return 1 if "".join(str(int(b)) for b in row).count("1") % 2 == 0 else 0


def test_parity_is_the_papers_function():
    x = patterns(5)
    assert parity_networks.parity(x).tolist() == [in_words(row) for row in x]
    assert parity_networks.parity(x.reshape(4, 8, 5)).shape == (4, 8)


def evaluate(coefficients, x):
    """A polynomial with one product of variables for each set, term by term."""
    bits = x.shape[1]
    return np.array(
        [
            sum(
                c * np.prod([row[k] for k in range(bits) if i >> k & 1])
                for i, c in enumerate(coefficients)
            )
            for row in x
        ]
    )


@given(st.lists(st.integers(-9, 9), min_size=16, max_size=16))
@settings(max_examples=25, deadline=None)
def test_polynomials_take_the_given_values(values):
    x = patterns(4)
    np.testing.assert_array_equal(evaluate(monomials(values), x), values)
    np.testing.assert_allclose(evaluate(monomials(values, "signs"), 1 - 2 * x), values)


@pytest.mark.parametrize("bits", [1, 2, 3, 10])
def test_how_many_coefficients_parity_needs(bits):
    values = parity_networks.parity(patterns(bits))
    by_bits, by_signs = monomials(values), monomials(values, "signs")
    assert np.count_nonzero(by_bits) == 2**bits
    assert np.count_nonzero(1 - values) and np.count_nonzero(monomials(1 - values)) == 2**bits - 1
    sizes = patterns(bits).sum(1)  # how many variables a product has
    np.testing.assert_array_equal(by_bits[1:], (-1) ** sizes[1:] * 2 ** (sizes[1:] - 1))
    assert np.flatnonzero(by_signs).tolist() == [0, 2**bits - 1]
    assert by_signs[[0, -1]].tolist() == [0.5, 0.5]


@pytest.mark.parametrize("name, bits", list(itertools.product(NETWORKS, (1, 2, 3, 5, 10))))
def test_networks_compute_parity_on_every_input(name, bits):
    network, x = NETWORKS[name](bits), patterns(bits)
    assert network.inputs == bits
    np.testing.assert_array_equal(network.output(x), [in_words(row) for row in x])
    assert np.abs(network.output(x, 20.0) - parity_networks.parity(x)).max() < 1e-4


@pytest.mark.parametrize("bits", [2, 3, 4, 7, 8, 16, 33, 100])
def test_counts_by_formula(bits):
    one, half, count, pairs = (make(bits) for make in NETWORKS.values())
    assert one.connections == bits**2 + bits and one.bias.size == bits + 1
    assert half.connections == (bits // 2 + 1) * bits + bits // 2
    digits = len(bin(bits)) - 2
    assert count.bias.size == count.depth == digits
    assert count.connections == digits * bits + digits * (digits - 1) // 2
    assert pairs.bias.size == 2 * (bits - 1) and pairs.connections == 5 * (bits - 1)
    assert one.depth == half.depth == 2 and pairs.depth == 2 * int(np.ceil(np.log2(bits)))


def test_the_counters_units_are_binary_digits():
    x = patterns(6)
    digits = parity_networks._counter(6).activity(x)
    for row, total in zip(digits, x.sum(1)):
        assert "".join(str(int(d)) for d in row[:-1]) == f"{total:03b}"[:-1]
        assert row[-1] == 1 - total % 2


def test_learning_finds_exclusive_or_and_says_when():
    weights, epochs = parity_networks.learn(2, 2, members=4, epochs=600, every=10)
    assert isinstance(weights, Weights) and len(weights) == 4
    assert np.isfinite(epochs).all() and (epochs % 10 == 0).all()
    x, y = parity_networks.parity_cases(2)
    assert (parity_networks.right(weights, x, y) == 1).all()
    early, none = parity_networks.learn(2, 2, members=4, epochs=10, every=10)
    assert np.isinf(none).all() and (parity_networks.right(early, x, y) < 1).all()


def test_cases_in_both_codings():
    (bits, y), (signs, same) = (
        parity_networks.parity_cases(3, coding) for coding in parity_networks.CODINGS
    )
    assert bits.shape == signs.shape == (8, 1, 3) and set(np.unique(signs)) == {-1, 1}
    np.testing.assert_array_equal(signs, 1 - 2 * bits)
    np.testing.assert_array_equal(y, same)
    assert sorted(set(y.ravel())) == pytest.approx([0.2, 0.8])


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: patterns(0), "bits must be an integer from 1 to 16, got 0"),
        (lambda: parity_networks.parity([0, 2]), "x must hold zeros and ones"),
        (lambda: monomials([1, 0, 1]), "values must have shape"),
        (lambda: monomials([0.5, 0]), "values must be whole numbers"),
        (lambda: monomials([1, 0], "words"), "coding must be one of 'bits', 'signs'"),
        (lambda: parity_networks.learn(2, 2, momentum=1.0), "momentum must lie in"),
        (lambda: parity_networks.learn(2, 2, epochs=5), "epochs must be an integer from 20"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(ValueError, match=words):
        call()
