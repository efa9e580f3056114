"""Least squares on fixed functions of the state: polynomials and Fourier series."""

from __future__ import annotations

from abc import abstractmethod
from itertools import product

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.polynomial.polynomial import polyvander
from sklearn.linear_model import Ridge
from sklearn.preprocessing import PolynomialFeatures

from beyond.rivals.protocol import Rival

_BLOCK = 2000  # cases whose functions are computed at once
_POLYNOMIALS = {"monomials": polyvander, "chebyshev": chebvander}  # of one variable


def _exponents(variables: int, degree: int) -> np.ndarray:
    """All exponents of a total degree at most, shape (terms, variables), lowest degrees first."""
    return PolynomialFeatures(degree).fit(np.zeros((1, variables))).powers_


def _wave_numbers(variables: int, order: int) -> np.ndarray:
    """Whole-number wave vectors of a sum of sizes at most `order`, one of each opposite pair."""
    waves = []
    for size in _exponents(variables, order)[1:]:
        moving = np.flatnonzero(size)
        for signs in product((1, -1), repeat=len(moving) - 1):  # the first is positive
            wave = size.copy()
            wave[moving[1:]] *= np.array(signs, dtype=int)
            waves.append(wave)
    return np.array(waves)


class _Basis(Rival):
    """Torque as a sum of functions of the state, scaled to -1 to 1, fitted by least squares.

    `ridge` is a penalty on squared coefficients beside the mean squared error; without one the
    shortest of the best coefficients are taken.
    """

    def __init__(self, ridge: float = 0.0):
        self.ridge = ridge

    def _fit(self, x, torque):
        low, high = x.min(0), x.max(0)
        self.centre, self.half = (low + high) / 2, np.where(high > low, (high - low) / 2, 1.0)
        self._prepare(self.centre.size)
        self.mean = torque.mean(0)
        design, target = self.design(x), torque - self.mean
        if self.ridge:
            penalised = Ridge(self.ridge * len(x), fit_intercept=False, solver="svd")
            self.coefficients = penalised.fit(design, target).coef_.T
        else:
            self.coefficients = np.linalg.lstsq(design, target)[0]

    def _torque(self, x):
        blocks = np.array_split(x, max(1, len(x) // _BLOCK))
        return np.concatenate([self.mean + self.design(b) @ self.coefficients for b in blocks])

    @abstractmethod
    def _prepare(self, variables) -> None:
        """Decide on the functions."""

    @abstractmethod
    def _functions(self, u) -> np.ndarray:
        """Their values ``(cases, functions)`` at scaled states ``(cases, variables)``."""

    def design(self, x) -> np.ndarray:
        """Values of all functions ``(cases, functions)`` at states, once it has been fitted."""
        return self._functions(((x - self.centre) / self.half).reshape(len(x), -1))

    def count(self):
        return self.coefficients.size + self.mean.size + self.centre.size + self.half.size


class Polynomial(_Basis):
    """A polynomial of the state: products of Chebyshev polynomials or of powers.

    `degree` is the largest sum of a term's exponents. Both kinds span the same functions: without
    a penalty they differ where the cases leave coefficients open, and by rounding.
    """

    def __init__(self, degree: int = 3, kind: str = "chebyshev", ridge: float = 0.0):
        super().__init__(ridge)
        self.degree, self.kind_of = degree, kind

    def _prepare(self, variables):
        self.exponents = _exponents(variables, self.degree)

    def _functions(self, u):
        values = np.ones((len(u), len(self.exponents)))
        for variable, power in zip(np.moveaxis(u, 1, 0), self.exponents.T):
            values *= _POLYNOMIALS[self.kind_of](variable, self.degree)[:, power]
        return values


class Fourier(_Basis):
    """A Fourier series of the state; the longest wave is twice as long as the box."""

    def __init__(self, order: int = 2, ridge: float = 0.0):
        super().__init__(ridge)
        self.order = order

    def _prepare(self, variables):
        self.waves = _wave_numbers(variables, self.order)

    def _functions(self, u):
        angle = np.pi / 2 * (u @ self.waves.T)
        return np.concatenate([np.ones((len(u), 1)), np.cos(angle), np.sin(angle)], 1)
