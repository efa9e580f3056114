"""Measures of tables, CMAC and polynomials on planted results whose values are known."""

import numpy as np
import pytest

from beyond.measures import rivals_1988 as measures
from beyond.studies.rivals_1988 import practised_distance
from workshop.report import results

pytestmark = pytest.mark.usefixtures("planted_members")

POSITIONS = measures.KINDS[1]


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


def test_collisions_and_slots_are_counted_in_visited_cubes(plant):
    shared = {"kind": POSITIONS, "layers": 32, "width": 0.5, "visited": [200, 200]}
    runs = ((None, [1.0, 1.0], False), (50, [9.0, 9.0], True), (100, [1.4, 1.4], False),
            (400, [1.1, 1.1], False), (25, [9.0, 9.0], True))  # fmt: skip
    plant["rivals-cmac"] = {"rows": [
        shared | {"slots": slots, "again": again, "diverged": [diverged] * 2}
        for slots, again, diverged in runs
    ]}  # fmt: skip
    assert measures.diverges_at().value == 50 / 200
    assert measures.hashing_saves().value == 100 / 200  # 1.4 is at most 1.5 times 1


def row(order, ridge, outside, six, count):
    errors = {"outside": [outside] * 3, "trajectory 6": [six] * 3, "count": [count] * 3}
    return {"kind": POSITIONS, "basis": "chebyshev", "order": order, "ridge": ridge} | errors


def test_horns_and_medium_of_polynomials(plant):
    rows = [row(1, 0, 2.0, 0.5, 14), row(2, 0, 1.0, 0.05, 67), row(3, 0, 8.0, 0.04, 168)]
    rows += [row(3, 1e-4, 4.0, 0.3, 168), row(3, 1e-2, 0.5, 0.2, 168)]
    chosen = {"chebyshev": [{"order": 2, "ridge": 0}] * 3}
    plant["rivals-bases"] = {"rows": rows, "chosen": chosen}
    assert measures.medium().value == 0.5  # the lowest degree is the better end
    assert measures.penalty().value == 16
    assert measures.good().value == 0.05
    assert measures.coefficients().value == 67 / 536  # 0.05 is below 0.1, the printed error
