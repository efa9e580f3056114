"""Rivals on a planted study: sizes within the budget, and what has less error by day."""

import numpy as np
import pytest

from beyond.measures import rivals as measures

pytestmark = pytest.mark.usefixtures("planted_members")

DAY = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])  # hard days are hard for all
ROWS = [
    ("network", 2, 40), ("network", 10, 100), ("small", 1, 10), ("small", 2, 90),
    ("small", 3, 101), ("large", 1, 1000), ("large", 2, 5000),
]  # fmt: skip


@pytest.fixture(autouse=True)
def planted(planted_results):
    rows = [{"rival": r, "inputs": "positions", "size": s, "count": c} for r, s, c in ROWS]
    tuned = {
        "network": (True, DAY), "small": (True, 0.5 * DAY[:5]), "worse": (True, 4 * DAY),
        "slow": (True, 2 * DAY), "large": (False, 0.1 * DAY), "ours": (True, 0.1 * DAY),
    }  # fmt: skip
    rivals = {n: {"within": w, "errors": {"trajectory 6": e}} for n, (w, e) in tuned.items()}
    planted_results(
        rivals={"budget": 100, "rows": rows},
        tuned={"reference": "network", "own": "ours", "rivals": rivals},
    )


def test_the_size_is_the_largest_within_the_budget():
    sizes = {name: measures.row(name)["size"] for name in ("network", "small", "large")}
    assert sizes == {"network": 10, "small": 2, "large": 1}  # of large none is: the smallest
    assert measures.row("small", size=3)["count"] == 101


def test_the_share_of_better_ones_counts_what_is_as_cheap():
    found = measures.better()
    assert found.value == pytest.approx(1 / 3) and found.text == "1 of 3: small"
