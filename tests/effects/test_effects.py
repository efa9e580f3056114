"""Sensors, delay, play and the collection of all effects: rounding, noise, memory, order."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib.effects import (
    Backlash,
    Delay,
    Noise,
    Quantisation,
)


@settings(deadline=None, max_examples=100)
@given(x=st.floats(-100, 100), bits=st.integers(4, 24))
def test_quantisation_is_the_nearest_step(x, bits):
    encoder = Quantisation.encoder(bits)
    once = encoder.apply(x)
    assert abs(once - x) <= encoder.step / 2 * (1 + 1e-6)
    count = once / encoder.step
    assert abs(count - round(count)) < 1e-6
    assert encoder.apply(once) == once
    assert encoder.apply(-x) == -once
    assert encoder.apply(2 * np.pi) == pytest.approx(2 * np.pi, rel=1e-15)  # a whole number


def test_noise_has_the_stated_size_per_joint():
    std = np.array([0.3, 0.02])
    n = 100_000
    noise = Noise(tuple(std)).apply(np.full((n, 2), 5.0), np.random.default_rng(1)) - 5.0
    np.testing.assert_allclose(noise.std(0), std, rtol=4 / np.sqrt(2 * n))
    assert (np.abs(noise.mean(0)) < 4 * std / np.sqrt(n)).all()
    correlation = np.corrcoef(noise.T)[0, 1], np.corrcoef(noise[1:, 0], noise[:-1, 0])[0, 1]
    assert np.abs(correlation).max() < 4 / np.sqrt(n)  # white, and joints independent
    assert np.mean(np.abs(noise[:, 0]) < std[0]) == pytest.approx(0.6827, abs=0.006)


@settings(deadline=None, max_examples=50)
@given(periods=st.integers(0, 12), samples=st.integers(1, 30))
def test_delay_shifts_exactly(periods, samples):
    x = np.random.default_rng(samples).normal(size=(samples, 2))
    initial = np.array([5.0, -5.0])
    late = Delay(periods).start(initial)
    y = np.array([late(sample) for sample in x])
    np.testing.assert_array_equal(y, np.array([initial] * periods + list(x))[:samples])


def play(x, gap, initial=None):
    """The operator along a scalar history."""
    x = np.asarray(x, dtype=float)
    path = Backlash((gap, gap)).start(np.full(2, x[0] if initial is None else initial))
    return np.array([path(np.full(2, sample))[0] for sample in x])


HISTORY = st.lists(st.floats(-5, 5), min_size=2, max_size=12)
GAP = st.floats(0, 3)


@settings(deadline=None, max_examples=50)
@given(x=HISTORY, gap=GAP, between=st.lists(st.integers(1, 6), min_size=11, max_size=11))
def test_play_does_not_depend_on_speed(x, gap, between):
    """Samples on the way from one point to the next change nothing: only turning points do."""
    slow, kept = [x[0]], [0]
    for start, end, n in zip(x, x[1:], between):
        slow += [start + (end - start) * k / n for k in range(1, n)] + [end]
        kept.append(len(slow) - 1)
    np.testing.assert_allclose(play(slow, gap)[kept], play(x, gap), atol=1e-12)


@settings(deadline=None)
@given(amplitude=st.floats(0.5, 10), gap=st.floats(0, 1))
def test_area_of_the_hysteresis_loop(amplitude, gap):
    """A parallelogram: the gap times the span of the reading, ``gap (2 amplitude - gap)``."""
    corners = np.array([amplitude, amplitude - gap, -amplitude, gap - amplitude])
    x = np.concatenate([[0.0], corners, corners])  # once to get into the loop, then around it
    loop_x, loop_y = corners, play(x, gap)[5:]
    area = 0.5 * abs(np.sum(loop_x * np.roll(loop_y, -1) - np.roll(loop_x, -1) * loop_y))
    assert area == pytest.approx(gap * (2 * amplitude - gap), rel=1e-9, abs=1e-9)
    assert np.abs(loop_y).max() == pytest.approx(amplitude - gap / 2)


def test_play_by_hand_per_joint_and_without_gap():
    x = np.array([0.0, 0.4, 1.0, 0.6, 0.2, -0.5, 0.0, 0.4])
    np.testing.assert_allclose(play(x, 1.0), [0, 0, 0.5, 0.5, 0.5, 0.0, 0.0, 0.0])
    np.testing.assert_array_equal(play(x, 0.0), x)
