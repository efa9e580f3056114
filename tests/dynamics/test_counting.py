"""Numbers that count: right values, every rule of the tally, and a hand-made count."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from ddlib.dynamics import Operations, Tape


def made(**values):
    """A tape with the named unknown numbers."""
    tape = Tape()
    return tape, *(tape.unknown(x) for x in values.values())


def test_every_operation_counts_once():
    tape, x, y = made(x=3.0, y=4.0)
    results = [x + y, x - y, x * y, x / y, np.sin(x), np.cos(y), 2 / x, 5 - y]
    wanted = [7.0, -1.0, 12.0, 0.75, math.sin(3.0), math.cos(4.0), 2 / 3, 1.0]
    assert [r.value for r in results] == pytest.approx(wanted, rel=1e-15)
    assert tape.executed == Operations(1, 3, 2, 2)
    assert tape.executed == tape.needed(results)


def test_what_is_known_is_free():
    tape, x = made(x=3.0)
    c = tape.known(2.0)
    before = c * 5 + np.sin(c) / 7 - np.cos(c) * c**2
    assert before.value == pytest.approx(10 + math.sin(2) / 7 - math.cos(2) * 4)
    assert tape.executed == Operations(0, 0)
    assert (x * before).recipe is not None and tape.executed == Operations(1, 0)
    assert (x / c).value == 1.5
    assert tape.executed == Operations(2, 0), "dividing by a constant is one multiplication"


def test_zeros_ones_and_signs_are_free():
    tape, x, y = made(x=3.0, y=4.0)
    assert (x + 0) is x and (0 + x) is x and (x - 0) is x and (x * 1) is x
    assert (x * 0)._is(0.0) and (0.0 * x).value == 0.0
    opposite = -x
    assert -opposite is x and (x * -1).value == -3.0
    assert tape.executed == Operations(0, 0)
    assert tape.needed([-x * y, x * -y, -x * -y]) == Operations(1, 0), "one product, two signs"
    assert tape.needed([-x - y, -(x + y)]) == Operations(0, 1)
    assert tape.needed([x - y, -y + x]) == tape.needed([x + y, y + x]) == Operations(0, 1)


def test_needed_counts_no_repetition_and_nothing_in_vain():
    tape, x, y = made(x=3.0, y=4.0)
    first, again, vain = x * y + 1, y * x + 1, x * x * x
    assert again is first and vain.value == 27.0
    assert tape.executed == Operations(4, 2)
    assert tape.needed([first]) == tape.needed([first, again]) == Operations(1, 1)
    assert tape.needed([x, 5.0, tape.known(2.0)]) == Operations(0, 0)


numbers = st.floats(-10, 10)


@given(x=numbers, y=numbers, c=numbers)
def test_values_are_those_of_plain_arithmetic(x, y, c):
    def formula(x, y):
        return (x - c) * -(y * x) + np.cos(x + y) * (2 - y) - -x * np.sin(-y) + c * c * x

    tape = Tape()
    counted = formula(tape.unknown(x), tape.unknown(y))
    assert counted.value == pytest.approx(formula(x, y), rel=1e-9, abs=1e-9)
    needed, executed = tape.needed([counted]), tape.executed
    assert all(n <= e for n, e in zip(needed, executed))
