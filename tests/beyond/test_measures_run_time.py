"""Measures of torques at run time, on planted results with answers known by hand."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from workshop.beyond.measures.loop import run_time as measured
from workshop.report import results
from workshop.report.evidence.verdicts import rank_correlation

JD, SF = "joint damping", "state feedback"
SPREAD = np.array([0.9, 0.95, 1.0, 1.05, 1.1])


def inside(stopped, error, poles):
    found = {"stopped": stopped, "error": error, "poles": poles}
    return {name: np.tile(x, (5, 1)) for name, x in found.items()}


def planted():
    rng = np.random.default_rng(0)
    square = {
        kind: {"whole": error * SPREAD, "RMSS": 10 * error * SPREAD}
        for kind, error in zip(measured.KINDS, (6.0, 7.0, 8.0, 9.0, 10.0))
    }
    scatter = {}
    for width, error in ((11, 5.0), (21, 4.0), (41, 8.0)):
        whole = error * (1 + 0.1 * rng.standard_normal(25))
        scatter[str(width)] = {
            "end point": whole, "RMSS": whole**2, "through the loop": -whole,
            "planned": np.exp(whole),
        }  # fmt: skip
    return {"square": square, "scatter": scatter, "inside": {
        "network, 0": inside([0, 0, 0, 1], [4, 2, 3, 9], [0.99, 0.98, 0.995, 1.005]),
        "network, 5": inside([0, 0.6, 1, 1], [4, 2, 3, 3.5], [0.99, 0.98, 0.99, 0.995]),
    }}  # fmt: skip


@pytest.fixture(autouse=True)
def plant(monkeypatch):
    found = {"shares": [0.0, 1.0, 2.0, 4.0], "readings": {JD: planted(), SF: planted()}}
    monkeypatch.setattr(results, "read", {"run-time": found}.__getitem__)
    return found


def test_rank_correlation_is_scipys():
    a, b = np.random.default_rng(1).integers(0, 6, (2, 4, 30)).astype(float)
    wanted = [spearmanr(x, y)[0] for x, y in zip(a, b)]
    np.testing.assert_allclose(rank_correlation(a, b), wanted, atol=1e-12)


def test_where_a_loop_turns(plant):
    assert measured.unstable_at().value == 4 and measured.unstable_at(late=5).value == 1
    predicted, simulated = measured.onsets()
    assert predicted == pytest.approx(3.0) and simulated == pytest.approx(2 + 2 / 6)
    assert measured.onset().value == pytest.approx(3 / (2 + 2 / 6))
    loops = plant["readings"][JD]["inside"]
    loops["exact, window, 0"] = loops["network, 5"]  # does not come so far
    assert np.isinf(measured.onsets("exact, window")).all()
