"""Levenberg-Marquardt: the optimum of a window network, where the path does not matter.

Each step solves ``(J'J + mu I) step = -gradient`` with J the derivatives of all residuals by all
parameters (Hagan & Menhaj 1994), by default in coordinates in which the inputs are white; the
damping mu follows Nielsen (1999). Near the end all second derivatives take the place of ``J'J``
(Dennis, Gay & Welsch 1981): where residuals remain, ``J'J`` alone converges slowly.
"""

from __future__ import annotations

import warnings
from contextlib import closing
from dataclasses import fields
from functools import partial
from threading import Event
from typing import NamedTuple

import numpy as np
import torch
from tqdm.auto import tqdm

from ddlib._check import cases_of, finite_array, flag, instance, integer, number, shaped
from ddlib.learning._threads import in_threads
from ddlib.learning.descent import WORKERS
from ddlib.learning.gauss_newton import Objective
from ddlib.learning.network import TorqueModel, Weights
from ddlib.learning.training import History, TrainingInterrupted, TrainingSet

_DAMPING = 0.1  # first mu, in units of the largest diagonal element of J'J
_NEAR = 1e-2  # the measure of `tolerance` from which all second derivatives are used


class NotConverged(UserWarning):
    """A network was left before its gradient was small enough."""


class Solution(NamedTuple):
    """What `solve` returns; but for the model, arrays of shape (members,).

    A member has converged if it ended by its "gradient" or at the "target", not if its "steps" ran
    out or there was "no descent": nothing nearby is lower by more than rounding.
    """

    model: TorqueModel  # in the shape of the initial weights
    history: History  # RMSS after each step; a member that has ended keeps its last value
    objective: np.ndarray  # what was minimised, penalty included
    gradient: np.ndarray  # what `tolerance` is compared with, at the end
    steps: np.ndarray  # how many were taken
    ended: np.ndarray  # why

    def __repr__(self) -> str:
        reasons = ", ".join(sorted(set(self.ended)))
        return f"Solution({self.model!r}, {self.steps.max()} steps, ended by {reasons})"

    @property
    def converged(self) -> np.ndarray:
        """Members whose gradient is within the tolerance, or whose RMSS met the target."""
        return np.isin(self.ended, ("gradient", "target"))


def solve(
    weights: Weights,
    data: TrainingSet,
    *,
    test: tuple | None = None,
    decay: float = 0.0,
    steps: int = 300,
    tolerance: float = 1e-6,
    target_rmss: float | None = None,
    whiten: bool = True,
    progress: bool = True,
    label: str = "solving",
) -> Solution:
    """Minimise the error of networks by Levenberg-Marquardt; `NotConverged` is a warning.

    The objective is half the summed squared error of all cases and outputs, plus ``decay / 2``
    times the sum of the squared weights; biases are free. Without decay some directions of the
    weights hardly matter, and hundreds of steps may not reach the end.

    Parameters
    ----------
    weights : Weights
        Initial weights of one network or, with a leading axis, of an ensemble.
    data, test, progress, label
        As in `ddlib.learning.train_ensemble`.
    decay : float
        Strength of the penalty, 0 or more.
    steps : int
        Largest number of steps of each member.
    tolerance : float
        Largest cosine, at the end, between the residuals, penalty included, and a column of J.
    target_rmss : float, optional
        Training RMSS at which a member may stop.
    whiten : bool
        What the damping holds back. If true, each direction of the windows is measured by how much
        they vary along it: one along which they hardly vary is learnt as fast as any other, and a
        step without decay does not see a linear change of the inputs. If false, it is the weights
        as they are, and such a direction takes small steps until the damping has fallen. The
        objective is the same in both, the way to its minimum is not.

    Raises
    ------
    TypeError
        If `whiten` is neither True nor False.
    TrainingInterrupted
        On Ctrl-C or the kernel's stop, within one step; it holds the networks as they are then.
    """
    instance("weights", weights, Weights)
    instance("data", data, TrainingSet)
    flag("progress", progress)
    cases_of("test", test)
    flag("whiten", whiten)
    _check(weights, data, test)
    integer("steps", steps, 1)
    number("tolerance", tolerance, 0.0, 1.0)
    number("decay", decay, 0.0)
    if target_rmss is not None:
        number("target_rmss", target_rmss, 0.0)
    single = weights.hidden_bias.ndim == 1
    members = [weights] if single else [weights[k] for k in range(len(weights))]
    bar = tqdm(total=steps * len(members), desc=label, disable=not progress, mininterval=0.5)
    stop = Event()

    def tell(count: int, error: float) -> None:
        with bar.get_lock():
            bar.set_postfix(rmss=f"{error:.3f}", refresh=False)
            bar.update(count)

    def work(member: Weights):
        if stop.is_set():
            return member, _End(None, [(np.nan, np.nan)], np.nan, np.nan, "interrupted")
        objective = Objective(member, data, decay, test, whiten)
        start = objective.pack(member)
        end = _descend(objective, start, steps, tolerance, target_rmss, tell, stop)
        tell(steps + 1 - len(end.path), end.path[-1][0])
        return objective.unpack(end.vector), end

    with closing(bar):
        parts, interrupted = in_threads(work, members, WORKERS, stop)
    solved, ends = zip(*parts)
    solution = Solution(
        TorqueModel(
            solved[0] if single else Weights.stack(solved), data.inputs, data.outputs, data.step
        ),
        _history([end.path for end in ends], test is not None),
        np.array([end.objective for end in ends]),
        np.array([end.gradient for end in ends]),
        np.array([len(end.path) - 1 for end in ends]),
        np.array([end.reason for end in ends]),
    )
    if interrupted:
        raise TrainingInterrupted(solution.model, solution.history, solution.steps, steps)
    left = np.flatnonzero(~solution.converged)
    if len(left):
        warnings.warn(
            f"{len(left)} of {len(members)} networks have not converged (ended by "
            f"{', '.join(sorted(set(solution.ended[left])))}): the gradient's measure is "
            f"up to {solution.gradient[left].max():.1e}, the tolerance {tolerance:g}",
            NotConverged,
            stacklevel=2,
        )
    return solution


