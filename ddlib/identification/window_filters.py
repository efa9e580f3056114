"""Window filters for position, velocity and acceleration, learnt together with the equations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.ndimage import convolve1d
from scipy.signal import savgol_coeffs

from ddlib._check import integer, number, one_of, series, shaped
from ddlib.identification.regression import Estimate, from_states, known_names
from ddlib.logs import warn_of
from ddlib.simulation import Recording

_QUANTITIES = ("position", "velocity", "acceleration")
_PULLS = tuple(10.0**-k for k in range(6))
_NUDGE = 1e-4  # of a state's deviation, for the slope of the torque over it
_STEPS, _SMALL = 60, 1e-6  # Gauss-Newton steps at most, and a gain at which they end


class _Projection(NamedTuple):
    cost: float  # mean logarithm of the joints' mean squared errors, and the pull
    values: np.ndarray  # the best parameters for some filters
    residual: np.ndarray  # what they leave over, (cases, joint), N m
    noise: np.ndarray  # its root mean square by joint
    basis: np.ndarray  # orthonormal, of the weighted regressor's columns


class FilteredEquations:
    """Equations of motion that see windows of positions through three learnt filters.

    ``torque = Y(p @ window, v @ window, a @ window) @ parameters``, with the same ``p``, ``v`` and
    ``a`` for all joints; all are fitted together, by variable projection (Golub & Pereyra 1973),
    from the filters of Savitzky & Golay (1964) on. What fixes the scale: ``p`` sums to 1; ``v``
    gives 0 at rest and 1 for a ramp of slope 1; ``a`` gives 0 at rest and for ramps, 1 for
    ``t^2 / 2``. All else is free, delay and smoothing included. Joints count by the inverse of
    their noise.

    Parameters
    ----------
    regressor : sequence of str or callable
        Names from `RIGID`, `GRAVITY`, `FRICTION` for a two-link arm; or a function of states
        ``(cases, joint, 3)`` (rad, rad/s, rad/s^2) that gives ``Y (cases, joint, parameters)`` or,
        as `joint_terms` does, columns by name for each joint, whose parameters are then its own.
    width, step : int, float
        Window size in samples, odd, 5 or more; sampling period, s.
    pull : float, optional
        Cost of a filter's squared distance from its first one, in lengths of that, beside the mean
        logarithm of the joints' mean squared errors. Default: of 1, .1, ... 1e-5 the one with the
        least error on runs left out one at a time.
    learn : sequence of str
        Filters to learn, of "position", "velocity", "acceleration"; the others stay as they are.

    Notes
    -----
    After `fit`, `filters` and their standard errors `filter_errors` are ``(3, width)``, oldest
    sample first, in 1, 1/s and 1/s^2, like `first`; `estimate` is an `Estimate`. The errors allow
    for noise that overlapping windows share (Newey & West 1987), not for the bias from noise in the
    positions, for which nothing is known here. So no intervals are given.
    """

    def __init__(self, regressor, width, step, pull=None, learn=_QUANTITIES):
        if not callable(regressor):
            known_names(regressor, "regressor")
            regressor = tuple(regressor)
        if integer("width", width, 5) % 2 == 0:
            raise ValueError(f"width must be odd, so that a window has a centre, got {width}")
        self.regressor, self.width = regressor, width
        self.step = step = number("step", step, 0.0, open_low=True)
        self.learn = [one_of("learn", name, _QUANTITIES) for name in series("learn", learn, str)]
        self.pull = self._given = None if pull is None else number("pull", pull, 0)
        self.first = np.stack([savgol_coeffs(width, 3, k, step, use="dot") for k in range(3)])
        powers = np.linspace(-1, 1, width) ** np.arange(3)[:, None]
        free = [np.linalg.svd(powers[: k + 1])[2][k + 1 :].T for k in range(3)]
        free = [x if name in self.learn else x[:, :0] for x, name in zip(free, _QUANTITIES)]
        size = np.linalg.norm(self.first, axis=1)[:, None, None]
        # What changes a filter and keeps its scale, in lengths of the first one
        self._ways = size * block_diag(*free).reshape(3, width, -1)

    def fit(self, runs, torques=None) -> FilteredEquations:
        """Learn from `runs`: a `Recording`, of which the motions count, or from each run positions
        ``(time, joint)`` or windows ``(cases, joint, width)``, rad, and its `torques`, N m."""
        pairs, z = self._pairs(runs, torques), np.zeros(self._ways.shape[2])
        self.pull = self._chosen(pairs, z) if self._given is None else self._given
        x, y = (np.concatenate(parts) for parts in zip(*pairs))
        for pull in (*(p for p in _PULLS if p > self.pull), self.pull):
            z, projection = self._solve(x, y, pull, z)
        self.filters = self.first + self._ways @ z
        self._measure(x, y, [len(torque) for _, torque in pairs], z, projection)
        return self

    def predict(self, runs) -> np.ndarray:
        """Torques ``(..., cases, joint)``, N m, of a `Recording` or of one array as in `fit`."""
        if not hasattr(self, "estimate"):
            raise RuntimeError("nothing has been learnt: call fit first")
        if isinstance(runs, Recording):
            torques = np.stack([self.predict(x) for x, _ in self._pairs(runs)])
            return torques.reshape(*runs.q.shape[:-2], *torques.shape[1:])
        states = self._windows("runs", runs) @ self.filters.T
        return self._rows(states) @ self.estimate.values

    @property
    def parameters(self) -> dict[str, float]:
        """The parameters found, by name."""
        return dict(zip(self.estimate.names, self.estimate.values.tolist()))

    def _windows(self, name, x) -> np.ndarray:
        if np.ndim(x) != 3:
            if len(x := shaped(name, x, "(time, joint)")) < self.width:
                raise ValueError(f"{name} must have {self.width} samples or more, got {len(x)}")
            return np.lib.stride_tricks.sliding_window_view(x, self.width, axis=0)
        return shaped(name, x, f"(cases, joint, {self.width})")

    def _pairs(self, runs, torques=None) -> list[tuple[np.ndarray, np.ndarray]]:
        half = self.width // 2
        if isinstance(runs, Recording):
            if abs(runs.step / self.step - 1) > 1e-6:
                raise ValueError(f"runs must have a step of {self.step:g} s, got {runs.step:g} s")
            warn_of(runs)
            runs = runs.for_windows(self.width)
            begin, end = runs.motion.start - half, runs.motion.stop + half
            if begin < 0 or end > runs.t.size:
                raise ValueError(f"runs must rest {half} samples before and after their motion")
            runs, torques = (x.reshape(-1, *x.shape[-2:])[:, begin:end] for x in (runs.q, runs.tau))
        runs, pairs = series("runs", runs), []
        torques = [] if torques is None else series("torques", torques)
        if len(torques) != len(runs) or not len(runs):
            raise ValueError(
                f"runs and torques must be as many, got {len(runs)} and {len(torques)}"
            )
        for k, (x, y) in enumerate(zip(runs, torques)):
            windows = self._windows(f"runs[{k}]", x)
            y = shaped(f"torques[{k}]", y, (len(x), windows.shape[1]))
            pairs.append((windows, y[half : len(y) - half] if np.ndim(x) == 2 else y))
        return pairs

    def _rows(self, states) -> np.ndarray:
        if not callable(self.regressor):
            self._names = self.regressor
            equations = from_states(*np.moveaxis(states, -1, 0), np.zeros(2), self._names)
            return np.stack(equations.regressor, -2)
        rows = self.regressor(states)
        if isinstance(rows[0], dict):
            self._names = tuple(f"{n}, joint {j + 1}" for j, row in enumerate(rows) for n in row)
            own = [np.stack([*row.values()], -1)[:, None] for row in rows]
            rows = np.concatenate([x * at[:, None] for x, at in zip(own, np.eye(len(own)))], -1)
        else:
            self._names = tuple(f"parameter {k + 1}" for k in range(np.shape(rows)[-1]))
        return shaped("regressor", rows, f"({len(states)}, {states.shape[1]}, parameters)")

    def _chosen(self, pairs, start) -> float:
        if len(pairs) < 2:
            raise ValueError("pull must be given if there is a single run, got None")
        wrong, scale = np.zeros(len(_PULLS)), np.concatenate([y for _, y in pairs]).std(0)
        for out, (x, y) in enumerate(pairs):
            z, others = start, [np.concatenate(p) for p in zip(*pairs[:out], *pairs[out + 1 :])]
            for k, pull in enumerate(_PULLS):
                z, projection = self._solve(*others, pull, z)
                residual = y - self._rows(x @ (self.first + self._ways @ z).T) @ projection.values
                wrong[k] += ((residual / scale) ** 2).sum()
        return _PULLS[int(wrong.argmin())]

    def _solve(self, x, y, pull, z) -> tuple[np.ndarray, _Projection]:
        """Gauss-Newton steps from `z` on, damped as by Levenberg and Marquardt."""
        if (y.std(0) == 0).any():
            raise ValueError("torques must vary at each joint, got constant ones")
        projection, damping = self._project(x, y, z, pull, y.std(0)), 1e-3
        for _ in range(_STEPS):
            slopes, before = self._slopes(x, z, projection), projection.cost
            slopes -= projection.basis @ (projection.basis.T @ slopes)
            curve = slopes.T @ slopes / y.size
            down = slopes.T @ (projection.residual / projection.noise).ravel() / y.size - pull * z
            while damping < 1e6:
                more = np.linalg.solve(curve + (pull + damping) * np.eye(z.size), down)
                tried = self._project(x, y, z + more, pull, projection.noise)
                if tried.cost <= before:
                    z, projection, damping = z + more, tried, damping / 4
                    break
                damping *= 4
            if before - projection.cost < _SMALL:
                break
        return z, projection

    def _project(self, x, y, z, pull, noise) -> _Projection:
        """The best parameters for filters, with each joint's weight by its noise so far."""
        rows = self._rows(x @ (self.first + self._ways @ z).T)
        basis, triangle = np.linalg.qr((rows / noise[:, None]).reshape(y.size, -1))
        size = np.linalg.norm(triangle, axis=0)
        if not (size > 0).all() or np.linalg.cond(triangle / size) > 1e10:
            raise ValueError("runs must determine all parameters of the regressor; they do not")
        values = np.linalg.solve(triangle, basis.T @ (y / noise).ravel())
        residual = y - rows @ values
        noise = np.maximum(np.sqrt((residual**2).mean(0)), 1e-9 * y.std(0))
        return _Projection(2 * np.log(noise).mean() + pull * z @ z, values, residual, noise, basis)

    def _slopes(self, x, z, projection) -> np.ndarray:
        """How the weighted torques change with the filters' coefficients, (cases * joint, z)."""
        states, slopes = (
            x @ (self.first + self._ways @ z).T,
            np.zeros((*projection.residual.shape, z.size)),
        )
        for j, k in np.argwhere(np.tile(self._ways.any((1, 2)), (x.shape[1], 1))):
            nudge = np.zeros(states.shape[1:])
            nudge[j, k] = _NUDGE * max(states[:, j, k].std(), 1e-9)
            change = self._rows(states + nudge) - self._rows(states - nudge)
            slope = change @ projection.values / (2 * nudge[j, k] * projection.noise)
            slopes += slope[..., None] * (x[:, j] @ self._ways[k])[:, None]
        return slopes.reshape(projection.residual.size, -1)

    def _measure(self, x, y, lengths, z, projection) -> None:
        """Standard errors of filters and parameters."""
        rows = (self._rows(x @ self.filters.T) / projection.noise[:, None]).reshape(y.size, -1)
        size = np.linalg.norm(rows, axis=0)
        every = np.concatenate([self._slopes(x, z, projection), rows / size], -1)
        pulled = np.diag(np.repeat([y.size * self.pull, 0], [z.size, size.size]))
        inverse = np.linalg.inv(every.T @ every + pulled)
        scores = np.einsum(
            "njp,nj->np", every.reshape(*y.shape, -1), projection.residual / projection.noise
        )
        spread, near = np.zeros_like(inverse), np.bartlett(2 * self.width + 1)
        for run_scores in np.split(scores, np.cumsum(lengths)[:-1]):
            spread += run_scores.T @ convolve1d(run_scores, near, axis=0, mode="constant")
        freedom = y.size - every.shape[1]
        covariance = inverse @ spread @ inverse * (y.size / freedom)
        errors = np.sqrt(np.diag(covariance))[z.size :] / size
        unsure = np.ones(projection.values.shape, bool)
        self.estimate = Estimate(
            self._names, projection.values, errors, projection.noise, freedom, unsure=unsure
        )
        ours = self._ways @ covariance[: z.size, : z.size]
        self.filter_errors = np.sqrt(np.maximum((ours * self._ways).sum(-1), 0))
