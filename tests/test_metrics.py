"""RMSS: its definition, what it is blind to, and refusals."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from ddlib.metrics import rmss

RNG = np.random.default_rng(4)
TARGET = RNG.normal(size=(60, 2)) * [30.0, 4.0] + [5.0, -1.0]
GUESS = TARGET + RNG.normal(size=(60, 2)) * [3.0, 1.0]


def by_loop(predicted, target):
    """RMSS of one joint as a schoolbook would compute it."""
    n = len(target)
    mean = sum(target) / n
    variance = sum((x - mean) ** 2 for x in target) / n
    return (sum((p - x) ** 2 for p, x in zip(predicted, target)) / n / variance) ** 0.5


def test_definition():
    shoulder, elbow = (by_loop(GUESS[:, j], TARGET[:, j]) for j in (0, 1))
    assert shoulder != pytest.approx(elbow, rel=0.1)
    np.testing.assert_allclose(rmss(GUESS, TARGET, pooled=False), [shoulder, elbow])
    assert rmss(GUESS, TARGET) == pytest.approx(((shoulder**2 + elbow**2) / 2) ** 0.5)


def test_guessing_the_mean_scores_one_and_knowing_scores_zero():
    mean = np.broadcast_to(TARGET.mean(0), TARGET.shape)
    np.testing.assert_allclose(rmss(mean, TARGET, pooled=False), 1.0)
    assert rmss(TARGET, TARGET) == 0.0
    twice = mean + 2 * (TARGET - mean)  # wrong by as much as the target varies
    np.testing.assert_allclose(rmss(twice, TARGET, pooled=False), 1.0)


@given(
    gain=st.tuples(st.floats(0.01, 100), st.floats(0.01, 100)),
    offset=st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    sign=st.sampled_from([-1, 1]),
    error=st.floats(0, 5),
)
def test_units_and_offsets_do_not_matter_and_errors_scale(gain, offset, sign, error):
    gain, offset = sign * np.array(gain), np.array(offset)
    p, t = gain * GUESS + offset, gain * TARGET + offset
    np.testing.assert_allclose(rmss(p, t, pooled=False), rmss(GUESS, TARGET, pooled=False))
    farther = TARGET + error * (GUESS - TARGET)
    np.testing.assert_allclose(rmss(farther, TARGET), error * rmss(GUESS, TARGET), atol=1e-12)