class _End(NamedTuple):
    """Where the search for one member ended."""

    vector: torch.Tensor
    path: list  # training and test RMSS at the start and after each step
    objective: float
    gradient: float
    reason: str


def _descend(objective, vector, steps, tolerance, target, tell, stop) -> _End:
    """Minimise one member's objective from `vector`; `tell` hears of each step."""
    value, error = objective.value(vector)
    if not (np.isfinite(value) and torch.isfinite(vector).all()):
        raise ValueError(f"weights must be small enough to add up, got {vector.abs().max():g}")
    path, mu, exact = [(error, objective.test_rmss(vector))], None, False
    while True:
        matrix, gradient, lengths = objective.normal(vector, exact)
        cosine = gradient.abs() / ((2 * value) ** 0.5 * lengths).clamp_min(1e-300)
        measure = float(cosine.max()) if lengths.any() else np.inf  # inf: saturated
        ended = partial(_End, vector, path, value, measure)
        if measure <= tolerance:
            return ended("gradient")
        if target is not None and error <= target:
            return ended("target")
        if len(path) > steps:
            return ended("steps")
        if stop.is_set():
            return ended("interrupted")
        mu = _DAMPING * float(matrix.diagonal().max()) if mu is None else mu
        step = _step(objective, vector, value, matrix, gradient, mu, exact)
        if exact and step is None:
            matrix = objective.normal(vector)[0]
            step = _step(objective, vector, value, matrix, gradient, mu, False)
        if step is None:
            return ended("no descent")
        vector, value, error, mu = step
        exact = measure < _NEAR
        path.append((error, objective.test_rmss(vector)))
        tell(1, error)


def _step(objective, vector, value, matrix, gradient, mu, exact):
    """The next vector, its objective, RMSS and mu (Nielsen 1999); None if nothing is lower."""
    growth, smallest = 2.0, 1e-12 * float(matrix.diagonal().max())
    while np.isfinite(mu):
        damped = matrix.clone()
        damped.diagonal().add_(mu)
        lower, failed = torch.linalg.cholesky_ex(damped)
        if failed and exact:
            return None
        if not failed:
            step = -torch.cholesky_solve(gradient[:, None], lower)[:, 0]
            predicted = 0.5 * float(step @ (mu * step - gradient))
            if not predicted > 1e-15 * value:
                return None
            trial, error = objective.value(vector + step)
            ratio = (value - trial) / predicted
            if ratio > 1e-4:
                return vector + step, trial, error, mu * max(1 / 3, 1 - (2 * ratio - 1) ** 3)
        mu, growth = max(mu * growth, smallest), 2 * growth
    return None


def _check(weights, data, test) -> None:
    for field in fields(weights):
        finite_array(f"weights.{field.name}", getattr(weights, field.name))
    if weights.hidden_bias.ndim > 2 or weights.hidden_bias.size == 0:
        raise ValueError(
            "weights must be of one network, or of an ensemble along one axis, "
            f"got hidden_bias of shape {weights.hidden_bias.shape}"
        )
    window, outputs = weights.hidden_weights.shape[-2:], weights.output_bias.shape[-1]
    for name, pair in {"data": (data.x, data.y), "test": test}.items():
        if pair is None:
            continue
        x = shaped(f"x of {name}", pair[0], f"(cases, {window[0]}, {window[1]})")
        y = shaped(f"y of {name}", pair[1], (len(x), outputs))
        if len(y) < 2 or (np.ptp(y, axis=0) == 0).any():
            raise ValueError(f"y of {name} must vary in each column, got {y[:1]} throughout")


def _history(paths, tested: bool) -> History:
    """All members' errors; those that ended early keep their last ones."""
    length = max(map(len, paths))
    padded = np.array([path + path[-1:] * (length - len(path)) for path in paths])
    training, test = padded.transpose(2, 1, 0)
    return History(np.arange(length), training, test if tested else np.zeros((0, 0)))
