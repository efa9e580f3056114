"""Polynomials and Fourier series against numpy's, exact recovery, the penalty's closed form."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev, polynomial

from beyond.rivals.bases import Fourier, Polynomial
from beyond.rivals.protocol import Cases

RNG = np.random.default_rng(3)


def states(n=600, seed=0):
    x = np.random.default_rng(seed).uniform(-1, 1, (n, 2, 3))
    x[0], x[1] = -1.0, 1.0  # the box is known, so that scaling changes nothing
    return x


def cases(x, torque):
    return Cases(x, torque, "states", 0.01)


@pytest.mark.parametrize(
    "kind, vander, value", [("monomials", polynomial.polyvander2d, polynomial.polyval2d),
                            ("chebyshev", chebyshev.chebvander2d, chebyshev.chebval2d)],
)  # fmt: skip
def test_terms_are_numpys(kind, vander, value):
    x = states(400)
    x[..., 1:] = 0.0  # two variables that move
    coefficients = RNG.normal(size=(4, 4)) * (np.add.outer(range(4), range(4)) <= 3)
    torque = np.stack([value(x[:, 0, 0], x[:, 1, 0], coefficients), x[:, 0, 0]], -1)
    rival = Polynomial(3, kind).fit(cases(x, torque))
    np.testing.assert_allclose(rival.torque(x), torque, atol=1e-9)
    wanted = vander(x[:, 0, 0], x[:, 1, 0], (3, 3))
    for column, power in zip(rival.design(x).T, rival.exponents):
        if not power[[1, 2, 4, 5]].any():
            np.testing.assert_allclose(column, wanted[:, 4 * power[0] + power[3]], atol=1e-12)
    assert rival.count() == 2 * 84 + 2 + 12  # coefficients, mean torques, and the box


def test_a_fourier_series_is_recovered():
    x, asked = states(800), states(50, seed=5) * 0.99
    waves = np.array(
        [[2, 0, 0, 0, 0, 0], [0, 1, 0, -1, 0, 0], [0, 0, 0, 0, 1, 1], [0, 0, 1, 0, 0, 0]]
    )

    def torque(at):
        angle = np.pi / 2 * at.reshape(len(at), 6) @ waves.T
        return np.stack([np.cos(angle).sum(1) + 0.3, np.sin(angle).sum(1)], -1)

    rival = Fourier(2).fit(cases(x, torque(x)))
    np.testing.assert_allclose(rival.torque(asked), torque(asked), atol=1e-8)


def test_ridge_is_the_closed_form():
    x = states(100)
    torque = RNG.normal(size=(100, 2))
    centred = torque - torque.mean(0)
    for ridge in (1e-3, 1.0):
        rival = Polynomial(2, ridge=ridge).fit(cases(x, torque))
        design = rival.design(x)
        closed = np.linalg.solve(
            design.T @ design / 100 + ridge * np.eye(28), design.T @ centred / 100
        )
        np.testing.assert_allclose(rival.coefficients, closed, atol=1e-10)
    few = Polynomial(2).fit(cases(x[:5], torque[:5]))  # 28 functions for five cases
    shortest = np.linalg.lstsq(few.design(x[:5]), torque[:5] - torque[:5].mean(0), rcond=None)[0]
    np.testing.assert_allclose(few.coefficients, shortest, atol=1e-10)
