"""The committed studies of the rivals of 1988: whole, and a sample of each measured anew."""

import pytest

from beyond.studies import rivals_1988 as study
from workshop.report import results

POSITIONS = study.KINDS[1]


def rows(name, **wanted):
    found = results.read(name)["rows"]
    return [row for row in found if all(row[k] == v for k, v in wanted.items())]


def test_a_table_a_polynomial_and_a_cmac_measured_anew():
    today = study._day(1, POSITIONS)
    (row,) = rows("rivals-tables", kind=POSITIONS, over="configurations", cells=2)
    again = study._errors(study._table("configurations", 2).fit(today["training"]), today)
    for name, error in again.items():
        assert error == pytest.approx(row[name][0], rel=1e-3, abs=1e-9)
    (row,) = rows("rivals-bases", kind=POSITIONS, basis="chebyshev", order=2, ridge=1e-4)
    make, _ = study._BASES["chebyshev"]
    again = study._by_ridge(make, 2, today["training"], today)
    assert again[study._RIDGES.index(1e-4)]["outside"] == pytest.approx(row["outside"][0], rel=1e-3)
    setting = {"layers": 32, "width": 0.5, "slots": 32}
    (row,) = rows("rivals-cmac", kind=POSITIONS, **setting)
    again = study._cmac(today, setting)
    assert again["diverged"] and row["diverged"][0]
    assert again["overlap"] == pytest.approx(row["overlap"][0], rel=1e-4)


def test_divergence_needs_own_collisions():
    """The condition of `CMAC`'s notes, on every committed run."""
    for row in rows("rivals-cmac"):
        for diverged, overlap in zip(row["diverged"], row["overlap"]):
            assert not diverged or overlap >= 2.0  # the rate is 1
