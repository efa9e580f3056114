"""Base parameters and friction by linear least squares, with a confidence for each."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh, null_space
from scipy.stats import t as student

from ddlib._check import finite_array, instance, integer, number, one_of, series, triple
from ddlib.dynamics import Arm
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.trajectories import Trajectory

RIGID = ("a", "b", "d")  #: Base parameters of a horizontal two-link arm, kg m^2.
GRAVITY = ("g1", "g2")  #: Gravity moments of a vertical arm, N m.
#: Viscous (N m s/rad) and Coulomb (N m) friction of shoulder and elbow.
FRICTION = ("F_v1", "F_v2", "F_c1", "F_c2")
OFFSETS = ("offset1", "offset2")  #: Constant torques that are logged, but do not act, N m.
SLOW = 0.1  #: Below this speed (rad/s) the sign of a joint's friction is not trusted.
SIGN_SPEED = 0.005  #: Below this estimated speed (rad/s) the sign of a velocity is blurred.


_TIMES = 3.0  # what a seen direction's energy is of what noise in the motion gives it
_ROUNDING = 1e-10  # of a column's size: what is smaller is rounding
_SQUARED = 1e-14  # of a column's energy: what is smaller is rounding of its squares
_ALIKE = 3.5  # deviations: what neighbouring residuals of noise hardly have in common
_TOUCHED = 0.01  # of a unit direction: parameters that it touches less are told all the same


class ImpossibleArm(UserWarning):
    """No arm has the inertias that an estimate finds."""


class Equations(NamedTuple):
    """Linear equations ``torque = regressor @ parameters + noise``, a set for each joint."""

    names: tuple[str, ...]  #: The parameters.
    regressor: tuple[np.ndarray, ...]  #: Each (..., equations, parameters).
    torque: tuple[np.ndarray, ...]  #: Each (..., equations).
    #: For each joint ``E' E`` of the errors ``E`` that noise in the motion makes in the regressor,
    #: (parameters, parameters); none: the motion is known exactly.
    blur: tuple[np.ndarray, ...] | None = None
    biased: str = ""  #: Why their estimates have no interval, if they have none.
    notes: tuple[str, ...] = ()  #: Sentences on what was left out, which go into an estimate.


class Combination(NamedTuple):
    """A sum of parameters that a recording tells though it does not tell each of them."""

    names: tuple[str, ...]  #: All parameters.
    factors: np.ndarray  #: What each counts in the sum, (parameters,).
    value: np.ndarray  #: The sum, (...).
    error: np.ndarray  #: Its standard error, of what scatters.
    #: Half the width of its 95 % interval; NaN where noise in the motion leaves none.
    half_width: np.ndarray | float = np.nan

    def __str__(self):
        terms = [(f, n) for f, n in zip(self.factors, self.names) if f]
        text = " ".join(
            f"{'-' if f < 0 else '+'} {abs(f):.3g} {n}".replace(" 1 ", " ") for f, n in terms
        )
        text = text.removeprefix("+ ")
        if np.ndim(self.value):
            return text
        width = "" if np.isnan(self.half_width) else f" ± {self.half_width:.2g}"
        return f"{text} = {self.value:.4g}{width}"


@dataclass(frozen=True, repr=False)
class Estimate:
    """Parameters with their uncertainty; leading axes are repetitions.

    A parameter that the recording cannot tell is NaN, and `told` says so. The sums of such
    parameters that it does tell are in `combinations`.
    """

    names: tuple[str, ...]  #: The parameters.
    values: np.ndarray  #: Estimates, (..., parameters).
    errors: np.ndarray  #: Their standard errors, of what scatters: a bias is not in them.
    noise: np.ndarray  #: Standard deviation of an equation's torque, (..., joint), N m.
    freedom: int  #: Equations less what the parameters spend, of the joint that has fewest left.
    told: np.ndarray | None = None  #: Which parameters can be told, (parameters,); none: all.
    combinations: tuple[Combination, ...] = ()  #: What is told of those that cannot.
    covariance: np.ndarray | None = None  #: Of the estimates, (..., parameters, parameters).
    unsure: np.ndarray | None = None  #: Where a bias leaves no interval, (..., parameters).
    notes: tuple[str, ...] = ()  #: Sentences: what was left out, what is impossible.

    def half_width(self, level: float = 0.95) -> np.ndarray:
        """Half the width of the confidence interval, from Student's distribution.

        NaN where no interval is given: the parameter is not told, or its bias from noise in the
        motion would be more than half of its standard error.
        """
        number("level", level, 0.0, 1.0, open_low=True)
        half = student.ppf(0.5 + level / 2, self.freedom) * self.errors
        return half if self.unsure is None else np.where(self.unsure, np.nan, half)

    def covers(self, truth, level: float = 0.95) -> np.ndarray:
        """Whether each confidence interval holds the true parameter; False if there is none."""
        truth = finite_array("truth", truth, len(self.names))
        return np.abs(self.values - truth) <= self.half_width(level)

    def __repr__(self):
        if self.values.ndim > 1:
            text = f"Estimate({', '.join(self.names)}; {self.values.shape[:-1]} repetitions)"
        else:
            rows = zip(self.names, self.values, self.half_width())
            text = "\n".join(
                f"{name:>4} = "
                + ("cannot be told" if np.isnan(v) else f"{v:.4g}")
                + ("" if np.isnan(half) else f" ± {half:.2g}")
                for name, v, half in rows
            )
        return "\n".join([text, *map(str, self.combinations), *self.notes])


def least_squares(equations: Equations, rounds: int = 4) -> Estimate:
    """Weighted linear least squares: each joint counts by the inverse of its own noise.

    A joint's noise is what its equations leave over. It decides the weights, which decide what is
    left over; a few `rounds` settle both. Leading axes are repetitions, each solved for itself.

    A direction among the parameters counts as seen if its columns have three times the energy that
    noise in the motion alone gives them (`Equations.blur`), and if its standard error, as torque,
    is less than all of the measured torque. Parameters that unseen directions touch are NaN; sums
    of them that can be told are `Estimate.combinations`. A joint whose torque is zero throughout
    is left out, as is one with too few equations: either would be solved exactly, and count
    without limit.

    Intervals count noise that each equation has anew. `Estimate.notes` say where neighbours leave
    what is alike, as they do if an effect has no term or a torque is logged late. Small such
    errors go into the parameters without a trace.

    Noise in the motion makes estimates too small. The mean of that, to first order, is the inverse
    of the normal equations' matrix times the blur's times the estimates (Fuller 1987); where it
    exceeds half of a standard error there is no interval.

    Warns
    -----
    ImpossibleArm
        If no arm has the inertias: its mass matrix would not be positive at every elbow angle.

    Raises
    ------
    ValueError
        If there are no more equations than parameters, nothing can be told, or an entry is masked,
        NaN or infinite.
    """
    instance("equations", equations, Equations)
    integer("rounds", rounds, 1)
    for a, y in zip(equations.regressor, equations.torque):
        finite_array("equations.regressor", a, len(equations.names))
        finite_array("equations.torque", y)
    estimate = estimated(equations, rounds)
    for note in _impossible(estimate):
        warnings.warn(note, ImpossibleArm, stacklevel=2)
    return estimate


def estimated(equations: Equations, rounds: int = 4) -> Estimate:
    """`least_squares` of equations that were checked, without a warning."""
    names, equation_count = equations.names, sum(y.shape[-1] for y in equations.torque)
    if equation_count <= len(names):
        slow = not equation_count and any(name.startswith("F_c") for name in names)
        why = f": dry friction asks for a joint that moves on at {SLOW} rad/s or more"
        raise ValueError(
            f"equations must be more than the {len(names)} parameters, got {equation_count}"
            f"{why if slow else ''}"
        )
    equations, notes = _driven(equations)
    notes = [*equations.notes, *notes]
    names, regressors, torques = equations[:3]
    unseen = _unseen(equations)
    if not unseen.shape[1]:
        estimate = _solved(names, regressors, torques, rounds)
        unsure = _biased(equations, estimate, np.eye(len(names)))
        notes = (*notes, *_impossible(estimate), *_alike(equations, regressors, estimate))
        return replace(estimate, unsure=unsure, notes=notes)
    if unseen.shape[1] == len(names):
        raise ValueError(f"equations must determine some of {', '.join(names)}; they do not")
    return _partly(equations, unseen, rounds, notes)


def _solved(names, regressors, torques, rounds) -> Estimate:
    counts = [y.shape[-1] for y in torques]
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
        residual = y - np.einsum("...np,...p->...n", basis, projected) * sigma
        free = np.stack([_free(basis[..., j, :]) for j in joints], -1)
        squares = np.stack([np.sum(residual[..., j] ** 2, -1) for j in joints], -1)
        noise = np.sqrt(squares / np.maximum(free, 1e-9))
    values = np.einsum("...pq,...q->...p", inverse, projected)
    # each joint's noise is known from its own equations
    freedom = max(1, int(np.min(free[..., np.array(counts) > 0])))
    errors = np.linalg.norm(inverse, axis=-1)
    covariance = inverse @ np.swapaxes(inverse, -1, -2)
    return Estimate(names, values, errors, noise, freedom, covariance=covariance)


def _driven(equations) -> tuple[Equations, list[str]]:
    """The equations without those of joints that cannot say how noisy they are, and words on it.

    Those are joints whose torque is zero throughout, and joints with no more equations than
    parameters in them, if others have more: both would be solved exactly and count infinitely.
    """
    pairs = list(zip(equations.regressor, equations.torque))
    idle = [j for j, (_, y) in enumerate(pairs) if y.size and not y.any()]
    felt = [np.count_nonzero(a.any(tuple(range(a.ndim - 1)))) for a, _ in pairs]
    few = [j for j, (_, y) in enumerate(pairs) if y.size and y.shape[-1] <= felt[j]]
    few = [j for j in few if j not in idle]
    used = [j for j, (_, y) in enumerate(pairs) if y.size]
    if used and set(idle) == set(used):
        raise ValueError("equations must have a torque, got zeros throughout")
    few = [] if set(few) | set(idle) == set(used) else few
    notes = [f"Joint {j + 1} has no torque; its equations were left out." for j in idle]
    notes += [f"Joint {j + 1} has too few equations; they were left out." for j in few]
    if not notes:
        return equations, []
    out, blur = {*idle, *few}, equations.blur
    regressors = tuple(a[..., :0, :] if j in out else a for j, (a, _) in enumerate(pairs))
    torques = tuple(y[..., :0] if j in out else y for j, (_, y) in enumerate(pairs))
    if blur is not None:
        blur = tuple(0 * x if j in out else x for j, x in enumerate(blur))
    return equations._replace(regressor=regressors, torque=torques, blur=blur), notes


def _information(equations, joints=None):
    """Normal matrices of the regressor and of its errors, and the torque's energy, over noise.

    Means over repetitions; each joint's noise is what its own equations leave over, and all of its
    torque if they are too few to leave anything.
    """
    parameters = len(equations.names)
    seen, blurred, energy = (
        np.zeros((parameters, parameters)),
        np.zeros((parameters, parameters)),
        0.0,
    )
    for j, (a, y) in enumerate(zip(equations.regressor, equations.torque)):
        if (joints is not None and j not in joints) or not y.size:
            continue
        a, y = a.reshape(-1, *a.shape[-2:]), y.reshape(-1, y.shape[-1])
        basis, values, _ = np.linalg.svd(a, full_matrices=False)
        spanned = basis * (values > 1e-10 * values.max(-1, keepdims=True))[:, None, :]
        residual = y - (spanned @ (np.swapaxes(spanned, -1, -2) @ y[..., None]))[..., 0]
        power = np.mean(y**2)
        free = y.shape[-1] - parameters
        variance = (
            max(np.sum(residual**2) / (len(residual) * free), 1e-20 * power) if free > 0 else power
        )
        if variance == 0:
            continue
        seen += np.mean(np.swapaxes(a, -1, -2) @ a, 0) / variance
        energy += np.mean(np.sum(y**2, -1)) / variance
        if equations.blur is not None:
            blurred += equations.blur[j] / variance
    return seen, blurred, energy


def _unseen(equations, joints=None, like=None) -> np.ndarray:
    """Directions of parameters, each times its column's size, that leave no trace: columns.

    Sizes are those of all joints' columns, or as in `like`.
    """
    seen, blurred, energy = _information(equations, joints)
    size = np.sqrt(np.diag(seen))
    felt = np.diag(seen) > _TIMES * np.diag(blurred)
    nothing = np.eye(len(size))[:, ~felt]
    if not felt.any():
        return nothing
    scale = np.outer(size[felt], size[felt])
    seen, blurred = seen[np.ix_(felt, felt)] / scale, blurred[np.ix_(felt, felt)] / scale
    floor = _ROUNDING**2 + 1e-10 * np.trace(blurred)
    values, ways = eigh(seen, blurred + floor * np.eye(len(seen)))
    ways = ways[:, values < _TIMES]
    rest = null_space(ways.T) if ways.size else np.eye(len(seen))
    if rest.size:
        strength, turned = np.linalg.eigh(rest.T @ seen @ rest)
        least = max(1 / max(energy, 1e-300), _SQUARED)
        ways = np.hstack([ways, rest @ turned[:, strength < least]])
    directions = np.zeros((len(size), ways.shape[1]))
    directions[felt] = ways if like is None else ways * (like[felt] / size[felt])[:, None]
    return np.hstack([nothing, np.linalg.qr(directions)[0]]) if ways.size else nothing


def _biased(equations, estimate, ways) -> np.ndarray | None:
    """Where noise in the motion moves sums of parameters by more than half a standard error."""
    if equations.biased:
        return np.ones(estimate.values.shape, bool)
    if equations.blur is None:
        return None
    weights = np.maximum(estimate.noise, 1e-100) ** -2.0
    blur = np.tensordot(weights, np.stack(equations.blur), 1)
    bias = estimate.covariance @ (ways.T @ blur @ ways) @ estimate.values[..., None]
    return np.abs(bias[..., 0]) > 0.5 * estimate.errors


def _partly(equations, unseen, rounds, notes) -> Estimate:
    """What can be told if some directions are unseen."""
    names, regressors, torques = equations[:3]
    size = np.sqrt(np.diag(_information(equations)[0]))
    size = np.where(size > 0, size, 1.0)
    ways = null_space(unseen.T) / size[:, None]
    inner = _solved(names[: ways.shape[1]], [a @ ways for a in regressors], torques, rounds)
    blurred = _biased(equations, replace(inner, names=names), ways)
    determined = np.linalg.norm(unseen, axis=1) < _TOUCHED
    free = null_space(unseen.T)  # sums in units of column sizes that can be told

    def summed(factors):
        through = factors @ ways
        value = inner.values @ through
        spread = np.einsum("p,...pq,q->...", through, inner.covariance, through)
        return value, np.sqrt(np.maximum(spread, 0))

    shape = (*inner.values.shape[:-1], len(names))
    values, errors = np.full(shape, np.nan), np.full(shape, np.nan)
    for k in np.flatnonzero(determined):
        factors = (free @ free[k]) * size / size[k] / (free[k] @ free[k])
        values[..., k], errors[..., k] = summed(size[k] * factors / size[k])
    sums = []
    for factors in _sums(equations, unseen, determined, size):
        value, error = summed(factors)
        tidy = np.where(np.abs(factors) * size.min() > 0, factors, 0.0)
        half = student.ppf(0.975, inner.freedom) * error
        if blurred is not None:
            half = np.where(blurred.any(-1), np.nan, half)
        sums.append(Combination(tuple(names), tidy, value, error, half))
    missing = ", ".join(n for n, k in zip(names, determined) if not k)
    notes = [*notes, f"{missing} cannot be told from this recording."]
    notes += _alike(equations, [a @ ways for a in regressors], inner)
    unsure = None
    if blurred is not None:
        unsure = np.broadcast_to(blurred.any(-1, keepdims=True), shape)
    return Estimate(
        tuple(names), values, errors, inner.noise, inner.freedom, determined, tuple(sums), None,
        unsure, tuple(notes),
    )  # fmt: skip


def _sums(equations, unseen, determined, size) -> list[np.ndarray]:
    """Independent sums of untold parameters that can be told: those of single joints first."""
    spaces = [_unseen(equations, [j], size) for j in range(len(equations.torque))]
    independent, wanted = [], len(size) - unseen.shape[1] - determined.sum()
    for space in (*spaces, unseen):
        rows = null_space(space.T).T * ~determined
        for row in _reduced(rows):
            row = row * (np.abs(row) > _TOUCHED * np.abs(row).max())
            tried = np.array([*independent, row])
            fits = np.linalg.norm(row @ unseen) < 0.1 * np.linalg.norm(row)
            if (
                len(independent) < wanted
                and fits
                and np.linalg.matrix_rank(tried, tol=0.05) > len(independent)
            ):
                independent.append(row / np.linalg.norm(row))
    sums = [row * size for row in independent]
    return [row / row[np.flatnonzero(row)[0]] for row in sums]


def _reduced(rows) -> list[np.ndarray]:
    """Rows of the reduced echelon form (Gauss & Jordan)."""
    rows, done = rows.copy(), []
    for k in range(rows.shape[1]):
        if not len(rows):
            break
        best = int(np.abs(rows[:, k]).argmax())
        if abs(rows[best, k]) < 0.05:
            continue
        pivot = rows[best] / rows[best, k]
        rows = np.delete(rows - np.outer(rows[:, k], pivot), best, 0)
        done = [row - row[k] * pivot for row in done] + [pivot]
    return done


def _impossible(estimate) -> list[str]:
    """A word if no arm has these parameters."""
    if estimate.values.ndim > 1 or not set(RIGID) <= set(estimate.names):
        return []
    a, b, d = (estimate.values[estimate.names.index(name)] for name in RIGID)
    if d > 0 and d * (a - d) > b**2:
        return []
    return [
        "No arm has these inertias: its mass matrix would not be positive at every elbow angle."
    ]


def _alike(equations, regressors, estimate) -> list[str]:
    """A word on joints whose averaged equations leave more than noise: neighbours are alike."""
    if estimate.values.ndim > 1 or equations.blur is None:
        return []
    shares, deviations = [], []
    for a, y in zip(regressors, equations.torque):
        residual = y - a @ estimate.values
        shares.append(residual[1:] @ residual[:-1] / max(residual @ residual, 1e-300))
        deviations.append(shares[-1] * np.sqrt(residual.size))
    most = max(*deviations, sum(deviations) / np.sqrt(len(deviations)))
    return [
        f"What is left of joint {j + 1}'s torque is no noise, as neighbours are alike "
        f"(correlation {share:.2f}): an effect has no term, or the torque is logged early "
        "or late. The intervals are too narrow."
        for j, (share, deviation) in enumerate(zip(shares, deviations))
        if most > _ALIKE and deviation > _ALIKE / 2
    ]


def from_states(q, qd, qdd, torque, names: Sequence[str] = RIGID) -> Equations:
    """Equations at known states, one for every sample and joint.

    Angles (rad), velocities, accelerations and torques (N m) are ``(..., samples, 2)``; `names` are
    parameters from `RIGID`, `GRAVITY`, `FRICTION` and `OFFSETS`.
    """
    known_names(names)
    q, qd, qdd, torque = np.broadcast_arrays(
        *(finite_array(n, x, 2) for n, x in zip(("q", "qd", "qdd", "torque"), (q, qd, qdd, torque)))
    )
    rigid = Arm.regressor(q, qd, qdd)
    sign = np.clip(qd / SIGN_SPEED, -1.0, 1.0)
    regressors = []
    for j in range(2):
        row = dict(zip((*RIGID, *GRAVITY), np.moveaxis(rigid[..., j, :], -1, 0)))
        row |= {f"F_v{j + 1}": qd[..., j], f"F_c{j + 1}": sign[..., j]}
        row[f"offset{j + 1}"] = np.ones_like(sign[..., j])
        regressors.append(regressor_columns(row, names, qd[..., j]))
    return Equations(tuple(names), tuple(regressors), (torque[..., 0], torque[..., 1]))


def true_parameters(arm: Arm, effects: Effects, names: Sequence[str]) -> np.ndarray:
    """What an identification should find; of the effects viscous and Coulomb friction are known.

    Logged torques are taken to be right: offsets are 0.
    """
    instance("arm", arm, Arm)
    instance("effects", effects, Effects)
    known_names(names)
    viscous = sum(
        np.asarray(f.coefficient) for f in effects.friction if isinstance(f, ViscousFriction)
    )
    coulomb = sum(np.asarray(f.level) for f in effects.friction if isinstance(f, CoulombFriction))
    pairs = (*arm.gravity_moments, *np.broadcast_to(viscous, 2), *np.broadcast_to(coulomb, 2))
    known = dict(
        zip((*RIGID, *GRAVITY, *FRICTION, *OFFSETS), (arm.a, arm.b, arm.d, *pairs, 0.0, 0.0))
    )
    return np.array([known[name] for name in names])


def excitation(trajectory: Trajectory, names: Sequence[str] = RIGID, noise: float = 0.0) -> float:
    """Condition number of the regressor along a motion; infinite if a parameter is unseen.

    With `noise`, the standard deviation of accelerations (rad/s^2), a direction of parameters is
    unseen if it has less than three times the energy that this noise alone gives it.
    """
    triple("trajectory", trajectory)
    number("noise", noise, 0.0)
    equations = from_states(*trajectory, np.zeros(2), names)
    rows = np.concatenate([a.reshape(-1, len(names)) for a in equations.regressor])
    values = np.linalg.svd(rows, compute_uv=False)
    if values[-1] <= 1e-12 * values[0]:
        return np.inf
    if noise:
        rng = np.random.default_rng(0)
        q, qd, qdd = trajectory
        shaken = from_states(
            q, qd, qdd + noise * rng.normal(size=np.shape(qdd)), np.zeros(2), names
        )
        shaken = np.concatenate([a.reshape(-1, len(names)) for a in shaken.regressor]) - rows
        blur = shaken.T @ shaken
        floor = 1e-10 * np.trace(blur) * np.eye(len(blur))
        if eigh(rows.T @ rows, blur + floor, eigvals_only=True)[0] < _TIMES:
            return np.inf
    return float(values[0] / values[-1])


def _free(basis) -> np.ndarray:
    """Equations of one joint less what the fit spends of them."""
    return basis.shape[-2] - np.sum(basis**2, (-2, -1))


def known_names(names, called: str = "names") -> None:
    """Refuse what are no names of parameters."""
    if not series(called, names, str):
        raise ValueError(f"{called} must be one or more, got none")
    for name in names:
        one_of(called, name, (*RIGID, *GRAVITY, *FRICTION, *OFFSETS))


def regressor_columns(row: dict, names: Sequence[str], like) -> np.ndarray:
    """The regressor (..., parameters) of one joint from columns by name, zeros `like` if unfelt."""
    return np.stack([row.get(name, np.zeros_like(like)) for name in names], -1)
