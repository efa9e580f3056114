"""Gaussian processes: a prediction with its own uncertainty, from every case that was seen.

The state of a process may be past positions, the window of the paper (Dalla Libera et al. 2020).
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.kernel_approximation import RBFSampler
from sklearn.linear_model import RidgeCV

from beyond.rivals.identified import Identified
from beyond.rivals.protocol import Rival
from ddlib.identification import FRICTION, GRAVITY, RIGID

_STEPS = 100  # iterations that a search for hyperparameters may take
_TINY = 1e-9  # share of the torque below which what is left over counts as rounding


class _Inputs:
    """Inputs of a kernel: each number standardised, or the leading directions of the windows."""

    def __init__(self, x, directions: int | None = None):
        flat = x.reshape(len(x), -1)
        self.mean = flat.mean(0)
        if directions is None:
            spread = flat.std(0)
            self.matrix = np.diag(1 / np.where(spread > 0, spread, 1.0))
        else:
            _, size, basis = np.linalg.svd(flat - self.mean, full_matrices=False)
            self.matrix = basis[:directions].T * (np.sqrt(len(x)) / size[:directions])
        self.diagonal = directions is None

    def __call__(self, x) -> np.ndarray:
        """Features ``(cases, features)`` of inputs ``(cases, joint, rows)``."""
        return (x.reshape(len(x), -1) - self.mean) @ self.matrix

    def count(self) -> int:
        return self.mean.size + (self.mean.size if self.diagonal else self.matrix.size)


class GaussianProcess(Rival):
    """An exact Gaussian process for each joint (Rasmussen & Williams 2006).

    The kernel is squared exponential, with a length for each feature, plus noise. Lengths, size and
    noise maximise the marginal likelihood of a subset of the cases; the process is then conditioned
    on all of them.
    """

    def __init__(
        self,
        kind: str = "windows",
        *,
        directions: int | None = None,  # principal ones of the inputs as features, or each number
        subset: int = 300,  # cases for the search of hyperparameters, drawn at random
        restarts: int = 1,  # further searches, from random starts
        seed: int = 0,
    ):
        self.kind, self.directions = kind, directions
        self.subset, self.restarts, self.seed = subset, restarts, seed

    def _fit(self, x, torque):
        self.inputs = _Inputs(x, self.directions)
        self.level, self.unit = torque.mean(0), torque.std(0)
        self.unit = np.where(self.unit > 0, self.unit, 1.0)
        features, target = self.inputs(x), (torque - self.level) / self.unit
        rng = np.random.default_rng(self.seed)
        some = rng.choice(len(x), min(self.subset, len(x)), replace=False)
        self.processes = [
            self._process(features, y, some, int(rng.integers(2**31))) for y in target.T
        ]

    def _process(self, features, y, some, seed):
        lengths = RBF(np.full(features.shape[1], 3.0), (0.1, 1e4))
        kernel = ConstantKernel(1.0, (1e-3, 1e4)) * lengths + WhiteKernel(1e-2, (1e-7, 1e1))
        search = GaussianProcessRegressor(
            kernel, optimizer=_ascend, n_restarts_optimizer=self.restarts, random_state=seed
        )
        with warnings.catch_warnings():  # a length at its bound: the feature does not matter
            warnings.simplefilter("ignore", ConvergenceWarning)
            fitted = search.fit(features[some], y[some]).kernel_
        return GaussianProcessRegressor(fitted, optimizer=None).fit(features, y)

    def _torque(self, x):
        features = self.inputs(x)
        each = [process.predict(features) for process in self.processes]
        return self.level + self.unit * np.stack(each, -1)

    def deviation(self, x) -> np.ndarray:
        """Deviation of the torque that would be measured, noise included; `x` as for `torque`."""
        self.torque(x)
        return self._deviation(np.asarray(x, dtype=float))

    def _deviation(self, x):
        features = self.inputs(x)
        each = [process.predict(features, return_std=True)[1] for process in self.processes]
        return self.unit * np.stack(each, -1)

    def count(self):
        """Stored numbers: the cases, their weights, the kernels; intervals would need more."""
        joints, (cases, features) = len(self.processes), self.processes[0].X_train_.shape
        kernel = features + 1
        return self.inputs.count() + cases * features + joints * (cases + kernel + 2)


class SemiParametric(Rival):
    """The arm's equations, and Gaussian processes for the rest (Nguyen-Tuong & Peters 2010)."""

    def __init__(self, names: Sequence[str] = (*RIGID, *GRAVITY, *FRICTION), **options):
        self.known = Identified(names)
        self.rest = GaussianProcess("states", **options)

    def _fit(self, x, torque):
        self.known._fit(x, torque)
        residual = torque - self.parametric(x)
        self.exact = bool((residual.std(0) <= _TINY * torque.std(0)).all())
        if not self.exact:
            self.rest._fit(x, residual)

    def parametric(self, x) -> np.ndarray:
        """The part of the torque that the equations explain, ``(cases, joint)``."""
        return self.known._torque(np.asarray(x, dtype=float))

    def _torque(self, x):
        return self.parametric(x) + (0.0 if self.exact else self.rest._torque(x))

    def deviation(self, x) -> np.ndarray:
        """As in `GaussianProcess`; the parameters count as known."""
        self.torque(x)
        x = np.asarray(x, dtype=float)
        return np.zeros(x.shape[:2]) if self.exact else self.rest._deviation(x)

    def count(self):
        """Stored numbers of the equations and of the processes."""
        return self.known.count() + (0 if self.exact else self.rest.count())


class RandomFeatures(Rival):
    """Ridge regression on random cosines of the inputs (Rahimi & Recht 2007)."""

    PENALTIES = tuple(np.logspace(-10, 2, 13))

    def __init__(
        self,
        kind: str = "windows",
        features: int = 300,
        *,
        directions: int | None = None,  # as in `GaussianProcess`
        lengths: Sequence[float] = (1.0, 2.0, 4.0, 8.0, 16.0),  # to try, of standardised inputs
        seed: int = 0,
    ):
        self.kind, self.features, self.directions = kind, features, directions
        self.lengths, self.seed = lengths, seed

    def _fit(self, x, torque):
        self.inputs = _Inputs(x, self.directions)
        self.level, self.unit = torque.mean(0), torque.std(0)
        self.unit = np.where(self.unit > 0, self.unit, 1.0)
        z, target = self.inputs(x), (torque - self.level) / self.unit
        candidates = []
        for length in self.lengths:
            cosines = RBFSampler(
                gamma=0.5 / length**2, n_components=self.features, random_state=self.seed
            ).fit(z)
            ridge = RidgeCV(self.PENALTIES, alpha_per_target=True).fit(cosines.transform(z), target)
            candidates.append((float(np.sum(ridge.best_score_)), length, cosines, ridge))
        _, self.length, self.cosines, self.ridge = max(candidates, key=lambda each: each[0])

    def _torque(self, x):
        scaled = self.ridge.predict(self.cosines.transform(self.inputs(x)))
        return self.level + self.unit * scaled.reshape(len(x), -1)

    def count(self):
        """Stored numbers: of the inputs, the cosines, and their factors."""
        inputs, joints = self.inputs.matrix.shape[1], len(self.level)
        return self.inputs.count() + self.features * (inputs + 1 + joints) + 3 * joints


def _ascend(objective, start, bounds):
    """Search of hyperparameters, cut off after `_STEPS` iterations."""
    optimum = minimize(
        objective, start, method="L-BFGS-B", jac=True, bounds=bounds, options={"maxiter": _STEPS}
    )
    return optimum.x, optimum.fun
