"""Levenberg-Marquardt against autograd, scipy and the conditions of an optimum."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.optimize import minimize
from small_networks import WIDTH, parts, smooth_cases

from ddlib.learning import (
    NotConverged,
    TrainingSet,
    Weights,
    solve,
)
from ddlib.learning.gauss_newton import Objective
from ddlib.learning.network import WEIGHT_NAMES
from ddlib.metrics import rmss

HIDDEN = 3


@pytest.fixture(scope="module")
def start():
    return Weights.random(3, WIDTH, HIDDEN)


def flat(weights) -> np.ndarray:
    return np.concatenate([part.ravel() for part in parts(weights)])


def shaped(vector, like) -> list[torch.Tensor]:
    sizes = [getattr(like, name).size for name in WEIGHT_NAMES]
    parts = torch.split(torch.as_tensor(vector, dtype=torch.float64), sizes)
    return [part.reshape(getattr(like, name).shape) for part, name in zip(parts, WEIGHT_NAMES)]


def unflat(vector, like) -> Weights:
    return Weights(*(part.numpy() for part in shaped(vector, like)))


def residuals(vector, like, data, decay=0.0):
    """Errors and penalties as one list, written out unit by unit for autograd."""
    a, b, c, d, e = shaped(vector, like)
    x, y = torch.as_tensor(data.x), torch.as_tensor(data.y)
    hidden = torch.sigmoid(torch.einsum("nji,hji->nh", x, a) + b)
    output = torch.sigmoid(torch.einsum("nji,oji->no", x, d) + hidden @ c.T + e)
    penalties = [decay**0.5 * w.flatten() for w in (a, c, d)]
    return torch.cat([(output - y).flatten(), *penalties])


def jacobian(vector, *args) -> np.ndarray:
    vector = torch.as_tensor(vector, dtype=torch.float64)
    function = lambda v: residuals(v, *args)  # noqa: E731
    return torch.autograd.functional.jacobian(function, vector, vectorize=True).numpy()


def hessian(vector, *args) -> np.ndarray:
    vector = torch.as_tensor(vector, dtype=torch.float64)
    half = lambda v: 0.5 * residuals(v, *args).square().sum()  # noqa: E731
    return torch.autograd.functional.hessian(half, vector, vectorize=True).numpy()


def by_hand(weights, data, decay) -> tuple[float, np.ndarray]:
    """Objective and its gradient by the weights."""
    vector = flat(weights)
    r = residuals(vector, weights, data, decay).numpy()
    return 0.5 * float(r @ r), jacobian(vector, weights, data, decay).T @ r


def quietly(*args, **options):
    """`solve` where it is not meant to converge."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotConverged)
        return solve(*args, progress=False, **options)


@pytest.mark.parametrize("whiten", [True, False])
@pytest.mark.parametrize("hidden, outputs, decay", [(1, 1, 0.0), (5, 4, 1e-3)])
def test_value_gradient_and_matrix_are_those_of_autograd(hidden, outputs, decay, whiten):
    windows, torque = smooth_cases(40, noise=0.01)
    mixed = np.random.default_rng(0).normal(size=(2, outputs))
    data = TrainingSet.from_arrays(windows, torque @ mixed)
    w = Weights.random(1, WIDTH, hidden, 2, outputs, initial=1.0, seed=hidden)[0]
    objective = Objective(w, data, decay, whiten=whiten)
    vector, rest = objective.pack(w), (w, data, decay)
    value, gradient = by_hand(*rest)
    j, bent = jacobian(flat(w), *rest), hessian(flat(w), *rest)
    assert objective.value(vector)[0] == pytest.approx(value, rel=1e-12)
    assert objective.value(vector)[1] == pytest.approx(rmss(w.activity(data.x)[1], data.y))
    units = [objective.pack(unflat(unit, w)).numpy() for unit in np.eye(j.shape[1])]
    to_vector = np.column_stack(units)
    to_weights = np.linalg.inv(to_vector)
    assert np.allclose(to_vector @ to_vector.T, np.eye(len(to_vector))) != whiten
    for _ in range(2):  # the second time what is kept of the first is used
        for exact, expected in ((False, j.T @ j), (True, bent)):
            lower, slopes, lengths = (x.numpy() for x in objective.normal(vector, exact))
            matrix = np.tril(lower) + np.tril(lower, -1).T
            np.testing.assert_allclose(to_vector.T @ slopes, gradient, atol=1e-11)
            np.testing.assert_allclose(to_vector.T @ matrix @ to_vector, expected, atol=1e-10)
            wanted = np.linalg.norm(j @ to_weights, axis=0)
            np.testing.assert_allclose(lengths, wanted, rtol=1e-9)


