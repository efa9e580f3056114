"""Tables 4-1 and 6-1 in their lessons, and the window that is dragged."""

import numpy as np
import pytest

from ddlib import paper
from workshop.chapters import whole_state_space, window_networks, window_size


def test_table_4_1_has_printed_values_and_three_readings():
    table = window_networks.table_4_1()
    printed = [str(row[1]) for row in table.rows]
    assert [float(text) for text in printed] == [
        getattr(paper.TABLE_4_1[w], what) for what in ("training", "test") for w in (11, 21, 41)
    ]
    for row in table.rows:
        for cell in row[2:]:
            middle, interval = cell.split(" (")
            near = middle.startswith("**")
            value = float(middle.strip("*"))
            low, high = map(float, interval.rstrip(")").split(" to "))
            assert low <= value <= high
            assert near == (abs(np.log(value / float(row[1]))) < np.log(1.5))


def test_table_6_1_has_the_readers_errors_in_order():
    table = whole_state_space.table_6_1([0.1, 0.2, 0.3, 0.4])
    assert [row[-1] for row in table.rows] == ["0.10", "0.20", "0.30", "0.40"]
    printed = [float(row[1]) for row in table.rows]
    assert printed == [*paper.TABLE_6_1.values(), paper.TABLE_6_1["trajectory 6"]]


def test_acceleration_by_window():
    """The best window is longer for a coarser encoder; a number is the point of its curve."""
    widget = window_size.acceleration_by_window()
    best = []
    for bits in (10.5, 12.5, 16.0):
        shown = widget.at_grid(width=21, bits=bits)
        assert shown["error"][0] == pytest.approx(shown["errors"][9], rel=0.02)  # as baked
        best.append(shown["errors"].argmin())
    assert best == sorted(best, reverse=True) and best[0] > best[2]
