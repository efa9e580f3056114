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

from ddlib._check import integer, number, one_of, shaped
from ddlib.dynamics import Operations
from workshop.beyond.rivals.protocol import NotFitted, Rival

MOST = 5000
"""Functions at most."""

BLOCK = 2000
"""Cases whose functions are computed at once."""

KINDS_OF_POLYNOMIAL = {"monomials": polyvander, "chebyshev": chebvander}
"""Polynomials of one variable that products are made of."""


def exponents(variables: int, degree: int) -> np.ndarray:
    """All exponents of a total degree at most, shape (terms, variables), lowest degrees first.

    Parameters
    ----------
    variables, degree : int
        1 or more; 0 or more.

    Raises
    ------
    ValueError
        If there are more than `MOST`.
    """
    integer("variables", variables, 1)
    terms = comb(variables + integer("degree", degree, 0), degree)
    _few(terms)
    found = np.zeros((1, 0), dtype=int)
    for _ in range(variables):
        room = degree - found.sum(1)
        found = np.concatenate(
            [np.c_[np.repeat(row[None], left + 1, 0), np.arange(left + 1)]
             for row, left in zip(found, room)]
        )  # fmt: skip
    return found[np.argsort(found.sum(1), kind="stable")]


def wave_numbers(variables: int, order: int) -> np.ndarray:
    """Whole-number wave vectors but one of each opposite pair, shape (waves, variables).

    Parameters
    ----------
    variables : int
        1 or more.
    order : int
        Most that the absolute values sum up to; 1 or more.

    Raises
    ------
    ValueError
        If their sines and cosines are more than `MOST`.
    """
    integer("order", order, 1)
    found = []
    for size in exponents(variables, order)[1:]:
        moving = np.flatnonzero(size)
        _few(2 * len(found))
        for signs in product((1, -1), repeat=len(moving) - 1):  # the first is positive
            wave = size.copy()
            wave[moving[1:]] *= np.array(signs, dtype=int)
            found.append(wave)
    return np.array(found)


def _few(terms):
    if terms > MOST:
        raise ValueError(f"degree or order must give at most {MOST} functions, got {terms}")


class Solution(NamedTuple):
    """Linear least squares, solved for any penalty on the squared coefficients.

    Attributes
    ----------
    sizes : ndarray, shape (directions,)
        Singular values of the design over the root of the number of cases, largest first.
    directions : ndarray, shape (directions, functions)
        Their directions among coefficients.
    seen : ndarray, shape (directions, joint)
        What the target says along each.
    floor : float
        A singular value at most so large is taken for rounding.
    """

    sizes: np.ndarray
    directions: np.ndarray
    seen: np.ndarray
    floor: float

    @classmethod
    def of(cls, design, target) -> Solution:
        """Decompose functions ``(cases, functions)`` and targets ``(cases, joint)``."""
        design = shaped("design", design, "(cases, functions)")
        target = shaped("target", target, f"({len(design)}, joint)")
        root = np.sqrt(len(design))
        left, sizes, directions = np.linalg.svd(design / root, full_matrices=False)
        floor = sizes[0] * np.finfo(float).eps * max(design.shape)
        return cls(sizes, directions, left.T @ target / root, floor)

    def coefficients(self, ridge: float = 0.0) -> np.ndarray:
        """Those with the least mean squared error plus `ridge` times their squares' sum.

        Parameters
        ----------
        ridge : float
            For 0: the shortest of the least-squares solutions.

        Returns
        -------
        ndarray, shape (functions, joint)
        """
        number("ridge", ridge, 0.0)
        kept = self.sizes > self.floor
        factor = self.sizes[kept] / (self.sizes[kept] ** 2 + ridge)
        return self.directions[kept].T @ (factor[:, None] * self.seen[kept])


