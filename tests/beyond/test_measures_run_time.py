"""Measures of torques at run time, on planted results with answers known by hand."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from beyond.chapters import run_time
from workshop.report import results
from workshop.report.evidence.verdicts import rank_correlation

pytestmark = pytest.mark.usefixtures("planted_members")


def inside(stopped, error, poles):
    found = {"stopped": stopped, "error": error, "poles": poles}
    return {name: np.tile(x, (5, 1)) for name, x in found.items()}


@pytest.fixture
def plant(monkeypatch):
    loops = {
        "network, 0": inside([0, 0, 0, 1], [4, 2, 3, 9], [0.99, 0.98, 0.995, 1.005]),
        "network, 5": inside([0.4, 0.6, 1, 1], [4, 2, 3, 3.5], [0.99, 0.98, 0.99, 0.995]),
    }
    found = {"shares": [0.0, 1.0, 2.0, 4.0], "readings": {"joint damping": {"inside": loops}}}
    monkeypatch.setattr(results, "read", {"run-time": found}.__getitem__)
    return loops


def test_rank_correlation_is_scipys():
    a, b = np.random.default_rng(1).integers(0, 6, (2, 4, 30)).astype(float)
    wanted = [spearmanr(x, y)[0] for x, y in zip(a, b)]
    np.testing.assert_allclose(rank_correlation(a, b), wanted, atol=1e-12)


def test_where_a_loop_turns(plant):
    assert run_time.unstable_at().value == 4 and run_time.unstable_at(late=5).value == 1
    predicted, simulated = run_time.onsets()
    assert predicted == pytest.approx(3.0) and simulated == pytest.approx(2 + 2 / 6)
    assert run_time.onset().value == pytest.approx(3 / (2 + 2 / 6))
    plant["exact, window, 0"] = plant["network, 5"]  # does not come so far
    assert np.isinf(run_time.onsets("exact, window")).all()
