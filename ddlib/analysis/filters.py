"""Weights as convolution filters: even and odd parts, derivative content (section 5.1).

A weight function ``f(x)`` is a unit's weights from one joint's window, the last axis of `f`, oldest
sample first. Even functions see acceleration, odd ones velocity (and jerk).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ddlib._check import finite_array, integer, number, one_of


class Decomposition(NamedTuple):
    """The parts of a weight function; ``constant + even + odd`` is the function itself."""

    constant: np.ndarray  # of shape (..., 1)
    even: np.ndarray
    odd: np.ndarray

    def sum(self) -> np.ndarray:
        """The function that was decomposed."""
        return self.constant + self.even + self.odd


def with_centre(f) -> np.ndarray:
    """Weight functions with a centre; a ValueError if the last axis has an even length or 1."""
    f = finite_array("f", f)
    if f.ndim == 0 or f.shape[-1] < 3 or f.shape[-1] % 2 == 0:
        raise ValueError(f"f must have an odd last axis of 3 or more samples, got shape {f.shape}")
    return f


def decompose(f, convention: str = "symmetric") -> Decomposition:
    """Split weight functions ``(..., width)`` into constant, even and odd parts about x = 0.

    With the "symmetric" `convention` the mean is taken out of the even part, so that the odd part
    is odd. "paper": as printed in section 5.1, where it is taken out of the *odd* part: the sum is
    the same, but "odd" is then not odd and "even" keeps the mean.
    """
    f = with_centre(f)
    one_of("convention", convention, ("symmetric", "paper"))
    mirrored = f[..., ::-1]
    constant = f.mean(-1, keepdims=True)
    even, odd = (f + mirrored) / 2, (f - mirrored) / 2
    if convention == "paper":
        return Decomposition(constant, even, odd - constant)
    return Decomposition(constant, even - constant, odd)


DERIVATIVES = ("position", "velocity", "acceleration", "jerk")
"""Names of the derivatives of order 0 to 3."""


def basis(width: int) -> np.ndarray:
    """Orthonormal discrete Legendre (Gram) polynomials of degree 0 to 3, shape (4, width).

    A weight function's component along degree k is its response to the k-th derivative.
    """
    x = np.linspace(-1, 1, integer("width", width, 4))
    q, r = np.linalg.qr(np.vander(x, 4, increasing=True))
    return (q * np.sign(np.diag(r))).T


def content(f) -> np.ndarray:
    """Components of weight functions of 5 samples or more along `basis`, ``(..., 4)``."""
    f = with_centre(f)
    if f.shape[-1] < 5:
        raise ValueError(
            f"f must have 5 samples or more for four derivatives, got {f.shape[-1]}: take a wider "
            "window"
        )
    return f @ basis(f.shape[-1]).T


def shares(f) -> np.ndarray:
    """Share of each derivative in the energy of weight functions ``(..., width)``, shape (..., 5).

    Position, velocity, acceleration, jerk, and the rest, which no cubic explains; they sum to 1.
    """
    f = with_centre(f)
    energy = (f**2).sum(-1, keepdims=True)
    if (energy == 0).any():
        raise ValueError("f must not be zero everywhere")
    parts = content(f) ** 2 / energy
    return np.concatenate([parts, np.clip(1 - parts.sum(-1, keepdims=True), 0, None)], -1)


NAMED_CLASSES = (
    "velocity",
    "acceleration",
    "jerk",
    "velocity + acceleration",
    "acceleration + jerk",
)
_OTHER_MIX, _NOT_ANALYSABLE = "other mix", "not analysable"
CLASSES = (*NAMED_CLASSES, _OTHER_MIX, _NOT_ANALYSABLE)
"""Names that `classify` gives."""

_PURE = 0.8  # share of the cubic part's energy from which one derivative, or two, give the name
_SMOOTH = 0.8  # smallest share of the energy that a cubic must explain: else "not analysable"


def classify(f) -> np.ndarray:
    """Name weight functions by the derivatives they respond to, one of `CLASSES` each.

    Their constants do not count, and one that is constant is "not analysable".
    """
    share = shares(f)
    v, a, j = np.moveaxis(share[..., 1:4], -1, 0)
    total = np.where(v + a + j > 0, v + a + j, 1)
    v, a, j = v / total, a / total, j / total
    varying = 1 - share[..., 0]
    rough = (share[..., 4] > (1 - _SMOOTH) * varying) | (varying < 1e-12)
    conditions = [rough, *(x >= _PURE for x in (v, a, j, v + a, a + j))]
    return np.select(conditions, [_NOT_ANALYSABLE, *NAMED_CLASSES], _OTHER_MIX)


def purest(f, name: str) -> np.ndarray:
    """The weight function of a class with the largest share of the named derivatives."""
    one_of("name", name, CLASSES)
    f = with_centre(f)
    f = f.reshape(-1, f.shape[-1])
    share = np.moveaxis(shares(f), -1, 0)
    named = [share[DERIVATIVES.index(n)] for n in name.split(" + ") if n in DERIVATIVES]
    value = np.min(named, axis=0) if named else share[4]
    fitting = classify(f) == name
    if not fitting.any():
        raise ValueError(f"f holds no function of class {name!r}")
    return f[np.where(fitting, value, -np.inf).argmax()]


def upright(f) -> np.ndarray:
    """Weight functions with the sign that lets their strongest derivative count positive.

    A hidden unit and its negative are the same unit, so the sign is free.
    """
    f = with_centre(f)
    parts = content(f)[..., 1:]
    strongest = np.take_along_axis(parts, np.abs(parts).argmax(-1)[..., None], -1)
    return np.where(strongest < 0, -f, f)


def roughness(f) -> np.ndarray:
    """Energy of the second differences against white noise's, shape (...).

    0 for a straight line, about 1 for white noise, more for an alternating one.
    """
    f = with_centre(f)
    centred = f - f.mean(-1, keepdims=True)
    energy = (centred**2).mean(-1)
    second = (np.diff(f, 2, axis=-1) ** 2).mean(-1)
    return np.divide(second, 6 * energy, out=np.zeros_like(energy), where=energy > 0)


def savitzky_golay(width: int, derivative: int, step: float, degree: int = 3) -> np.ndarray:
    """Least-squares filter that estimates a derivative at the window's centre, shape (width,).

    Parameters
    ----------
    width : int
        Window size in samples, odd; ``weights @ window``, oldest sample first, is the estimate.
    derivative, degree : int
        Order of the derivative, and degree of the fitted polynomial.
    step : float
        Sampling period, s.
    """
    from scipy.signal import savgol_coeffs

    if integer("width", width, 3) % 2 == 0:
        raise ValueError(f"width must be odd, so that a window has a centre, got {width}")
    integer("degree", degree, 0, width - 1)
    integer("derivative", derivative, 0, degree)
    number("step", step, 0.0, open_low=True)
    return savgol_coeffs(width, degree, deriv=derivative, delta=step, use="dot")


def frequency_response(f, frequencies, step: float) -> np.ndarray:
    """Complex gain of filters for ``exp(i 2 pi nu t)``, with nu in Hz and the period in s.

    Frequencies are at most half the sampling rate: above it samples do not tell them apart.
    """
    f, frequencies = with_centre(f), finite_array("frequencies", frequencies)
    number("step", step, 0.0, open_low=True)
    if frequencies.ndim > 1:
        raise ValueError(f"frequencies must be one number or a row, got shape {frequencies.shape}")
    if frequencies.size and np.abs(frequencies).max() > (1 + 1e-9) / (2 * step):
        raise ValueError(
            f"frequencies must not exceed half the sampling rate, {1 / (2 * step):g} Hz, got "
            f"{np.abs(frequencies).max():g}"
        )
    half = f.shape[-1] // 2
    times = np.arange(-half, half + 1) * step
    return f @ np.exp(2j * np.pi * times[:, None] * frequencies)
