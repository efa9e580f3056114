"""Argument checks: what passes, what is refused, and what the message says."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ddlib import _check


@pytest.mark.parametrize("value", [1, 2.5, np.float32(3), [1, 2], [[1.0, 2.0]], np.arange(4)])
def test_finite_array_keeps_shape_and_values(value):
    array = _check.finite_array("x", value)
    assert array.dtype == float and array.shape == np.shape(value)
    assert array.tolist() == np.array(value).tolist()


@pytest.mark.parametrize(
    "value", ["a", "3", ["1", "2"], None, [None, 1.0], [1, [2, 3]], 1j, [1 + 0j, 2.0], {}, object()]
)
def test_finite_array_refuses_what_is_not_a_real_number(value):
    with pytest.raises(TypeError, match="angle"):
        _check.finite_array("angle", value)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("shape", [(), (2,), (3, 2)])
def test_finite_array_refuses_a_single_bad_entry(bad, shape):
    value = np.zeros(shape)
    value[(-1,) * len(shape)] = bad
    with pytest.raises(ValueError, match=r"angle.*finite"):
        _check.finite_array("angle", value)


def test_finite_array_checks_the_last_axis():
    assert _check.finite_array("q", np.zeros((5, 2)), 2).shape == (5, 2)
    for value in (1.0, [1.0], [1.0, 2.0, 3.0], np.zeros((2, 5)), []):
        with pytest.raises(ValueError, match=r"q .*length 2"):
            _check.finite_array("q", value, 2)


def test_finite_array_leaves_its_argument_alone():
    value = np.array([1, 2])
    _check.finite_array("x", value)
    assert value.dtype == np.array([1, 2]).dtype and value.tolist() == [1, 2]


@settings(deadline=None, max_examples=60)
@given(
    x=st.floats(-10, 10),
    low=st.floats(-10, 10),
    high=st.floats(-10, 10),
    open_low=st.booleans(),
)
def test_number_accepts_exactly_the_range(x, low, high, open_low):
    inside = low < x <= high or (x == low <= high and not open_low)
    if inside:
        assert _check.number("x", x, low, high, open_low=open_low) == x
    else:
        with pytest.raises(ValueError, match="x must lie in"):
            _check.number("x", x, low, high, open_low=open_low)


@pytest.mark.parametrize("bound, bracket", [(False, r"\[0, 2\]"), (True, r"\(0, 2\]")])
def test_number_names_argument_range_and_value(bound, bracket):
    with pytest.raises(ValueError, match=rf"^gain must lie in {bracket}, got -3$"):
        _check.number("gain", -3, 0, 2, open_low=bound)


@pytest.mark.parametrize("value", [True, [1.0], "1", None, np.array([1.0]), 1j])
def test_number_refuses_other_kinds(value):
    with pytest.raises(TypeError, match="gain"):
        _check.number("gain", value)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_number_refuses_nan_and_infinity_without_bounds(value):
    with pytest.raises(ValueError, match="gain"):
        _check.number("gain", value)


def test_non_negative():
    assert _check.non_negative("kp", [0, 1.5], 2).tolist() == [0.0, 1.5]
    with pytest.raises(ValueError, match=r"kp must not be negative, got -2"):
        _check.non_negative("kp", [1.0, -2.0])
    with pytest.raises(ValueError, match="kp"):
        _check.non_negative("kp", [1.0], 2)
    with pytest.raises(ValueError, match="kp"):
        _check.non_negative("kp", [1.0, np.nan])


def test_integer():
    assert _check.integer("n", np.int64(3), 1) == 3
    assert type(_check.integer("n", np.int64(3), 1)) is int
    assert _check.integer("n", 5, 5, 5) == 5
    for value, high in ((0, None), (-1, None), (6, 5)):
        with pytest.raises(ValueError, match=rf"n must be an integer.*got {value}"):
            _check.integer("n", value, 1, high)
    for value in (1.0, True, "1", None):
        with pytest.raises(TypeError, match="n must be an integer"):
            _check.integer("n", value, 0)


def test_one_of_lists_what_it_knows():
    assert _check.one_of("mode", "fast", ("fast", "slow")) == "fast"
    with pytest.raises(ValueError, match=r"mode must be one of 'fast', 'slow', got 'Fast'"):
        _check.one_of("mode", "Fast", ("fast", "slow"))


@pytest.mark.parametrize(
    "shape, fits, misses",
    [
        ((2, 3), [(2, 3)], [(3, 2), (2,), (2, 3, 1), (12, 3), ()]),
        ((), [()], [(1,)]),
        ("(time,)", [(1,), (40,), (0,)], [(), (1, 1)]),
        ("(..., time, 2)", [(5, 2), (3, 5, 2), (12, 3, 5, 2)], [(2,), (2, 5), (5, 12)]),
    ],
)
def test_shapes(shape, fits, misses):
    for size in fits:
        assert _check.shaped("x", np.zeros(size), shape).shape == size
    for size in misses:
        with pytest.raises(ValueError, match=re.escape(f"x must have shape {shape}, got {size}")):
            _check.shaped("x", np.zeros(size), shape)
    with pytest.raises(ValueError, match="x must be finite"):
        _check.shaped("x", np.full(fits[0], np.nan), shape)


def test_positive_numbers():
    assert _check.positive("x", [1, 2]).tolist() == [1.0, 2.0]
    for value, words in (([0.0, 1.0], "x must be positive"), ([1.0], r"x must have shape")):
        with pytest.raises(ValueError, match=words):
            _check.positive("x", value)
