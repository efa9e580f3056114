"""RMSS: its definition, what it is blind to, and refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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
    assert rmss(mean, TARGET) == pytest.approx(1.0)
    np.testing.assert_allclose(rmss(mean, TARGET, pooled=False), 1.0)
    assert rmss(TARGET, TARGET) == 0.0
    twice = mean + 2 * (TARGET - mean)  # wrong by as much as the target varies
    np.testing.assert_allclose(rmss(twice, TARGET, pooled=False), 1.0)


def test_another_standard_deviation_may_be_named():
    own = rmss(GUESS, TARGET, pooled=False)
    std = TARGET.std(0)
    np.testing.assert_allclose(rmss(GUESS, TARGET, scale=2 * std, pooled=False), own / 2)
    other = rmss(GUESS, TARGET, scale=[std[0], 4 * std[1]], pooled=False)
    np.testing.assert_allclose(other, own / [1, 4])
    pooled = rmss(GUESS, TARGET, scale=[1.0, 1.0])
    assert pooled == pytest.approx(np.sqrt(np.mean((GUESS - TARGET) ** 2)))


@given(
    gain=st.tuples(st.floats(0.01, 100), st.floats(0.01, 100)),
    offset=st.tuples(st.floats(-50, 50), st.floats(-50, 50)),
    sign=st.sampled_from([-1, 1]),
)
def test_units_and_offsets_do_not_matter(gain, offset, sign):
    gain, offset = sign * np.array(gain), np.array(offset)
    p, t = gain * GUESS + offset, gain * TARGET + offset
    np.testing.assert_allclose(rmss(p, t, pooled=False), rmss(GUESS, TARGET, pooled=False))
    np.testing.assert_allclose(rmss(p, t), rmss(GUESS, TARGET))


@given(error=st.floats(0, 5))
def test_an_error_in_proportion_scores_in_proportion(error):
    p = TARGET + error * (GUESS - TARGET)
    np.testing.assert_allclose(rmss(p, TARGET), error * rmss(GUESS, TARGET), atol=1e-12)


def test_leading_axes_are_members():
    many = TARGET + RNG.normal(size=(3, 4, 60, 2))
    pooled, each = rmss(many, TARGET), rmss(many, TARGET, pooled=False)
    assert pooled.shape == (3, 4) and each.shape == (3, 4, 2)
    for i in np.ndindex(3, 4):
        assert pooled[i] == pytest.approx(float(rmss(many[i], TARGET)))
        np.testing.assert_allclose(each[i], rmss(many[i], TARGET, pooled=False))


@pytest.mark.parametrize(
    "arguments, options, words",
    [
        ((GUESS[1:], TARGET), {}, "must both have shape"),
        ((GUESS[:, :1], TARGET), {}, "must both have shape"),
        ((GUESS[:, 0], TARGET[:, 0]), {}, "must both have shape"),
        ((np.where(GUESS > 40, np.nan, GUESS), TARGET), {}, "predicted must be finite"),
        ((GUESS, np.where(TARGET > 40, np.inf, TARGET)), {}, "target must be finite"),
        ((GUESS, np.broadcast_to([1.0, 2.0], (60, 2))), {}, "scale must be positive"),
        ((GUESS, TARGET), dict(scale=[1.0, 0.0]), "scale must be positive"),
        ((GUESS, TARGET), dict(scale=[1.0, -1.0]), "scale must be positive"),
        ((GUESS, TARGET), dict(scale=[1.0, np.nan]), "scale must be finite"),
        ((GUESS, TARGET), dict(scale=[1.0, 1.0, 1.0]), "scale must have a last axis"),
        ((GUESS, TARGET), dict(scale=1.0), "scale must have a last axis"),
    ],
)
def test_refusals(arguments, options, words):
    with pytest.raises(ValueError, match=words):
        rmss(*arguments, **options)


def test_words_are_not_numbers():
    with pytest.raises(TypeError, match="predicted must be an array of real numbers"):
        rmss([["a", "b"]], [[1.0, 2.0]])


def test_no_cases_have_no_error():
    with pytest.raises(ValueError, match=r"shape \(..., cases, joint\), got \(0, 2\)"):
        rmss(np.zeros((0, 2)), np.zeros((0, 2)))
