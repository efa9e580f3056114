"""Measures of torques at run time, on planted results with answers known by hand."""

import numpy as np
import pytest
from scipy.stats import spearmanr

from workshop.beyond.measures.loop import run_time as measured
from workshop.report import results

JD, SF = "joint damping", "state feedback"
SPREAD = np.array([0.9, 0.95, 1.0, 1.05, 1.1])


def line(error, **others):
    row = {"whole": error * SPREAD, "inside": 0.8 * error * SPREAD, "outside": 2 * error * SPREAD}
    return row | others


def inside(stopped, error, poles):
    return {name: np.tile(x, (5, 1)) for name, x in
            (("stopped", stopped), ("error", error), ("poles", poles))}  # fmt: skip


def planted():
    rng = np.random.default_rng(0)
    square = {"none": line(30.0), "exact": line(20.0), "exact, window 21": line(3.0)}
    scatter = {}
    for width, error in ((11, 5.0), (21, 4.0), (41, 8.0)):
        whole = error * (1 + 0.1 * rng.standard_normal(25))
        square[f"network, window {width}"] = line(error) | {"whole": whole}
        scatter[str(width)] = {
            "end point": whole, "RMSS": whole**2, "through the loop": -whole,
            "planned": np.exp(whole),
        }  # fmt: skip
    for kind, error in zip(measured.KINDS, (6.0, 7.0, 8.0, 9.0, 10.0)):
        square[kind] = line(error, RMSS=10 * error * SPREAD)
    return {
        "square": square,
        "scatter": scatter,
        "corner": {"rounded": {"0.1": {"exact": 0.1 * SPREAD, "network": 2 * SPREAD}}},
        "rates": {"window": 2 * SPREAD, "hold": 3 * SPREAD},
        "changed": {"load": {"10": {"none": 50 * SPREAD, "network": 20 * SPREAD}}},
        "gains": {
            "0.0625": {"none": 100 * SPREAD, "network": 40 * SPREAD, "exact, window": 4 * SPREAD},
            "1": {"none": 20 * SPREAD, "network": 2 * SPREAD, "exact, window": 2 * SPREAD},
        },
        "bound": {"share": np.array([0.2, 0.3, 0.5, 0.1, 0.4])},
        "inside": {
            "network, 0": inside([0, 0, 0, 1], [4, 2, 3, 9], [0.99, 0.98, 0.995, 1.005]),
            "network, 5": inside([0, 0.6, 1, 1], [4, 2, 3, 3.5], [0.99, 0.98, 0.99, 0.995]),
        },
    }


@pytest.fixture(autouse=True)
def plant(monkeypatch):
    found = {"shares": [0.0, 1.0, 2.0, 4.0], "readings": {JD: planted(), SF: planted()}}
    monkeypatch.setattr(results, "read", lambda name: {"run-time": found}[name])
    return found


def test_ratios_of_medians():
    assert measured.ratio("exact", "none").value == pytest.approx(2 / 3)
    across = measured.ratio("exact", "exact", "outside", "inside")
    assert across.value == pytest.approx(2.5) and across.replicates.min() > 1.5
    network = measured.ratio()
    assert network.value == pytest.approx(np.median(measured.errors()) / 30)
    assert "30 mm" in network.text
    assert measured.side_ratio("load", "10").value == pytest.approx(0.4)
    corner = measured.side_ratio("rounded", "0.1", "exact", "network")
    assert corner.value == pytest.approx(0.05)
    assert measured.rate("hold", SF).value == pytest.approx(1.5)


def test_the_best_window():
    found = measured.best_window()
    cells = [np.median(measured.errors(f"network, window {w}")) for w in (11, 21, 41)]
    assert found.value == pytest.approx(cells[1] / min(cells[0], cells[2])) and found.value < 1


def test_what_feedback_hides():
    assert measured.hidden_by_feedback().value == pytest.approx(0.1 / 0.4)
    assert measured.hidden_by_feedback("exact, window").value == pytest.approx(1 / 10)


def test_rank_correlation_is_scipys():
    rng = np.random.default_rng(1)
    a, b = rng.integers(0, 6, (2, 4, 30)).astype(float)
    wanted = [spearmanr(x, y)[0] for x, y in zip(a, b)]
    np.testing.assert_allclose(measured.rank_correlation(a, b), wanted, atol=1e-12)


def test_predictors_in_order_and_against_it():
    assert measured.predicts("RMSS", 21).value == pytest.approx(1)
    assert measured.predicts("through the loop", 41).value == pytest.approx(-1)
    assert len(measured.scatter("planned")[0]) == 75
    assert measured.predicts_better().value == pytest.approx(-2)
    assert measured.predicts_better("planned").value == pytest.approx(0, abs=1e-12)


def test_kinds_by_their_medians(plant):
    assert measured.predicts_kind().value == pytest.approx(
        spearmanr([60, 70, 80, 90, 100, 16], [6, 7, 8, 9, 10, 4])[0]
    )
    square = plant["readings"][JD]["square"]
    square["identified"]["whole"] = 50 * SPREAD
    assert measured.predicts_kind().value < 0.7 < measured.predicts_kind(SF).value


def test_the_bound_is_the_largest_of_all():
    found = measured.within_bound()
    assert found.value == 0.5 and found.replicates.max() == 0.5


def test_where_a_loop_turns():
    assert measured.inside_share().value == pytest.approx(0.5)
    assert (measured.stops_at(late=5) == 1).all() and (measured.stops_at() == 4).all()
    assert measured.unstable_at(late=5).value == 1
    predicted, simulated = measured.onsets()
    assert predicted == pytest.approx(3.0) and simulated == pytest.approx(2 + 2 / 6)
    assert measured.onset().value == pytest.approx(3 / (2 + 2 / 6))
    assert np.isinf(measured.onsets(late=5)).all()
