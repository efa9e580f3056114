"""Base parameters and friction by linear least squares, with a confidence for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.stats import t as student

from ddlib._check import finite_array, integer, like, number, one_of
from ddlib.dynamics import Arm
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.trajectories import Trajectory

RIGID = ("a", "b", "d")  #: Base parameters of a horizontal two-link arm, kg m^2.
GRAVITY = ("g1", "g2")  #: Gravity moments of a vertical arm, N m.
#: Viscous (N m s/rad) and Coulomb (N m) friction of shoulder and elbow.
FRICTION = ("F_v1", "F_v2", "F_c1", "F_c2")
SIGN_SPEED = 0.005  #: Below this estimated speed (rad/s) the sign of a velocity is blurred.


class Equations(NamedTuple):
    """Linear equations ``torque = regressor @ parameters + noise``, a set for each joint."""

    names: tuple[str, ...]  #: The parameters.
    regressor: tuple[np.ndarray, ...]  #: Each (..., equations, parameters).
    torque: tuple[np.ndarray, ...]  #: Each (..., equations).


@dataclass(frozen=True)
class Estimate:
    """Parameters with their uncertainty; leading axes are repetitions."""

    names: tuple[str, ...]  #: The parameters.
    values: np.ndarray  #: Estimates, (..., parameters).
    errors: np.ndarray  #: Their standard errors.
    noise: np.ndarray  #: Standard deviation of an equation's torque, (..., joint), N m.
    freedom: int  #: Degrees of freedom: equations minus parameters.

    def half_width(self, level: float = 0.95) -> np.ndarray:
        """Half the width of the confidence interval, from Student's distribution."""
        number("level", level, 0.0, 1.0, open_low=True)
        return student.ppf(0.5 + level / 2, self.freedom) * self.errors

    def covers(self, truth, level: float = 0.95) -> np.ndarray:
        """Whether each confidence interval holds the true parameter."""
        truth = finite_array("truth", truth, len(self.names))
        return np.abs(self.values - truth) <= self.half_width(level)


def least_squares(equations: Equations, rounds: int = 4) -> Estimate:
    """Weighted linear least squares: each joint counts by the inverse of its own noise.

    A joint's noise is what its equations leave over. It decides the weights, which decide what is
    left over; a few `rounds` settle both. Leading axes are repetitions, each solved for itself.
    """
    like("equations", equations, "Equations")
    integer("rounds", rounds, 1)
    names, regressors, torques = equations
    counts = [y.shape[-1] for y in torques]
    if sum(counts) <= len(names):
        raise ValueError(
            f"equations must be more than the {len(names)} parameters, got {sum(counts)}"
        )
    a, y = np.concatenate(regressors, -2), np.concatenate(torques, -1)
    joints = [slice(end - n, end) for n, end in zip(counts, np.cumsum(counts))]
    smallest = 1e-12 * np.sqrt(np.mean(y**2, -1, keepdims=True)) + 1e-300
    noise = np.ones((*y.shape[:-1], len(joints)))
    for _ in range(rounds):
        sigma = np.repeat(np.maximum(noise, smallest), counts, axis=-1)
        basis, triangle = np.linalg.qr(a / sigma[..., None])
        size = np.linalg.norm(triangle, axis=-2)
        if not (size > 0).all() or np.linalg.cond(triangle / size[..., None, :]).max() > 1e10:
            raise ValueError(f"equations must determine all of {', '.join(names)}; they do not")
        inverse = np.linalg.inv(triangle)
        projected = np.einsum("...np,...n->...p", basis, y / sigma)
        left = y - np.einsum("...np,...p->...n", basis, projected) * sigma
        noise = np.stack([_spread(left[..., j], basis[..., j, :]) for j in joints], -1)
    values = np.einsum("...pq,...q->...p", inverse, projected)
    freedom = sum(counts) - len(names)
    return Estimate(names, values, np.linalg.norm(inverse, axis=-1), noise, freedom)


def from_states(q, qd, qdd, torque, names: Sequence[str] = RIGID) -> Equations:
    """Equations at known states, one for every sample and joint.

    Angles (rad), velocities, accelerations and torques (N m) are ``(..., samples, 2)``; `names` are
    parameters from `RIGID`, `GRAVITY` and `FRICTION`.
    """
    q, qd, qdd, torque = np.broadcast_arrays(
        *(finite_array(n, x, 2) for n, x in zip(("q", "qd", "qdd", "torque"), (q, qd, qdd, torque)))
    )
    rigid = Arm.regressor(q, qd, qdd)
    sign = np.clip(qd / SIGN_SPEED, -1.0, 1.0)
    regressors = []
    for j in range(2):
        row = dict(zip((*RIGID, *GRAVITY), np.moveaxis(rigid[..., j, :], -1, 0)))
        row |= {f"F_v{j + 1}": qd[..., j], f"F_c{j + 1}": sign[..., j]}
        regressors.append(_columns(row, names, qd[..., j]))
    return Equations(tuple(names), tuple(regressors), (torque[..., 0], torque[..., 1]))


def true_parameters(arm: Arm, effects: Effects, names: Sequence[str]) -> np.ndarray:
    """What an identification should find; of the effects viscous and Coulomb friction are known."""
    _known(names)
    viscous = sum(
        np.asarray(f.coefficient) for f in effects.friction if isinstance(f, ViscousFriction)
    )
    coulomb = sum(np.asarray(f.level) for f in effects.friction if isinstance(f, CoulombFriction))
    pairs = (*arm.gravity_moments, *np.broadcast_to(viscous, 2), *np.broadcast_to(coulomb, 2))
    known = dict(zip((*RIGID, *GRAVITY, *FRICTION), (arm.a, arm.b, arm.d, *pairs)))
    return np.array([known[name] for name in names])


def excitation(trajectory: Trajectory, names: Sequence[str] = RIGID) -> float:
    """Condition number of the regressor along a motion; infinite if a parameter is unseen."""
    equations = from_states(*trajectory, np.zeros(2), names)
    values = np.linalg.svd(
        np.concatenate([a.reshape(-1, len(names)) for a in equations.regressor]), compute_uv=False
    )
    return float(values[0] / values[-1]) if values[-1] > 1e-12 * values[0] else np.inf


def _spread(left, basis) -> np.ndarray:
    """Standard deviation of one joint's residuals; what its equations spent is not counted."""
    free = left.shape[-1] - np.sum(basis**2, (-2, -1))
    return np.sqrt(np.sum(left**2, -1) / np.maximum(free, 1e-9))


def _known(names) -> None:
    """A ValueError for a name of no parameter."""
    for name in names:
        one_of("names", name, (*RIGID, *GRAVITY, *FRICTION))


def _columns(row: dict, names: Sequence[str], like) -> np.ndarray:
    """The regressor (..., parameters) of one joint from columns by name, zeros `like` if unfelt."""
    _known(names)
    return np.stack([row.get(name, np.zeros_like(like)) for name in names], -1)