class Basis(Rival):
    """Torque as a sum of functions of the state, fitted by least squares.

    States are scaled so that the training states' box has edges from -1 to 1.

    Parameters
    ----------
    ridge : float
        Penalty on squared coefficients (`Solution.coefficients`); the mean torque is free of it.
    """

    def __init__(self, ridge: float = 0.0):
        self.ridge = number("ridge", ridge, 0.0)

    def _fit(self, x, torque):
        low, high = x.min(0), x.max(0)
        self.centre, self.half = (low + high) / 2, np.where(high > low, (high - low) / 2, 1.0)
        self._prepare(self.centre.size)
        self.mean = torque.mean(0)
        self._solution = Solution.of(self.design(x), torque - self.mean)
        self.coefficients = self._solution.coefficients(self.ridge)

    def _torque(self, x):
        blocks = np.array_split(x, max(1, len(x) // BLOCK))
        return np.concatenate([self.mean + self.design(b) @ self.coefficients for b in blocks])

    def with_ridge(self, ridge: float) -> Basis:
        """The same fitted rival with another penalty, at nearly no cost.

        Parameters
        ----------
        ridge : float
            0 or more.
        """
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
        """Values of all functions, shape (cases, functions), once it has been fitted.

        Parameters
        ----------
        x : ndarray, shape (cases, joint, 3)
            States.
        """
        return self._functions(((x - self.centre) / self.half).reshape(len(x), -1))

    def count(self):
        """Numbers kept."""
        return self.coefficients.size + self.mean.size + self.centre.size + self.half.size


class Polynomial(Basis):
    """A polynomial of the state of some total degree.

    Parameters
    ----------
    degree : int
        Largest sum of a term's exponents.
    kind : {"chebyshev", "monomials"}
        Products of Chebyshev polynomials or of powers. Both span the same functions: without a
        penalty they differ where the cases leave coefficients open, and by rounding.
    ridge : float
        As in `Basis`.
    """

    def __init__(self, degree: int = 3, kind: str = "chebyshev", ridge: float = 0.0):
        super().__init__(ridge)
        self.degree = integer("degree", degree, 0)
        self.kind_of = one_of("kind", kind, tuple(KINDS_OF_POLYNOMIAL))

    def __repr__(self):
        return f"Polynomial({self.degree}, {self.kind_of!r}, ridge={self.ridge:g})"

    def _prepare(self, variables):
        self.exponents = exponents(variables, self.degree)

    def _functions(self, u):
        found = np.ones((len(u), len(self.exponents)))
        for values, power in zip(np.moveaxis(u, 1, 0), self.exponents.T):
            found *= KINDS_OF_POLYNOMIAL[self.kind_of](values, self.degree)[:, power]
        return found

    def operations(self):
        """Arithmetic of one prediction."""
        terms, joints = self.coefficients.shape
        variables = self.exponents.shape[1]
        double = self.kind_of == "chebyshev"  # T_k = 2 u T_(k-1) - T_(k-2)
        made = variables * max(self.degree - 1, 0)
        joined = int((self.exponents > 0).sum(1).clip(min=1).sum()) - terms
        return Operations(
            variables * (1 + double) + made + joined + terms * joints,
            variables + double * made + terms * joints,
        )


class Fourier(Basis):
    """A Fourier series of the state: sines and cosines of waves in all directions.

    Parameters
    ----------
    order : int
        Largest sum of a wave's whole numbers of periods along all axes.
    period : float
        Of the longest wave, in edges of the box; over 1, so that opposite sides may differ.
    ridge : float
        As in `Basis`.
    """

    def __init__(self, order: int = 2, period: float = 2.0, ridge: float = 0.0):
        super().__init__(ridge)
        self.order = integer("order", order, 1)
        self.period = number("period", period, 1.0)

    def __repr__(self):
        return f"Fourier({self.order}, ridge={self.ridge:g})"

    def _prepare(self, variables):
        self.waves = wave_numbers(variables, self.order)

    def _functions(self, u):
        angle = np.pi / self.period * (u @ self.waves.T)
        return np.concatenate([np.ones((len(u), 1)), np.cos(angle), np.sin(angle)], 1)

    def operations(self):
        """Arithmetic of one prediction."""
        (waves, variables), (terms, joints) = self.waves.shape, self.coefficients.shape
        steps = int(np.abs(self.waves).sum()) - waves  # sums of the scaled axes
        return Operations(
            variables + terms * joints, variables + steps + terms * joints, 0, 2 * waves
        )
