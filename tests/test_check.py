"""Argument checks: what passes, what is refused, and what the message says."""

import re

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from ddlib._check import integer, non_negative, number, one_of, positive, shaped


@settings(deadline=None, max_examples=60)
@given(
    x=st.floats(-10, 10),
    low=st.floats(-10, 10),
    high=st.floats(-10, 10),
    open_low=st.booleans(),
)
def test_number_accepts_exactly_the_range(x, low, high, open_low):
    if low < x <= high or (x == low <= high and not open_low):
        assert number("x", x, low, high, open_low=open_low) == x
    else:
        with pytest.raises(ValueError, match="x must lie in"):
            number("x", x, low, high, open_low=open_low)


def test_messages_name_argument_range_and_value():
    for call, words in (
        (lambda: number("gain", -3, 0, 2, open_low=True), "gain must lie in (0, 2], got -3"),
        (lambda: non_negative("kp", [1.0, -2.0]), "kp must not be negative, got -2"),
        (lambda: non_negative("kp", [1.0], 2), "kp must have a last axis of length 2"),
        (lambda: positive("x", [0.0, 1.0]), "x must be positive, got [0.0, 1.0]"),
        (lambda: positive("x", [1.0]), "x must have shape (..., 2), got (1,)"),
        (lambda: integer("n", 6, 1, 5), "n must be an integer from 1 to 5, got 6"),
        (lambda: one_of("mode", "A", "ab"), "mode must be one of 'a', 'b', got 'A'"),
        (lambda: one_of("a", "lat", ["late", "on"]), "got 'lat'; did you mean 'late'?"),
    ):
        with pytest.raises(ValueError, match=re.escape(words)):
            call()
    assert positive("x", [1, 2]).tolist() == [1.0, 2.0]
    assert non_negative("kp", [0, 1.5], 2).tolist() == [0.0, 1.5]
    assert one_of("mode", "a", "ab") == "a"


def test_masked_entries_are_refused_and_masks_without_any_are_not():
    spiky = np.ma.masked_greater([1.0, 2.0, 9.0, 8.0], 5.0)
    with pytest.raises(ValueError, match="x must have no masked entries, got 2"):
        shaped("x", spiky, (4,))
    assert shaped("x", spiky[:2], (2,)).tolist() == [1.0, 2.0]
