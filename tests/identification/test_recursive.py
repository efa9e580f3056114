"""Recursive least squares against the batch solution of the same penalised problem."""

import numpy as np
from hypothesis import given, settings, strategies as st

from ddlib.identification import RecursiveLeastSquares


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.integers(1, 60), st.sampled_from([1.0, 0.97]))
def test_after_every_sample_it_is_the_batch_solution(seed, samples, forgetting):
    rng = np.random.default_rng(seed)
    x, y = rng.normal(size=(samples, 4)), rng.normal(size=(samples, 2))
    first, penalty = rng.normal(size=(2, 4)), 0.3
    found = RecursiveLeastSquares(first, penalty, forgetting)
    for features, target in zip(x, y):
        before = found.weights.copy()
        np.testing.assert_array_equal(found.update(features, target), before @ features)
    age = forgetting ** np.arange(samples)[::-1]
    square = (x.T * age) @ x + forgetting**samples * penalty * np.eye(4)
    right = (x.T * age) @ y + forgetting**samples * penalty * first.T
    np.testing.assert_allclose(
        found.weights.T, np.linalg.solve(square, right), rtol=1e-8, atol=1e-9
    )
    np.testing.assert_allclose(found.covariance, np.linalg.inv(square), rtol=1e-7, atol=1e-9)
