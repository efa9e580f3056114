"""The study of rivals: who takes part, what is asked, what is kept."""

import numpy as np

from beyond.rivals.identified import Linear
from beyond.rivals.tables import _Nearest
from beyond.studies import lineup, rivals
from ddlib.learning import Weights
from ddlib.setups import STATE_FEEDBACK, inside_hull
from workshop.report import results


def test_the_budget_is_the_papers_network():
    weights = Weights.random(1, rivals._SAMPLES)[0]
    assert weights.count(biases=True) + 4 == rivals._BUDGET
    rows = [r for r in results.read("rivals")["rows"] if r["rival"] == lineup._REFERENCE]
    assert max(r["count"] for r in rows) == rivals._BUDGET


def test_the_study_counts_and_keeps(monkeypatch, tmp_path):
    nearest = lineup._Line(lambda *_: _Nearest(beyond="edge"), (1,), "cases", "tables", 1)
    filters = lineup._Line(lambda n, _: Linear(width=n, ridge=0.0), (5, 21), "samples", "filters")
    monkeypatch.setattr(rivals, "_LINES", {"nearest": nearest, "filter": filters})
    monkeypatch.setattr(rivals, "_RECORDINGS", 2)
    monkeypatch.setattr(rivals, "_TORQUES", tmp_path / "torques.npz")
    rows = {(r["rival"], r["inputs"], r["size"]): r for r in rivals._rivals()["rows"]}
    names = [("nearest", inputs, 1) for inputs in rivals._INPUTS]
    assert set(rows) == {*names, ("filter", "positions", 5), ("filter", "positions", 21)}
    assert len(rows["nearest", "positions", 1]["seconds"]) == 1
    wide = rows["filter", "positions", 21]
    assert len(wide["errors"]["outside"]) == 2 and wide["count"] == 86
    assert wide["errors"]["trajectory 6"][0] != wide["errors"]["trajectory 6"][1]  # other noise
    with np.load(tmp_path / "torques.npz") as kept:
        assert kept["names"].tolist() == ["measured", "nearest", "filter"]
        _, asked = rivals.recorded(1)
        wanted = asked.torque.reshape(rivals._GRID**2, 30, 2)
        np.testing.assert_allclose(kept["torque"][0], wanted, rtol=1e-3, atol=1e-3)


def test_the_square_is_recorded_on_a_grid_up_to_45_degrees():
    found = rivals._square(STATE_FEEDBACK, 3)
    np.testing.assert_allclose(found.extents_deg[:4], [[15, 15], [15, 30], [15, 45], [30, 15]])
    assert found.extents_deg[-1].tolist() == [45.0, 45.0] and found.inside[-1]
    assert found.inside.tolist() == [bool(inside_hull(each)) for each in found.extents_deg]
    alone = STATE_FEEDBACK.record(found.extents_deg[1])
    assert found.recording.q.shape == (9, *alone.q.shape)
    reach = np.abs(found.recording.reference.q).max(-2)
    np.testing.assert_allclose(reach, np.deg2rad(found.extents_deg), rtol=1e-3)
