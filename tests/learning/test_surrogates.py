"""Surrogate torques: what they keep, what they destroy."""

import numpy as np
import pytest

from ddlib.learning import MATCHED, p_value, related, sliding_windows, surrogate, surrogates
from ddlib.learning.surrogates import _KINDS, _LEAST_SHIFT


def smooth(runs=4, time=300, seed=0):
    """Two correlated joints: sums of slow sines with a mean of their own in each run."""
    rng = np.random.default_rng(seed)
    t = np.arange(time) / time
    waves = sum(
        rng.normal(size=(runs, 1, 1)) * np.sin(2 * np.pi * (k * t + rng.random()))[None, :, None]
        for k in (1, 2, 5)
    )
    other = rng.normal(size=(runs, 1, 1)) * np.cos(2 * np.pi * 3 * t)[None, :, None]
    return np.concatenate([waves, 0.6 * waves + other], -1) + rng.normal(size=(runs, 1, 2))


TORQUE = smooth()


@pytest.mark.parametrize("time", [300, 301])
def test_phases_keep_spectra_and_cross_spectra_of_each_run(time):
    torque = smooth(time=time)
    drawn = surrogate("phases", torque, 3)
    before, after = (np.fft.fft(x, axis=1) for x in (torque, drawn))
    size = np.abs(before).max()
    assert np.abs(np.abs(after) - np.abs(before)).max() < 1e-12 * size
    cross = [x[..., 0] * x[..., 1].conj() for x in (before, after)]
    assert np.abs(cross[1] - cross[0]).max() < 1e-12 * size**2
    assert np.abs(drawn - torque).max() > 0.5  # and yet another signal


def test_shifts_go_around_each_run_by_itself():
    shifts = []
    for seed in range(40):
        for run, moved in zip(TORQUE, surrogate("shifted", TORQUE, seed)):
            fits = [k for k in range(len(run)) if np.array_equal(np.roll(run, k, 0), moved)]
            assert len(fits) == 1
            shifts += fits
    least = min(min(k, 300 - k) for k in shifts)
    assert _LEAST_SHIFT * 300 <= least <= _LEAST_SHIFT * 300 + 5


def test_other_runs_are_others_each_once():
    orders = set()
    for seed in range(60):
        drawn = surrogate("other run", TORQUE, seed)
        order = tuple(int(np.abs(TORQUE - run).max((1, 2)).argmin()) for run in drawn)
        assert sorted(order) == [0, 1, 2, 3] and all(k != i for i, k in enumerate(order))
        assert np.array_equal(drawn, TORQUE[list(order)])
        orders.add(order)
    assert len(orders) == 9  # all permutations of four without a fixed point


@pytest.mark.parametrize("kind", _KINDS)
def test_seeds_decide_and_the_relation_to_the_cause_is_gone(kind):
    """White inputs make the torques; over draws the mean correlation with them vanishes."""
    one, again, other = (surrogate(kind, TORQUE, s) for s in (4, 4, 5))
    assert np.array_equal(one, again) and not np.array_equal(one, other)
    assert np.array_equal(surrogates(kind, TORQUE, 3, seed=3)[1:], [one, other])
    rng = np.random.default_rng(2)
    cause = rng.normal(size=(5, 300, 1))
    torque = np.concatenate([cause, cause**3 + rng.normal(size=cause.shape)], -1)
    correlations = [
        np.corrcoef(cause.ravel(), x[..., 0].ravel())[0, 1] for x in surrogates(kind, torque, 40)
    ]
    assert abs(np.mean(correlations)) < 0.03 and np.std(correlations) < 0.05
    assert set(MATCHED) < set(_KINDS)


def test_related_is_the_share_that_a_filter_explains():
    rng = np.random.default_rng(0)
    windows = sliding_windows(rng.normal(size=(400, 2)), 5)
    exact = np.einsum("njw,jw->n", windows, rng.normal(size=(2, 5)))
    noise = rng.normal(size=len(exact))
    target = np.stack([3 + exact, exact + noise * exact.std()], -1)
    share = related(target, windows)
    assert share[0] == pytest.approx(1, abs=1e-6)
    assert share[1] == pytest.approx(0.5, abs=0.08)


def test_p_values_by_hand_and_uniform_where_the_null_holds():
    """One value among 19 draws of the same kind: each of 20 ranks is as likely."""
    draws = [0.1, 0.2, 0.3, 0.4]
    assert p_value(0.5, draws, "more") == 1 / 5 and p_value(0.5, draws, "less") == 1
    assert p_value(0.3, draws, "more") == 3 / 5 and p_value(0.3, draws, "less") == 4 / 5
    assert p_value(0.05, draws) == 2 / 5 and p_value(0.25, draws) == 1
    rng = np.random.default_rng(0)
    values = [p_value(x[0], x[1:], "more") for x in rng.normal(size=(4000, 20))]
    assert np.mean(np.array(values) <= 0.05 + 1e-9) == pytest.approx(0.05, abs=0.015)
    assert np.mean(values) == pytest.approx(0.525, abs=0.02)
