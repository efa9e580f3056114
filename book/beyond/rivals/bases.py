"""Least squares on fixed functions of the state: polynomials and Fourier series."""

from __future__ import annotations

from abc import abstractmethod
from copy import copy
from itertools import product
from math import comb
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.polynomial.polynomial import polyvander

from beyond.rivals.protocol import NotFitted, Rival
from ddlib._check import integer, number, one_of, shaped
from ddlib.dynamics import Operations

_MOST = 5000  # functions at most
_BLOCK = 2000  # cases whose functions are computed at once
_POLYNOMIALS = {"monomials": polyvander, "chebyshev": chebvander}  # of one variable


def _exponents(variables: int, degree: int) -> np.ndarray:
    """All exponents of a total degree at most, shape (terms, variables), lowest degrees first."""
    terms = comb(variables + degree, degree)
    _few(terms)
    rows = np.zeros((1, 0), dtype=int)
    for _ in range(variables):
        room = degree - rows.sum(1)
        rows = np.concatenate(
            [np.c_[np.repeat(row[None], left + 1, 0), np.arange(left + 1)]
             for row, left in zip(rows, room)]
        )  # fmt: skip
    return rows[np.argsort(rows.sum(1), kind="stable")]


def _wave_numbers(variables: int, order: int) -> np.ndarray:
    """Whole-number wave vectors of a sum of sizes at most `order`, one of each opposite pair."""
    waves = []
    for size in _exponents(variables, order)[1:]:
        moving = np.flatnonzero(size)
        _few(2 * len(waves))
        for signs in product((1, -1), repeat=len(moving) - 1):  # the first is positive
            wave = size.copy()
            wave[moving[1:]] *= np.array(signs, dtype=int)
            waves.append(wave)
    return np.array(waves)


def _few(terms):
    if terms > _MOST:
        raise ValueError(f"degree or order must give at most {_MOST} functions, got {terms}")


class _Solution(NamedTuple):
    """Linear least squares by singular values, solved for any penalty on squared coefficients."""

    sizes: np.ndarray  # singular values over the root of the number of cases, largest first
    directions: np.ndarray  # theirs among the coefficients, a row each
    seen: np.ndarray  # what the target says along each, a column for each joint
    floor: float  # a singular value at most so large is taken for rounding

    @classmethod
    def of(cls, design, target) -> _Solution:
        """Decompose functions ``(cases, functions)`` and targets ``(cases, joint)``."""
        design = shaped("design", design, "(cases, functions)")
        target = shaped("target", target, f"({len(design)}, joint)")
        root = np.sqrt(len(design))
        left, sizes, directions = np.linalg.svd(design / root, full_matrices=False)
        floor = sizes[0] * np.finfo(float).eps * max(design.shape)
        return cls(sizes, directions, left.T @ target / root, floor)

    def coefficients(self, ridge: float = 0.0) -> np.ndarray:
        """Least mean squared error plus `ridge` times squared coefficients; for 0 the shortest."""
        large = self.sizes > self.floor
        factor = self.sizes[large] / (self.sizes[large] ** 2 + ridge)
        return self.directions[large].T @ (factor[:, None] * self.seen[large])


class _Basis(Rival):
    """Torque as a sum of functions of the state, scaled to -1 to 1, fitted by least squares."""

    def __init__(self, ridge: float = 0.0):
        self.ridge = number("ridge", ridge, 0.0)

    def _fit(self, x, torque):
        low, high = x.min(0), x.max(0)
        self.centre, self.half = (low + high) / 2, np.where(high > low, (high - low) / 2, 1.0)
        self._prepare(self.centre.size)
        self.mean = torque.mean(0)
        self._solution = _Solution.of(self.design(x), torque - self.mean)
        self.coefficients = self._solution.coefficients(self.ridge)

    def _torque(self, x):
        blocks = np.array_split(x, max(1, len(x) // _BLOCK))
        return np.concatenate([self.mean + self.design(b) @ self.coefficients for b in blocks])

    def with_ridge(self, ridge: float) -> _Basis:
        """The same fitted rival with another penalty, at nearly no cost."""
        if not hasattr(self, "coefficients"):
            raise NotFitted(f"{self!r} has learnt nothing: call fit first")
        other = copy(self)
        other.ridge = number("ridge", ridge, 0.0)
        other.coefficients = self._solution.coefficients(ridge)
        return other

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
        self.degree = integer("degree", degree, 0)
        self.kind_of = one_of("kind", kind, tuple(_POLYNOMIALS))

    def _prepare(self, variables):
        self.exponents = _exponents(variables, self.degree)

    def _functions(self, u):
        values = np.ones((len(u), len(self.exponents)))
        for variable, power in zip(np.moveaxis(u, 1, 0), self.exponents.T):
            values *= _POLYNOMIALS[self.kind_of](variable, self.degree)[:, power]
        return values

    def operations(self):
        """Arithmetic of one prediction."""
        terms, joints = self.coefficients.shape
        variables = self.exponents.shape[1]
        double = self.kind_of == "chebyshev"  # T_k = 2 u T_(k-1) - T_(k-2)
        powers = variables * max(self.degree - 1, 0)
        joined = int((self.exponents > 0).sum(1).clip(min=1).sum()) - terms
        return Operations(
            variables * (1 + double) + powers + joined + terms * joints,
            variables + double * powers + terms * joints,
        )


class Fourier(_Basis):
    """A Fourier series of the state; `period` of the longest wave is in edges of the box."""

    def __init__(self, order: int = 2, period: float = 2.0, ridge: float = 0.0):
        super().__init__(ridge)
        self.order = integer("order", order, 1)
        self.period = number("period", period, 1.0)

    def _prepare(self, variables):
        self.waves = _wave_numbers(variables, self.order)

    def _functions(self, u):
        angle = np.pi / self.period * (u @ self.waves.T)
        return np.concatenate([np.ones((len(u), 1)), np.cos(angle), np.sin(angle)], 1)

    def operations(self):
        """Operations for one torque of all joints."""
        (waves, variables), (terms, joints) = self.waves.shape, self.coefficients.shape
        steps = int(np.abs(self.waves).sum()) - waves  # sums of the scaled axes
        return Operations(
            variables + terms * joints, variables + steps + terms * joints, 0, 2 * waves
        )
