"""The committed sweep over samples, units and epochs: a sample of it solved anew."""

import numpy as np
import pytest

from ddlib.learning import NotConverged
from workshop.report import results
from workshop.report.exact_states import SAMPLES
from workshop.report.studies import states as study


@pytest.fixture(scope="module")
def found():
    return results.read("state-space-sizes")


def test_the_same_cases_give_the_same_errors(found):
    """One small training set, solved anew."""
    row = next(row for row in found["samples"] if row["samples"] == SAMPLES)
    with pytest.warns(NotConverged):  # as the page says: stopped before its end
        again = study._solve(SAMPLES, 1)
    for what in ("training", "test"):
        assert row["solver"][what][0] == pytest.approx(again[what][0], rel=0.1)
    assert all(np.min(row["solver"]["gradient"]) > 0 for row in found["samples"])
