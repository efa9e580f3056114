"""Rivals on a planted study: sizes within the budget, and what has less error by day."""

import numpy as np
import pytest

from beyond.measures import rivals as measures
from workshop.report import results

pytestmark = pytest.mark.usefixtures("planted_members")

DAY = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])  # hard days are hard for all
ROWS = [
    ("network", 2, 40, 3 * DAY), ("network", 10, 100, DAY), ("small", 1, 10, 2 * DAY),
    ("small", 2, 90, 0.5 * DAY[:5]), ("small", 3, 101, 0.1 * DAY), ("large", 1, 1000, 0.25 * DAY),
    ("large", 2, 5000, 0.01 * DAY), ("worse", 1, 20, 4 * DAY),
]  # fmt: skip


@pytest.fixture(autouse=True)
def planted(monkeypatch):
    rows = [
        {"rival": r, "inputs": "positions", "size": s, "count": c, "errors": {"trajectory 6": e}}
        for r, s, c, e in ROWS
    ]
    study = {"reference": "network", "budget": 100, "rows": rows}
    study["lines"] = dict.fromkeys(r for r, *_ in ROWS)
    tuned = {
        "network": (True, DAY), "small": (True, 0.5 * DAY[:5]), "worse": (True, 4 * DAY),
        "large": (False, 0.1 * DAY), "ours": (True, 0.1 * DAY),
    }  # fmt: skip
    rows = {n: {"within": w, "errors": {"trajectory 6": e}} for n, (w, e) in tuned.items()}
    tuned = {"reference": "network", "own": "ours", "rivals": rows}
    monkeypatch.setattr(results, "read", {"rivals": study, "tuned": tuned}.__getitem__)


def test_the_size_is_the_largest_within_the_budget():
    sizes = {name: measures.row(name)["size"] for name in ("network", "small", "large")}
    assert sizes == {"network": 10, "small": 2, "large": 1}  # of large none is: the smallest
    assert measures.row("small", size=3)["count"] == 101
    for wrong in (("nobody",), ("small", "exact states"), ("small", "positions", 9)):
        with pytest.raises(ValueError, match="rival must be one of the study"):
            measures.row(*wrong)


def test_the_share_of_better_ones_counts_what_is_as_cheap():
    found = measures.better()
    assert found.value == 0.5 and found.text == "1 of 2: small"
