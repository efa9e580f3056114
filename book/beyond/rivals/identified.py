"""Known structure: least squares on the equations of motion, and on the inputs as they are.

Rigid-body torque is linear in base parameters (Khosla 1986; An, Atkeson & Hollerbach 1988).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from beyond.rivals.protocol import Rival, derivative_filters
from ddlib._check import one_of
from ddlib.identification import FRICTION, GRAVITY, RIGID, from_states, least_squares

_RIDGES = tuple(10.0**k for k in range(-12, 1))  # of the largest singular value squared


class Identified(Rival):
    """Base parameters of a two-link arm and its friction, by weighted least squares.

    `names` are the parameters to find, from `RIGID`, `GRAVITY` and `FRICTION` of
    `ddlib.identification`; after `fit`, `estimate` holds them with their standard errors.
    """

    def __init__(self, names: Sequence[str] = RIGID + FRICTION):
        for name in names:
            one_of("names", name, (*RIGID, *GRAVITY, *FRICTION))
        self.names = tuple(names)

    def _fit(self, x, torque):
        self.estimate = least_squares(from_states(*np.moveaxis(x, -1, 0), torque, self.names))

    def _torque(self, x):
        equations = from_states(*np.moveaxis(x, -1, 0), np.zeros(2), self.names)
        return np.stack([y @ self.estimate.values for y in equations.regressor], -1)

    def parameters(self) -> dict[str, float]:
        """The values found, by name: kg m^2, N m s/rad or N m."""
        return dict(zip(self.names, self.estimate.values.tolist()))

    def count(self):
        """Stored numbers: the parameters."""
        return len(self.names)


class Linear(Rival):
    """Linear least squares on windows or states, with a constant and a ridge.

    Columns count by their deviation. `width` is how many samples in the middle of a window are
    used. The ridge, in units of the largest singular value squared, is given or chosen from
    `_RIDGES`, by leaving out one of `blocks` equal parts of the training cases at a time.
    """

    def __init__(self, kind="windows", width=None, ridge=None, blocks=5):
        self.kind, self.width, self.ridge, self.blocks = kind, width, ridge, blocks

    def _fit(self, x, torque):
        samples = x.shape[-1]
        cut = 0 if self.width is None else (samples - self.width) // 2
        self._used = slice(cut, samples - cut)
        x = self._rows(x)
        self.chosen = self._choose(x, torque) if self.ridge is None else self.ridge
        (self.matrix,), self.constant = _ridge(x, torque, [self.chosen])
        self.constant = self.constant[0]

    def _rows(self, x):
        return x[..., self._used].reshape(len(x), -1)

    def _choose(self, x, torque) -> float:
        lost, scale = np.zeros(len(_RIDGES)), torque.std(0)
        for part in np.array_split(np.arange(len(x)), self.blocks):
            matrices, constants = _ridge(np.delete(x, part, 0), np.delete(torque, part, 0), _RIDGES)
            residual = (x[part] @ matrices + constants[:, None] - torque[part]) / scale
            lost += (residual**2).sum((1, 2))
        return _RIDGES[int(lost.argmin())]

    def _torque(self, x):
        return self._rows(x) @ self.matrix + self.constant

    def count(self):
        """Stored numbers: weights of the filters, and constants."""
        return self.matrix.size + self.constant.size


class LinearWithSigns(Linear):
    """The linear filter, with a saturated velocity of each joint beside it; no inertia is known."""

    def __init__(self, saturates: float, ridge: float, degree: int):
        super().__init__(ridge=ridge)
        self.saturates, self.degree = saturates, degree  # rad/s; of the polynomial

    def _rows(self, x):
        speed = x @ derivative_filters(x.shape[-1], self.step, self.degree)[1]
        return np.concatenate([super()._rows(x), np.tanh(speed / self.saturates)], 1)

    def count(self):
        """Stored numbers, with those of the filter for the velocity."""
        return super().count() + self._used.stop  # and the filter for velocity


def _ridge(x, y, penalties) -> tuple[np.ndarray, np.ndarray]:
    """Matrices and constants of ridge regression, one for each penalty; columns scaled alike."""
    middle, spread, offset = x.mean(0), x.std(0), y.mean(0)
    spread = np.where(spread > 0, spread, 1.0)
    u, s, vt = np.linalg.svd((x - middle) / spread, full_matrices=False)
    keep = s > 1e-12 * s[0]
    u, s, vt = u[:, keep], s[keep], vt[keep]
    gains = s / (s**2 + np.multiply.outer(penalties, np.ones_like(s)) * s[0] ** 2)
    matrices = (vt.T / spread[:, None]) @ (gains[..., None] * (u.T @ (y - offset)))
    return matrices, offset - middle @ matrices
