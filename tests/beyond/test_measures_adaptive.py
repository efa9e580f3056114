"""Measures of adaptive control, on a planted result."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import adaptive
from workshop.report import results


def test_estimates_are_bent_and_stopped_runs_infinite(monkeypatch):
    ones, coulomb = np.ones((10, 7)), np.eye(7)[5]
    rows = [
        {"late": late, "load": 5.0, "settled": {"PD": [[1.0, None], [3.0, late]]}}
        for late in (0, 4)
    ]
    bed = {"nothing else": {"estimate": ones}, "dead zone": {"estimate": ones + 0.4 * coulomb}}
    planted = {"bed": bed, "loads": {"joint damping": {"rows": rows}}, "course": [[1.0, None]]}
    monkeypatch.setattr(results, "read", {"adaptive": planted}.__getitem__)
    np.testing.assert_allclose(adaptive.bias("dead zone"), 0.4 * coulomb)
    found = adaptive.bent("dead zone")
    assert found.value == pytest.approx(0.4)
    assert found.text == "+40 % of the shoulder's Coulomb friction"
    np.testing.assert_array_equal(adaptive.kept("course"), [[1.0, np.inf]])
    row = adaptive.load_row("joint damping", 5.0, 4)
    np.testing.assert_array_equal(row["PD"], [[1.0, np.inf], [3.0, 4.0]])
