"""Parity: exact polynomials, networks that are right on every input, and learning."""

import itertools
from math import erf

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.learning import History, Weights
from workshop.chapters import backpropagation
from workshop.chapters.backpropagation import NETWORKS, monomials
from workshop.report.parity import learn, parity, parity_cases, patterns, right


def in_words(row) -> int:
    """Parity by counting ones in a text: "1 or 0 depending on whether ... even or odd"."""
    return 1 if "".join(str(int(b)) for b in row).count("1") % 2 == 0 else 0


def test_parity_is_the_papers_function():
    x = patterns(5)
    assert parity(x).tolist() == [in_words(row) for row in x]
    assert parity(x.reshape(4, 8, 5)).shape == (4, 8)


def evaluate(coefficients, x):
    """A polynomial with one product of variables for each set, term by term."""
    sets = [[k for k in range(x.shape[1]) if i >> k & 1] for i in range(len(coefficients))]
    return sum(c * x[:, chosen].prod(axis=1) for c, chosen in zip(coefficients, sets))


@given(st.lists(st.integers(-9, 9), min_size=16, max_size=16))
@settings(max_examples=25, deadline=None)
def test_polynomials_take_the_given_values(values):
    x = patterns(4)
    np.testing.assert_array_equal(evaluate(monomials(values), x), values)
    np.testing.assert_allclose(evaluate(monomials(values, "signs"), 1 - 2 * x), values)


@pytest.mark.parametrize("bits", [1, 2, 3, 10])
def test_how_many_coefficients_parity_needs(bits):
    values = parity(patterns(bits))
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
    assert np.abs(network.output(x, 20.0) - parity(x)).max() < 1e-4


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


def test_learning_finds_exclusive_or_and_says_when():
    weights, epochs = learn(2, 2, members=4, epochs=600, every=10)
    assert isinstance(weights, Weights) and len(weights) == 4
    assert np.isfinite(epochs).all() and (epochs % 10 == 0).all()
    x, y = parity_cases(2)
    assert (right(weights, x, y) == 1).all()
    early, none = learn(2, 2, members=4, epochs=10, every=10)
    assert np.isinf(none).all() and (right(early, x, y) < 1).all()


def test_best_possible_answers_to_noisy_parity():
    """A bit is read rightly with the chance p of staying below half a step; parity then has
    (1 + (2p - 1)^3) / 2.
    """
    measured = backpropagation.fine_distinctions()
    p = 0.5 * (1 + erf(0.5 / 0.25 / np.sqrt(2)))
    best = float(measured.text.split("at best ")[1].split(" %")[0])
    assert best == pytest.approx(50 * (1 + (2 * p - 1) ** 3), abs=1.5)
    assert 0.5 < measured.value <= 1.001  # chance, and as good as can be


def test_when_errors_reach_a_level():
    errors = np.array([[1.0, 0.5, 3.0], [0.8, 0.4, 2.0], [0.6, 0.3, 1.0]])
    history = History(np.array([10, 20, 40]), errors, None)
    np.testing.assert_allclose(backpropagation._reach(history, 0.75), [25.0, 10.0, np.inf])
    np.testing.assert_allclose(backpropagation._reach(history, 0.9), [15.0, 10.0, np.inf])
