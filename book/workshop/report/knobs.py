"""Which knobs decide Table 4-1: a screening design, a regression on it, and what it tells.

Every knob is turned to three places, coded -1, 0 and 1, in a *definitive screening design*
(Jones & Nachtsheim 2011): twice as many runs as knobs, and one. Main effects are orthogonal to
each other, to all squares and to all products of two knobs. A Bayesian regression
(`_Emulator`) then says what any other places would give, how sure it is, what share of the
variance each knob makes, and, by `_weigh`, which places the printed numbers speak for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
from scipy.special import logsumexp
from scipy.stats import qmc

from ddlib._check import finite_array, integer, number, one_of
from ddlib.control import proportional
from ddlib.effects import (
    CMU_DD_ARM_II_EFFECTS,
    CoulombFriction,
    Noise,
    Quantisation,
    ViscousFriction,
)
from ddlib.setups import JOINT_DAMPING, KP, Setup
from ddlib.simulation import Recording


@dataclass(frozen=True)
class _Knob:
    """A quantity that is varied between two bounds."""

    low: float  # its value at place -1
    high: float  # and at 1
    logarithmic: bool = True  # whether equal steps are equal factors

    def value(self, place):
        """Value at a coded place, -1 to 1."""
        share = (np.asarray(place, dtype=float) + 1) / 2
        if self.logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share

    def place(self, value):
        """Coded place of a value."""
        if self.logarithmic:
            return 2 * np.log(np.asarray(value) / self.low) / np.log(self.high / self.low) - 1
        return 2 * (np.asarray(value) - self.low) / (self.high - self.low) - 1


# Knobs of the recording. The damping is a factor of `JOINT_DAMPING`'s, which is the IMI arm's;
# friction, gain and noise are factors of the default ones; the start is in s.
_RECORDING = {
    "joint damping": _Knob(0.35, 2.0),
    "Coulomb friction": _Knob(0.5, 6.0),
    "position gain": _Knob(0.7, 6.0),
    "encoder bits": _Knob(11.5, 16.0, logarithmic=False),
    "torque noise": _Knob(0.25, 4.0),
    "start left out": _Knob(0.0, 0.3, logarithmic=False),
}

# Knobs of the learning, by method. The momentum is ``1 / (1 - momentum)``: how many steps go on
# together; the step is the rate times the width of the window.
METHODS = {
    "descent": {
        "lowest input": _Knob(-1.0, 0.0, logarithmic=False),
        "momentum": _Knob(50.0, 200.0),
        "step": _Knob(8.25, 33.0),
        "epochs": _Knob(6_000.0, 24_000.0),
    },
    "solver": {
        "lowest input": _Knob(-1.0, 0.0, logarithmic=False),
        "decay": _Knob(1e-7, 1e-5),
        "steps": _Knob(15.0, 60.0),
    },
}


def knobs_of(method: str) -> dict[str, _Knob]:
    """All knobs of a method, those of the recording first."""
    return {**_RECORDING, **METHODS[one_of("method", method, tuple(METHODS))]}


def _screening() -> np.ndarray:
    """The definitive screening design for twelve knobs, shape ``(25, 12)``, of -1, 0 and 1.

    A conference matrix of order 12 (Paley's, from the squares modulo 11), its mirror image, and
    the centre. For fewer knobs leave out columns.
    """
    squares = {k * k % 11 for k in range(1, 11)}
    core = [[0 if i == j else 1 if (j - i) % 11 in squares else -1 for j in range(11)]
            for i in range(11)]  # fmt: skip
    conference = np.zeros((12, 12))
    conference[0, 1:], conference[1:, 0], conference[1:, 1:] = 1, -1, core
    return np.concatenate([conference, -conference, np.zeros((1, 12))])


def _setup(values: Mapping[str, float], method: str) -> Setup:
    """The experiment with every knob of a method at some value."""
    for name, knob in knobs_of(method).items():
        if name not in values:
            raise ValueError(f"values must have one for {name!r}, got {sorted(values)}")
        slack = 1e-9 * (knob.high - knob.low)  # of rounding
        number(name, values[name], knob.low - slack, knob.high + slack)
    default = CMU_DD_ARM_II_EFFECTS
    viscous, coulomb = JOINT_DAMPING.effects.friction[0], default.friction[1]

    def times(name, pair):
        return tuple(float(values[name]) * np.asarray(pair))

    effects = replace(
        default,
        friction=(
            ViscousFriction(times("joint damping", viscous.coefficient)),
            CoulombFriction(times("Coulomb friction", coulomb.level)),
        ),
        encoder=(Quantisation(2 * np.pi / 2 ** values["encoder bits"]),),
        torque_sensor=(Noise(times("torque noise", default.torque_sensor[0].std)),),
    )
    made = replace(
        JOINT_DAMPING,
        name=method,
        controller=proportional(times("position gain", KP)),
        effects=effects,
        scaling=(float(values["lowest input"]), 1.0),
    )
    if method == "solver":
        return replace(made, decay=float(values["decay"]), steps=round(values["steps"]))
    return replace(
        made,
        steps=0,
        decay=0.0,
        momentum=1 - 1 / float(values["momentum"]),
        rate=float(values["step"]),
        epochs=round(values["epochs"]),
    )


def _without_start(recording: Recording, seconds: float) -> Recording:
    """A recording whose motion begins `seconds` later: less of the start transient."""
    late = number("seconds", seconds, 0.0, 2.0)
    begin, end = recording.span
    return replace(recording, t=recording.t - late, duration=end - begin - late)


def _terms(places) -> np.ndarray:
    """Terms of the regression: 1, every knob, squares less their mean, products, shape (points, 1 +
    2 knobs + knobs (knobs - 1).
    """
    x = np.atleast_2d(finite_array("places", places))
    pairs = [x[:, i] * x[:, j] for i, j in combinations(range(x.shape[1]), 2)]
    return np.column_stack([np.ones(len(x)), x, x**2 - 1 / 3, *pairs])


# Standard deviations tried for the coefficients of first and of second order
_MAIN, _SECOND = (0.1, 0.2, 0.4, 0.8, 1.6), (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)

# Standard deviations tried for what a polynomial of second order misses
_MISFIT = (0.0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.7)


@dataclass(frozen=True)
class _Emulator:
    """A polynomial of second order through the runs of a design, and how sure it is.

    Bayesian linear regression: coefficients of one order are drawn from a normal distribution
    around 0, and so is what the polynomial misses; their widths are those that make the data
    likeliest. So products that the design cannot tell apart share what they explain, and
    `predict` is the less sure of it.

    Attributes
    ----------
    mean : ndarray, shape (terms,)
        Coefficients of `_terms`.
    covariance : ndarray, shape (terms, terms)
    misfit : float
        Variance of what the polynomial misses.
    """

    mean: np.ndarray
    covariance: np.ndarray
    misfit: float = 0.0

    @classmethod
    def fit(cls, places, values, variance: float, widths=None) -> _Emulator:
        """Fit to the values of a response."""
        design, values = _terms(places), finite_array("values", values)
        number("variance", variance, 0.0, open_low=True)
        main, second, misfit = widths or _likeliest(places, values, variance)
        squares = _squares(places, main, second)
        gain = squares[:, None] * design.T
        total = (variance + misfit**2) * np.eye(len(values)) + design @ gain
        solved = np.linalg.solve(total, np.column_stack([values, gain.T]))
        covariance = np.diag(squares) - gain @ solved[:, 1:]
        return cls(gain @ solved[:, 0], (covariance + covariance.T) / 2, misfit**2)

    def predict(self, places) -> tuple[np.ndarray, np.ndarray]:
        """Mean of the response at some places, and the variance around it, misfit included."""
        design = _terms(places)
        spread = np.einsum("ni,ij,nj->n", design, self.covariance, design)
        return design @ self.mean, spread + self.misfit

    def draws(self, count: int, seed: int = 0) -> np.ndarray:
        """Coefficients as they may be, shape ``(count, terms)``."""
        rng = np.random.default_rng(seed)
        return rng.multivariate_normal(self.mean, self.covariance, integer("count", count, 1))


def _squares(places, main, second) -> np.ndarray:
    """Variances of the coefficients of `_terms` before anything is seen."""
    count = np.atleast_2d(places).shape[1]
    squares = np.full(1 + 2 * count + count * (count - 1) // 2, second**2)
    squares[0], squares[1 : 1 + count] = 100.0, main**2
    return squares


def _likeliest(places, values, variance: float) -> tuple[float, float, float]:
    """The `widths` of `Emulator.fit` that make the `values` at `places` likeliest.

    `variance` is that of a value's own noise.
    """
    design, values = _terms(places), finite_array("values", values)

    def likelihood(widths):
        main, second, misfit = widths
        total = (design * _squares(places, main, second)) @ design.T
        total += (variance + misfit**2) * np.eye(len(values))
        return -values @ np.linalg.solve(total, values) - np.linalg.slogdet(total)[1]

    return max(product(_MAIN, _SECOND, _MISFIT), key=likelihood)


def _left_out(places, values, variance: float) -> np.ndarray:
    """Each run's value less what the others predict, in the standard deviations of that.

    The widths are those of all runs together; `places`, `values` and `variance` are those of
    `Emulator.fit`.
    """
    places, values = np.asarray(places, dtype=float), np.asarray(values, dtype=float)
    widths, scores = _likeliest(places, values, variance), []
    for k in range(len(values)):
        others = np.arange(len(values)) != k
        emulator = _Emulator.fit(places[others], values[others], variance, widths)
        mean, spread = emulator.predict(places[k])
        scores.append((values[k] - mean[0]) / np.sqrt(spread[0] + variance))
    return np.array(scores)


def _shares(coefficients, count: int) -> np.ndarray:
    """Share of a response's variance that each knob makes, when all are drawn evenly, shape (...,
    2, count).

    Sobol indices of a polynomial in `_terms`: by itself (main), and with all products it takes part
    in (total).
    """
    coefficients = np.asarray(coefficients, dtype=float)
    linear, square = coefficients[..., 1 : 1 + count], coefficients[..., 1 + count : 1 + 2 * count]
    both = coefficients[..., 1 + 2 * count :] ** 2 / 9
    main = linear**2 / 3 + square**2 * 4 / 45
    joint = np.zeros_like(main)
    for k, (i, j) in enumerate(combinations(range(count), 2)):
        joint[..., i] += both[..., k]
        joint[..., j] += both[..., k]
    variance = (main.sum(-1) + both.sum(-1))[..., None]
    return np.stack([main / variance, (main + joint) / variance], axis=-2)


def _spread_evenly(count: int, dimensions: int, seed: int = 0) -> np.ndarray:
    """Coded places that fill the cube evenly (Sobol's sequence, scrambled by `seed`)."""
    points = qmc.Sobol(dimensions, rng=integer("seed", seed, 0)).random(integer("count", count, 1))
    return 2 * points - 1


def _weigh(means, variances, covariance, observed) -> tuple[np.ndarray, float]:
    """Posterior weights of places, from what was observed once, shape (places,)."""
    means, variances = finite_array("means", means), finite_array("variances", variances)
    total = np.asarray(covariance) + variances[:, :, None] * np.eye(means.shape[1])
    miss = np.asarray(observed) - means
    fit = np.einsum("ni,ni->n", miss, np.linalg.solve(total, miss[..., None])[..., 0])
    log = -0.5 * (fit + np.linalg.slogdet(2 * np.pi * total)[1])
    evidence = float(logsumexp(log) - np.log(len(log)))
    return np.exp(log - logsumexp(log)), evidence


def moments(places, weights) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of each knob under some weights."""
    mean = weights @ places
    return mean, np.sqrt(np.maximum(weights @ places**2 - mean**2, 0.0))


def would_tell(places, weights, means, variance, draws: int = 300, seed: int = 0) -> np.ndarray:
    """How much narrower each knob would be if one more number were known, on average, shape
    (knobs,).
    """
    rng = np.random.default_rng(seed)
    picked = rng.choice(len(weights), size=draws, p=weights)
    after = []
    for number_ in rng.normal(means[picked], np.sqrt(variance[picked])):
        log = -0.5 * ((number_ - means) ** 2 / variance + np.log(variance))
        again = weights * np.exp(log - log.max())
        after.append(moments(places, again / again.sum())[1] ** 2)
    return np.sqrt(np.mean(after, axis=0)) / moments(places, weights)[1]
