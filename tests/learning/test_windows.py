"""Sliding windows and the scaling of joints: contents, round trips, refusals."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ddlib.control import proportional
from ddlib.experiments import STATE_FEEDBACK
from ddlib.learning import Scaler, check_width, sliding_windows
from ddlib.simulation import record

RNG = np.random.default_rng(11)


def by_loop(q, width, first, end):
    """Windows of one run ``(time, joint)``, sample by sample."""
    half, joints = (width - 1) // 2, q.shape[1]
    rows = []
    for centre in range(first, end):
        rows.append([[q[centre + k, j] for k in range(-half, half + 1)] for j in range(joints)])
    return np.array(rows)


# --- windows ------------------------------------------------------------------------------


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
    some = sliding_windows(q, width, slice(first, end))
    assert some.shape == (end - first, joints, width)
    np.testing.assert_array_equal(some, by_loop(q, width, first, end))


def test_the_centre_is_the_sample_itself_and_the_oldest_comes_first():
    q = np.arange(40.0).reshape(20, 2)  # joint 0 even, joint 1 odd, 2 apart in time
    windows = sliding_windows(q, 7)
    assert windows.shape == (14, 2, 7)
    np.testing.assert_array_equal(windows[..., 3], q[3:17])
    np.testing.assert_array_equal(windows[0, 0], [0, 2, 4, 6, 8, 10, 12])
    np.testing.assert_array_equal(windows[-1, 1], q[13:, 1])


def test_leading_axes_are_runs():
    q = RNG.normal(size=(4, 3, 30, 2))
    windows = sliding_windows(q, 5, slice(6, 20))
    assert windows.shape == (4, 3, 14, 2, 5)
    for run in np.ndindex(4, 3):
        np.testing.assert_array_equal(windows[run], by_loop(q[run], 5, 6, 20))


def test_the_recorded_rest_is_long_enough_for_a_half_width_of_50():
    """300 samples of motion give 300 windows, as the paper counts them."""
    recording = STATE_FEEDBACK.record((30.0, 20.0))
    for width in (11, 21, 41, 101):
        windows = sliding_windows(recording.q, width, recording.motion)
        assert windows.shape == (300, 2, width)
        half = width // 2
        np.testing.assert_array_equal(windows[0], recording.q[50 - half : 51 + half].T)
        np.testing.assert_array_equal(windows[-1], recording.q[349 - half : 350 + half].T)
    with pytest.raises(ValueError, match="record a longer rest"):
        sliding_windows(recording.q, 103, recording.motion)


def test_a_recording_without_rest_has_no_window_around_its_first_sample():
    recording = record(STATE_FEEDBACK.arm, proportional((300.0, 90.0)), (30.0, 20.0), rest=0.0)
    with pytest.raises(ValueError, match="cases must"):
        sliding_windows(recording.q, 11, recording.motion)
    assert len(sliding_windows(recording.q, 11)) == 290


Q = np.zeros((20, 2))


@pytest.mark.parametrize(
    "arguments, words",
    [
        ((Q, 4), "width must be odd"),
        ((Q, 20), "width must be odd"),
        ((Q, 2), "width must be an integer from 3"),
        ((Q, 1), "width must be an integer from 3"),
        ((Q, 0), "width must be an integer from 3"),
        ((Q, -5), "width must be an integer from 3"),
        ((Q, 21), "width must not exceed the 20 samples"),
        ((np.zeros(20), 5), "q must have shape"),
        ((np.where(np.arange(40).reshape(20, 2) == 7, np.nan, 0.0), 5), "q must be finite"),
        ((np.full((20, 2), np.inf), 5), "q must be finite"),
        ((Q, 5, slice(1, 10)), "cases must be consecutive samples from 2 to 18"),
        ((Q, 5, slice(2, 19)), "cases must be consecutive samples from 2 to 18"),
        ((Q, 5, slice(None)), "cases must"),
        ((Q, 5, slice(5, 5)), "cases must"),
        ((Q, 5, slice(10, 5)), "cases must"),
        ((Q, 5, slice(4, 12, 2)), "cases must"),
        ((Q, 5, slice(12, 4, -1)), "cases must"),
        ((Q, 5, slice(5, 1000)), "cases must"),
    ],
)
def test_windows_refuse_bad_values(arguments, words):
    with pytest.raises(ValueError, match=words):
        sliding_windows(*arguments)


@pytest.mark.parametrize("width", [5.0, "5", None, True, np.array(5.0)], ids=repr)
def test_width_is_an_integer(width):
    with pytest.raises(TypeError, match="width must be an integer"):
        check_width(width)
    assert check_width(np.int64(5)) == 5


def test_positions_are_numbers():
    with pytest.raises(TypeError, match="q must be an array of real numbers"):
        sliding_windows([["a", "b"]] * 20, 5)


# --- scaling ------------------------------------------------------------------------------

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


def test_fit_maps_the_range_of_each_joint_to_the_target():
    data = RNG.normal(size=(50, 2)) * [3.0, 0.2] + [10.0, -1.0]
    scaler = Scaler.fit(data, (0.2, 0.8))
    scaled = scaler.scale(data)
    np.testing.assert_allclose(scaled.min(0), 0.2)
    np.testing.assert_allclose(scaled.max(0), 0.8)
    np.testing.assert_array_equal(scaler.low, data.min(0))
    assert scaled[data[:, 0].argmax(), 0] == pytest.approx(0.8)  # not turned upside down


@pytest.mark.parametrize("axis, shape", [(-1, (6, 5, 2)), (-2, (6, 2, 5)), (0, (2, 6, 5))])
def test_the_joints_may_lie_on_any_axis(axis, shape):
    plain = RNG.normal(size=(6, 5, 2)) * [5.0, 0.5]
    scaler = Scaler.fit(plain)
    moved = np.moveaxis(plain, -1, axis)
    assert moved.shape == shape
    other = Scaler.fit(moved, joint_axis=axis)
    np.testing.assert_array_equal(other.low, scaler.low)
    np.testing.assert_array_equal(other.high, scaler.high)
    np.testing.assert_allclose(
        np.moveaxis(scaler.scale(moved, axis), axis, -1), scaler.scale(plain)
    )
    np.testing.assert_allclose(scaler.unscale(scaler.scale(moved, axis), axis), moved, atol=1e-12)


@pytest.mark.parametrize(
    "make, words",
    [
        (lambda: Scaler([0, 0], [1, 0]), "high must exceed low"),
        (lambda: Scaler([0, 2], [1, 1]), "high must exceed low"),
        (lambda: Scaler([0, 0], [1]), "high must exceed low"),
        (lambda: Scaler([0, np.nan], [1, 1]), "low must be finite"),
        (lambda: Scaler([0, 0], [1, np.inf]), "high must be finite"),
        (lambda: Scaler([0], [1], (0.8, 0.2)), "target must be an increasing pair"),
        (lambda: Scaler([0], [1], (0.5, 0.5)), "target must be an increasing pair"),
        (lambda: Scaler([0], [1], (0.0, np.nan)), "target must be finite"),
        (lambda: Scaler.fit([[0.0, 1.0], [1.0, 1.0]]), "high must exceed low"),  # a still joint
        (lambda: Scaler.fit([[0.0, np.nan], [1.0, 1.0]]), "data must be finite"),
    ],
)
def test_scalers_refuse_bad_values(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_scalers_refuse_data_of_another_number_of_joints():
    with pytest.raises(ValueError):
        Scaler([0, 0], [1, 1]).scale(np.zeros((5, 3)))


@pytest.mark.parametrize("cases", [[1, 2], 5, (3, 4)])
def test_cases_are_a_slice(cases):
    with pytest.raises(TypeError, match="cases must be a slice"):
        sliding_windows(np.zeros((9, 2)), 3, cases)


@pytest.mark.parametrize("method", ["scale", "unscale"])
def test_scalers_refuse_data_that_does_not_fit(method):
    scaler = Scaler(np.zeros(2), np.ones(2))
    for data, words in (
        (np.zeros((4, 1)), r"data must have 2 joints along axis -1, got \(4, 1\)"),
        (np.float64(1.0), "data must have 2 joints"),
        (np.array([[0.0, np.nan]]), "data must be finite"),
    ):
        with pytest.raises(ValueError, match=words):
            getattr(scaler, method)(data)
    with pytest.raises(ValueError, match="data must hold at least one value"):
        Scaler.fit(np.zeros((0, 2)))
