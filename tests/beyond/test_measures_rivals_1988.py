"""Measures of tables, CMAC and polynomials on planted results whose values are known."""

import numpy as np
import pytest

from workshop.beyond.measures import rivals_1988 as measures
from workshop.beyond.studies.rivals_1988 import practised_distance
from workshop.report import results

DAYS = 5
EXACT, POSITIONS = measures.KINDS


@pytest.fixture
def plant(monkeypatch):
    """Results by name in place of the committed ones."""
    planted = {}
    monkeypatch.setattr(results, "read", lambda name: planted[name])
    return planted


def test_degrading_is_ten_degrees_away_over_there(plant):
    errors = 0.1 + 0.02 * practised_distance()  # 0.3 at ten degrees, 0.1 there
    family = {
        "errors": [errors * k for k in range(1, DAYS + 1)],
        "there": [[9, k] for k in range(5)],
    }
    plant["rivals-tables"] = {"around": {POSITIONS: {"states": family, "floor": [0.5] * DAYS}}}
    np.testing.assert_allclose(measures.around("states")[1], [0.2, 0.4, 0.6, 0.8, 1.0])
    found = measures.degrades("states")
    assert found.value == pytest.approx(3.0) and "3.0 times" in found.text
    assert measures.on_the_trajectory("states").value == pytest.approx(2 / 0.5)


def test_full_tables_are_counted_against_the_network(plant):
    plant["rivals-tables"] = {
        "full": {
            "cells": [2, 4, 8],
            "constant": [0.5, 0.2, 0.1],
            "multilinear": [0.09, 0.12, 0.01],
            "reached": [0.9, 0.5, 0.25],
        }
    }
    assert measures.STORED == 536
    assert measures.stored("constant").value == pytest.approx(2 * 8**6 / 536)
    assert measures.stored("multilinear").value == pytest.approx(2 * 3**6 / 536)
    assert "8 cells an axis: 524,288 numbers, 2.1 MB" in measures.stored("constant").text
    assert measures.reached().value == 0.25
    plant["rivals-tables"]["full"]["constant"] = [1.0, 1.0, 1.0]
    with pytest.raises(ValueError, match=r"way must reach 0\.1"):
        measures.stored("constant")


def cmac_row(slots, again, diverged=False):
    return {
        "kind": POSITIONS, "layers": 32, "width": 0.5, "slots": slots, "again": [again] * DAYS,
        "diverged": [False] * 4 + [diverged], "visited": [1000] * DAYS,
    }  # fmt: skip


def test_collisions(plant):
    rows = [
        cmac_row(None, 0.1), cmac_row(4000, 0.11), cmac_row(2000, 0.14), cmac_row(1000, 0.16),
        cmac_row(50, 0.9, diverged=True), cmac_row(20, 0.9, diverged=True),
    ]  # fmt: skip
    plant["rivals-cmac"] = {"rows": rows, "chosen": {"new": [0.1, 0.2, 0.3, 0.4, 0.5]}}
    assert measures.diverges_at().value == pytest.approx(0.05)
    assert measures.hashing_saves().value == pytest.approx(2.0)
    assert measures.hashing_saves(factor=2.0).value == pytest.approx(1.0)
    assert measures.cmac("new").value == pytest.approx(0.3)
    with pytest.raises(ValueError, match="2 rows"):
        plant["rivals-cmac"]["rows"] = rows + rows[:1]
        measures.row("rivals-cmac", slots=None)


def basis_row(order, ridge, outside, kind=POSITIONS, **more):
    same = {"basis": "chebyshev", "training": [outside / 10] * DAYS, "count": [100 * order] * DAYS}
    own = {"kind": kind, "order": order, "ridge": ridge, "outside": [outside] * DAYS}
    return same | own | {"trajectory 6": [outside / 2] * DAYS} | more


def test_polynomials(plant):
    rows = [
        basis_row(1, 0.0, 0.4), basis_row(2, 0.0, 0.2), basis_row(3, 0.0, 8.0),
        basis_row(2, 0.1, 0.1), basis_row(3, 0.1, 2.0), basis_row(3, 0.2, 4.0),
        basis_row(2, 0.0, 0.3, kind=EXACT),
    ]  # fmt: skip
    picked = [{"order": 2, "ridge": 0.1}] * DAYS
    floor = [0.01] * DAYS
    plant["rivals-bases"] = {"rows": rows, "chosen": {"chebyshev": picked}, "floor": floor}
    assert measures.orders("chebyshev") == [1, 2, 3]
    assert measures.low_order(2).value == pytest.approx(3.0)
    assert measures.high_order().value == pytest.approx(20.0)
    assert measures.high_order().text == "8.0 for 0.40, degree 3 for 1"
    assert measures.medium().value == pytest.approx(0.1 / 0.4)
    assert measures.penalty().value == pytest.approx(4.0)
    assert measures.good("chebyshev").value == pytest.approx(0.05)
    assert measures.coefficients().value == pytest.approx(200 / 536)
