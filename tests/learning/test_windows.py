"""Sliding windows and the scaling of joints: contents, round trips, refusals."""

import numpy as np
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as hnp

from ddlib.learning import Scaler, sliding_windows


def by_loop(q, width, first, end):
    """Windows of one run ``(time, joint)``, sample by sample."""
    half, joints = (width - 1) // 2, q.shape[1]
    rows = []
    for centre in range(first, end):
        rows.append([[q[centre + k, j] for k in range(-half, half + 1)] for j in range(joints)])
    return np.array(rows)


@settings(max_examples=50)
@given(data=st.data(), half=st.integers(1, 6), joints=st.integers(1, 3))
def test_windows_hold_what_a_loop_finds(data, half, joints):
    width = 2 * half + 1
    time = data.draw(st.integers(width, width + 12), "time")
    q = data.draw(hnp.arrays(float, (time, joints), elements=st.floats(-3, 3)), "q")
    whole = by_loop(q, width, half, time - half)
    np.testing.assert_array_equal(sliding_windows(q, width), whole)
    first = data.draw(st.integers(half, time - half - 1), "first")
    end = data.draw(st.integers(first + 1, time - half), "end")
    some = sliding_windows(np.stack([q, q + 1]), width, slice(first, end))  # two runs
    assert some.shape == (2, end - first, joints, width)
    np.testing.assert_array_equal(some[1], by_loop(q + 1, width, first, end))


ranges = st.tuples(st.floats(-100, 100), st.floats(0.01, 200))
targets = st.tuples(st.floats(-2, 2), st.floats(0.05, 3)).map(lambda t: (t[0], t[0] + t[1]))


@settings(max_examples=50)
@given(joints=st.lists(ranges, min_size=1, max_size=4), target=targets, data=st.data())
def test_scaling_there_and_back(joints, target, data):
    low = np.array([a for a, _ in joints])
    high = low + [b for _, b in joints]
    scaler = Scaler(low, high, target)
    x = data.draw(hnp.arrays(float, (5, len(low)), elements=st.floats(-300, 300)))
    np.testing.assert_allclose(scaler.unscale(scaler.scale(x)), x, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(scaler.scale(low), target[0], atol=1e-9)
    np.testing.assert_allclose(scaler.scale(high), target[1], atol=1e-9)
    middle = scaler.scale((low + high) / 2)
    np.testing.assert_allclose(middle, sum(target) / 2, atol=1e-9)  # affine
    np.testing.assert_allclose(scaler.gain, np.diff(target)[0] / (high - low))
