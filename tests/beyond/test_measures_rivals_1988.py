"""Measures of tables, CMAC and polynomials on planted results whose values are known."""

import numpy as np
import pytest

from workshop.beyond.measures import rivals_1988 as measures
from workshop.beyond.studies.rivals_1988 import practised_distance
from workshop.report import results

FIVE = np.ones(5)  # days
EXACT, POSITIONS = measures.KINDS


@pytest.fixture
def plant(monkeypatch):
    """Results by name in place of the committed ones."""
    planted = {}
    monkeypatch.setattr(results, "read", planted.__getitem__)
    return planted


def test_degrading_is_ten_degrees_away_over_there(plant):
    errors = 0.1 + 0.02 * practised_distance()  # 0.3 at ten degrees, 0.1 there
    family = {"errors": [errors * k for k in range(1, 6)]}
    plant["rivals-tables"] = {"around": {POSITIONS: {"states": family}}}
    np.testing.assert_allclose(measures.around("states")[1], [0.2, 0.4, 0.6, 0.8, 1.0])
    assert measures.degrades("states").value == pytest.approx(3.0)


def test_full_tables_are_counted_against_the_network(plant):
    full = {"cells": [2, 4, 8], "constant": [0.5, 0.2, 0.1], "multilinear": [0.09, 0.12, 0.01]}
    plant["rivals-tables"] = {"full": full | {"reached": [0.9, 0.5, 0.25]}}
    assert measures.STORED == 536
    assert measures.stored("constant").value == pytest.approx(2 * 8**6 / 536)
    assert measures.stored("multilinear").value == pytest.approx(2 * 3**6 / 536)
    assert "8 cells an axis: 524,288 numbers, 2.1 MB" in measures.stored("constant").text
    assert measures.reached().value == 0.25
    plant["rivals-tables"]["full"]["constant"] = [1.0, 1.0, 1.0]
    with pytest.raises(ValueError, match=r"way must reach 0\.1"):
        measures.stored("constant")


def test_collisions(plant):
    cells = (None, 0.1), (4000, 0.11), (2000, 0.14), (1000, 0.16), (50, 0.9), (20, 0.9)
    shape = {"kind": POSITIONS, "layers": 32, "width": 0.5, "visited": 1000 * FIVE}
    rows = [
        shape | {"slots": slots, "again": again * FIVE, "diverged": [False, again > 0.5]}
        for slots, again in cells
    ]
    plant["rivals-cmac"] = {"rows": rows}
    assert measures.diverges_at().value == pytest.approx(0.05)
    assert measures.hashing_saves().value == pytest.approx(2.0)
    plant["rivals-cmac"]["rows"] += rows[:1]
    with pytest.raises(ValueError, match="2 rows"):
        measures.row("rivals-cmac", slots=None)


def test_polynomials(plant):
    def row(order, ridge, outside, kind=POSITIONS):
        known = {"basis": "chebyshev", "order": order, "ridge": ridge, "kind": kind}
        errors = {"outside": outside * FIVE, "trajectory 6": outside / 2 * FIVE}
        return known | errors | {"count": 100 * order * FIVE}

    cells = (1, 0.0, 0.4), (2, 0.0, 0.2), (3, 0.0, 8.0), (2, 0.1, 0.1), (3, 0.1, 2.0), (3, 0.2, 4.0)
    rows = [row(*cell) for cell in cells] + [row(2, 0.0, 0.3, kind=EXACT)]
    chosen = {"chebyshev": [{"order": 2, "ridge": 0.1}] * 5}
    plant["rivals-bases"] = {"rows": rows, "chosen": chosen}
    assert measures.orders("chebyshev") == [1, 2, 3]
    assert measures.medium().value == pytest.approx(0.1 / 0.4)
    assert measures.penalty().value == pytest.approx(4.0)
    assert measures.good("chebyshev").value == pytest.approx(0.05)
    assert measures.coefficients().value == pytest.approx(200 / 536)
