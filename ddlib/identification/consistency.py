"""Parameters that a physical arm can have, nearest to an estimate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares as fit

from ddlib._check import number
from ddlib.identification.regression import FRICTION, RIGID, Estimate


def physically_consistent(estimate: Estimate, margin: float = 1e-3) -> Estimate:
    """The estimate, moved to the nearest parameters that an arm of positive masses can have.

    With ``c`` for the cosine of the elbow angle the mass matrix is ``[[a + 2 b c, d + b c], [d + b
    c, d]]`` and its determinant ``d (a - d) - b^2 c^2``. So it is positive definite at every angle
    just if ``d > 0`` and ``d (a - d) > b^2``, that is, if ``S = [[a - d, b], [b, d]]`` is. Every
    planar two-link arm has that, since ``a - d >= m2 l1^2``, ``d >= m2 lc2^2`` and ``b = m2 l1
    lc2``. Friction must not be negative. Both sets are convex, so the nearest point is unique
    (Sousa & Cortesão 2014; Wensing, Kim & Slotine 2018, for all ten parameters of a link). Near is
    measured by the estimate's covariance: parameters that are known well hardly move.

    Parameters
    ----------
    estimate : Estimate
        From `least_squares` or `instrumental_variables`. The condition on inertias holds if a, b
        and d are all told, that on friction for each one that is told.
    margin : float
        The smallest eigenvalue of ``S`` is at least this share of its trace, 0 to .4.

    Returns
    -------
    Estimate
        The same one if it is consistent. Otherwise a note says what moved, and moved estimates have
        no intervals.

    Examples
    --------
    >>> import numpy as np
    >>> from ddlib.identification import Estimate
    >>> wrong = Estimate(("a", "b", "d"), np.array([1.0, 0.6, 0.3]), 0.1 * np.ones(3), None, 100)
    >>> a, b, d = physically_consistent(wrong).values
    >>> bool(d * (a - d) > b**2)
    True
    """
    margin = number("margin", margin, 0.0, 0.4)
    names, values = estimate.names, np.asarray(estimate.values)
    flat = values.reshape(-1, len(names)).copy()
    spread = estimate.covariance
    if spread is None:
        spread = np.asarray(estimate.errors)[..., None] ** 2 * np.eye(len(names))
    spread = np.broadcast_to(spread, (*values.shape, len(names))).reshape(
        -1, len(names), len(names)
    )
    moved = np.zeros(flat.shape, bool)
    for k, (value, covariance) in enumerate(zip(flat, spread)):
        finite = np.flatnonzero(np.isfinite(value))
        if not finite.size:
            continue
        nearest = _nearest(
            value[finite], covariance[np.ix_(finite, finite)], [names[i] for i in finite], margin
        )
        moved[k, finite] = np.abs(nearest - value[finite]) > 1e-9 * np.abs(value[finite]).max()
        flat[k, finite] = nearest
    if not moved.any():
        return estimate
    shape = values.shape
    unsure = moved.reshape(shape)
    if estimate.unsure is not None:
        unsure = unsure | estimate.unsure
    which = ", ".join(name for name, one in zip(names, moved.any(0)) if one)
    note = f"{which} moved to the nearest parameters that an arm can have."
    notes = (*(n for n in estimate.notes if not n.startswith("No arm")), note)
    return replace(estimate, values=flat.reshape(shape), unsure=unsure, notes=notes)


def _nearest(value, cover, names, margin) -> np.ndarray:
    """The nearest parameters of an arm, in the metric of a covariance; `value` if it is one.

    The matrix S is ``L L'`` and a multiple of the unit matrix, friction a square: every choice of
    these is an arm, so that nothing limits the search.
    """
    rubbing = [i for i, name in enumerate(names) if name in FRICTION]
    rigid = [names.index(name) for name in RIGID] if set(RIGID) <= set(names) else []
    start = value.copy()
    start[rubbing] = np.maximum(value[rubbing], 0.0)
    if rigid:
        a, b, d = value[rigid]
        values, ways = np.linalg.eigh([[a - d, b], [b, d]])
        raised = np.maximum(values, margin * max(values.sum(), values.max(), 0.0))
        if (values < raised).any() or values[0] <= 0:
            raised = np.maximum(raised, 2 * margin * np.abs(values).max() + 1e-9)
            (x, b), (_, d) = (ways * raised) @ ways.T
            start[rigid] = x + d, b, d
    if (start == value).all():
        return value
    whiten = np.linalg.inv(np.linalg.cholesky(cover + 1e-14 * np.diag(np.diag(cover))))

    def arm(free) -> np.ndarray:
        point = free.copy()
        point[rubbing] = free[rubbing] ** 2
        if rigid:
            p, r, s = free[rigid]
            least = margin / (1 - 2 * margin) * (p**2 + r**2 + s**2)
            point[rigid] = p**2 + r**2 + s**2 + 2 * least, p * r, r**2 + s**2 + least
        return point

    best = None
    for nudge in (0.0, 0.3, 1.0):  # where a root is 0 nothing pulls: more than one start
        free = start.copy()
        free[rubbing] = np.sqrt(start[rubbing] + nudge * np.abs(value[rubbing]))
        if rigid:
            a, b, d = start[rigid]
            p = np.sqrt(max(a - d, 0.0) + nudge * abs(a) + 1e-12)
            free[rigid] = p, b / p, np.sqrt(max(d - (b / p) ** 2, 0.0) + nudge * abs(d) + 1e-12)
        solution = fit(
            lambda z: whiten @ (arm(z) - value), free, x_scale="jac", xtol=1e-12, ftol=1e-12,
            gtol=1e-12, max_nfev=100,
        )  # fmt: skip
        best = solution if best is None or solution.cost < best.cost else best
    return arm(best.x)
