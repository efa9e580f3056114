"""Measures of tables, CMAC and polynomials on planted results whose values are known."""

import numpy as np
import pytest

from beyond.measures import rivals_1988 as measures
from beyond.studies.rivals_1988 import _practised_distance
from workshop.report import results

pytestmark = pytest.mark.usefixtures("planted_members")

POSITIONS = measures._KINDS[1]


@pytest.fixture
def plant(monkeypatch):
    """Results by name in place of the committed ones."""
    planted = {}
    monkeypatch.setattr(results, "read", planted.__getitem__)
    return planted


def test_degrading_is_ten_degrees_away_over_there(plant):
    errors = 0.1 + 0.02 * _practised_distance()  # 0.3 at ten degrees, 0.1 there
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
