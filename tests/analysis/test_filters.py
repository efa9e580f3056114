"""Weight functions as filters: parts, derivatives, names, and filters of known gain."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as hnp
from numpy.polynomial import Polynomial
from scipy.signal import freqz

from ddlib.analysis import (
    basis,
    classify,
    content,
    decompose,
    frequency_response,
    roughness,
    savitzky_golay,
    shares,
    upright,
)

WIDTHS = (11, 21, 41)

functions = st.integers(2, 20).flatmap(
    lambda half: hnp.arrays(float, 2 * half + 1, elements=st.floats(-10, 10, width=32))
)


def random(size):
    """White noise, the same in every test."""
    return np.random.default_rng(8).normal(size=size)


def grid(width):
    return np.arange(width) - width // 2


def legendre(width):
    """Parabola and cubic that are orthogonal to what is below them, in closed form."""
    x, n = grid(width).astype(float), width // 2
    parabola = x**2 - n * (n + 1) / 3
    cubic = x**3 - x * (3 * n**2 + 3 * n - 1) / 5
    return {"position": 1 + 0 * x, "velocity": x, "acceleration": parabola, "jerk": cubic}


def mix(width, **weights):
    """Pure functions with given energies; a negative one turns the function."""
    known = legendre(width)
    return sum(
        np.sign(w) * np.sqrt(abs(w)) * known[n] / np.linalg.norm(known[n])
        for n, w in weights.items()
    )


@settings(max_examples=50)
@given(f=functions)
def test_the_parts_are_what_they_are_called_and_sum_to_the_function(f):
    """The paper takes the constant from the odd part, which is then not odd."""
    parts, printed = decompose(f), decompose(f, "paper")
    np.testing.assert_allclose(parts.sum(), f, atol=1e-12)
    np.testing.assert_allclose(parts.odd, -parts.odd[::-1], atol=1e-12)
    np.testing.assert_allclose(parts.even, parts.even[::-1], atol=1e-12)
    assert parts.constant[0] == pytest.approx(np.mean(f), abs=1e-12)
    assert parts.even.mean() == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(printed.sum(), f, atol=1e-12)
    np.testing.assert_allclose(printed.even, (f + f[::-1]) / 2, atol=1e-12)
    np.testing.assert_allclose(printed.odd, (f - f[::-1]) / 2 - f.mean(), atol=1e-12)


@pytest.mark.parametrize("width", WIDTHS)
def test_shares_of_a_sum_are_its_energies(width):
    x = grid(width).astype(float)
    rest = x**4 - Polynomial.fit(x, x**4, 3)(x)
    known = [*legendre(width).values(), rest]
    f = sum(np.sqrt(weight) * k / np.linalg.norm(k) for weight, k in zip((1, 2, 3, 4, 5), known))
    np.testing.assert_allclose(shares(f), np.arange(1, 6) / 15, atol=1e-12)
    np.testing.assert_allclose(content(f), np.sqrt([1, 2, 3, 4]))
    for order, pure in enumerate(known):
        np.testing.assert_allclose(shares(-2.5 * pure), np.eye(5)[order], atol=1e-12)


NAMED = [
    (dict(velocity=1), "velocity"),
    (dict(acceleration=-1), "acceleration"),
    (dict(jerk=1), "jerk"),
    (dict(velocity=0.6, acceleration=-0.4), "velocity + acceleration"),
    (dict(acceleration=0.5, jerk=0.5), "acceleration + jerk"),
    (dict(velocity=0.5, jerk=0.5), "other mix"),
    (dict(position=50, acceleration=1), "acceleration"),  # where the arm stands does not count
    (dict(position=-50, velocity=0.5, jerk=0.5), "other mix"),
]


@pytest.mark.parametrize("width", WIDTHS)
def test_names_of_pure_and_mixed_functions(width):
    for weights, name in NAMED:
        f = mix(width, **weights)
        noise = random(width)
        noise *= 0.03 * np.linalg.norm(mix(width, **{**weights, "position": 0})) / np.sqrt(width)
        names = classify([[f, -f], [40 * f, f + noise]])
        np.testing.assert_array_equal(names, [[name] * 2] * 2)
    for value in (1.0, 0.1, 0.3, -2.7, 1e-9):  # a constant has no derivative
        assert classify(np.full(width, value)) == "not analysable"


def test_rough_functions_are_not_analysable_and_four_fifths_decide():
    alternating = (-1.0) ** np.arange(21)
    assert classify(alternating) == "not analysable"
    assert (classify(random((40, 41))) == "not analysable").mean() > 0.9
    ramp = mix(21, velocity=1)
    rough = alternating - content(alternating) @ basis(21)
    rough /= np.linalg.norm(rough)
    below, above = ramp + 0.45 * rough, ramp + 0.55 * rough  # 17 and 23 % of the energy
    np.testing.assert_array_equal(classify([below, above]), ["velocity", "not analysable"])
    assert classify(above + 100.0) == "not analysable"  # a constant does not smooth
    for share, name in ((0.79, "other mix"), (0.81, "velocity")):
        assert classify(mix(21, velocity=share, jerk=1 - share)) == name


@pytest.mark.parametrize("sign", [1, -1])
def test_a_filter_is_turned_so_that_its_strongest_derivative_counts_positive(sign):
    x = grid(21).astype(float)
    turned = upright(sign * np.array([x, x**2 - np.mean(x**2), 20 * x - x**2, x**3]))
    np.testing.assert_array_equal(turned[0], x)
    assert turned[1][10] < 0 < turned[1][0]
    np.testing.assert_array_equal(turned[2:], [20 * x - x**2, x**3])


def test_roughness_of_lines_noise_and_zigzag():
    x = grid(21)
    np.testing.assert_allclose(roughness([3 + 2 * x, -0.1 * x]), 0, atol=1e-20)
    assert roughness(np.full(21, 0.3)) == 0
    noise = roughness(random((3000, 41)))
    assert noise.mean() == pytest.approx(1, abs=0.05)
    # second differences of +1, -1 are 4 in size: 16 / (6 x variance)
    zigzag = (-1.0) ** np.arange(41)
    assert roughness(zigzag) == pytest.approx(16 / (6 * zigzag.var()))
    assert roughness(x**2) < 0.01 < roughness(np.sin(x)) < 1


@pytest.mark.parametrize("width, degree", [(11, 2), (21, 4), (41, 3), (7, 6)])
def test_savitzky_golay_is_a_least_squares_fit(width, degree):
    noisy, x = random(width), grid(width) * 0.01
    fitted = Polynomial.fit(x, noisy, degree)
    for derivative in range(degree + 1):
        exact = fitted.deriv(derivative)(0.0) if derivative else fitted(0.0)
        ours = savitzky_golay(width, derivative, 0.01, degree) @ noisy
        assert ours == pytest.approx(exact, rel=1e-6)
    # oldest sample first: a rising position gives a positive velocity
    assert savitzky_golay(width, 1, 0.01, degree) @ grid(width) > 0


@pytest.mark.parametrize("width", WIDTHS)
def test_frequency_response_is_scipys_without_the_delay(width):
    """A causal filter sees the newest sample first, and the centre half a window ago."""
    f = random((3, width))
    frequencies = np.linspace(0, 50, 40)
    ours = frequency_response(f, frequencies, 0.01)
    assert ours.shape == (3, 40)
    for weights, gain in zip(f, ours):
        _, causal = freqz(weights[::-1], worN=frequencies, fs=100.0)
        delay = np.exp(-2j * np.pi * frequencies * 0.01 * (width // 2))
        np.testing.assert_allclose(gain, causal / delay, atol=1e-10)