def test_at_the_end_the_gradient_is_zero(data, start):
    decay = 1e-3
    solution = solve(start, data, decay=decay, steps=1000, progress=False)
    assert solution.converged.all() and (solution.ended == "gradient").all()
    assert (solution.gradient <= 1e-6).all()
    for k in range(len(start)):
        value, gradient = by_hand(solution.model.weights[k], data, decay)
        before = by_hand(start[k], data, decay)
        assert solution.objective[k] == pytest.approx(value, rel=1e-9)
        assert value < before[0]
        assert np.abs(gradient).max() < 1e-5 * np.abs(before[1]).max()


@pytest.mark.parametrize("whiten", [True, False])
def test_scipy_finds_the_same_optimum(data, whiten):
    """By a trust region with autograd's Hessian, from each of three starts."""
    starts = Weights.random(3, WIDTH, 1)
    ours = solve(starts, data, decay=0.05, whiten=whiten, progress=False)
    for k in range(len(starts)):
        rest = (starts[k], data, 0.05)
        theirs = minimize(
            lambda v, rest=rest: by_hand(unflat(v, rest[0]), *rest[1:]),
            flat(starts[k]),
            jac=True,
            hess=lambda v, rest=rest: hessian(v, *rest),
            method="trust-exact",
        )
        assert ours.objective[k] == pytest.approx(theirs.fun, rel=1e-8)
        np.testing.assert_allclose(
            ours.model.weights[k].activity(data.x)[1],
            unflat(theirs.x, starts[k]).activity(data.x)[1],
            atol=1e-4,
        )


def test_an_ensemble_is_its_members(data, other, start):
    options = dict(decay=0.01, test=other, steps=40)
    together = quietly(start, data, **options)
    for k in range(len(start)):
        alone = quietly(start[k], data, **options)
        assert alone.model.weights.hidden_bias.shape == (HIDDEN,)
        assert alone.ended[0] == together.ended[k]
        np.testing.assert_array_equal(flat(alone.model.weights), flat(together.model.weights[k]))
        steps = alone.steps[0]
        assert together.steps[k] == steps
        for name in ("training", "test"):
            path = getattr(together.history, name)[:, k]
            np.testing.assert_array_equal(path[: steps + 1], getattr(alone.history, name)[:, 0])
            assert (path[steps:] == path[steps]).all()


def test_who_has_not_converged_says_so(data, start):
    with pytest.warns(NotConverged, match=r"3 of 3 networks .*\(ended by steps\).* 1e-06") as w:
        solution = solve(start, data, steps=2, progress=False)
    assert w[0].filename == __file__
    assert not solution.converged.any() and (solution.ended == "steps").all()
    assert (solution.gradient > 1e-6).all() and (solution.steps == 2).all()


def test_a_saturated_network_does_not_pass_for_an_optimum(data, start):
    """Its gradient is zero, as are all derivatives."""
    weights = replace(start, output_bias=start.output_bias + 1e4)
    solution = quietly(weights, data, steps=20)
    assert (solution.ended == "no descent").all() and not solution.converged.any()
    assert np.isfinite(flat(solution.model.weights)).all()
