"""The committed studies of the rivals of 1988: whole, and a sample of each measured anew."""

import numpy as np
import pytest

from ddlib.setups import JOINT_DAMPING, square
from workshop.beyond.studies import rivals_1988 as study
from workshop.report import results

POSITIONS = study.KINDS[1]
SETS = ("training", "again", "trajectory 6", "inside", "outside")


@pytest.fixture(scope="module")
def first_day():
    return study._day(1, POSITIONS)


def rows(name, **wanted):
    found = results.read(name)["rows"]
    return [row for row in found if all(row[k] == v for k, v in wanted.items())]


def test_every_setting_is_there_on_every_day():
    days = len(study.DAYS)
    tables = rows("rivals-tables", kind=POSITIONS)
    assert [(r["over"], r["cells"]) for r in tables][1:] == [
        (over, n) for over, some in study.CELLS.items() for n in some
    ]
    slots = [r["slots"] for r in rows("rivals-cmac", kind=POSITIONS) if r["slots"]]
    assert slots == list(study.SLOTS)
    bases = rows("rivals-bases", kind=POSITIONS)
    assert len(bases) == len(study.RIDGES) * sum(highest for _, highest in study.BASES.values())
    for row in (*tables, *rows("rivals-cmac"), *bases):
        assert all(len(row[name]) == days for name in SETS)


def test_the_square_is_in_the_order_of_its_recording():
    np.testing.assert_allclose(
        study.square_extents(), square(JOINT_DAMPING, study.POINTS).extents_deg
    )
    assert (study.practised_distance() == 0).sum() == 1
    assert set(study.practised_distance()) == {0, 5, 10, 15, 20}


@pytest.mark.parametrize("over, cells", [("nearest", 0), ("configurations", 2), ("multilinear", 1)])
def test_a_table_measured_anew(first_day, over, cells):
    (row,) = rows("rivals-tables", kind=POSITIONS, over=over, cells=cells)
    rival = study._table(over, cells).fit(first_day["training"])
    again = study._errors(rival, first_day)
    for name in SETS:
        assert again[name] == pytest.approx(row[name][0], rel=1e-3, abs=1e-9)


def test_a_polynomial_and_a_cmac_measured_anew(first_day):
    (row,) = rows("rivals-bases", kind=POSITIONS, basis="chebyshev", order=2, ridge=1e-4)
    again = study._by_ridge(study.Polynomial(2), first_day["training"], first_day)
    assert again[study.RIDGES.index(1e-4)]["outside"] == pytest.approx(row["outside"][0], rel=1e-3)
    setting = {"layers": 32, "width": 0.5, "slots": 32}
    (row,) = rows("rivals-cmac", kind=POSITIONS, **setting)
    again = study._cmac(first_day, setting)
    assert again["diverged"] and row["diverged"][0]
    assert again["overlap"] == pytest.approx(row["overlap"][0], rel=1e-4)


def test_divergence_needs_own_collisions():
    """The condition of `CMAC`'s notes, on every committed run."""
    for row in rows("rivals-cmac"):
        for diverged, overlap in zip(row["diverged"], row["overlap"]):
            assert not diverged or overlap >= 2.0  # the rate is 1


def test_choices_are_made_without_the_tests():
    for name, picked in results.read("rivals-bases")["chosen"].items():
        assert len(picked) == len(study.DAYS)
        for each in picked:
            assert each["ridge"] in study.RIDGES and 1 <= each["order"] <= study.BASES[name][1]
