"""The study of rivals: who takes part, what is asked, what is kept."""

import numpy as np

from beyond.studies import lineup, rivals
from ddlib.analysis import inside_hull
from ddlib.learning import Weights
from ddlib.setups import STATE_FEEDBACK
from workshop.report import results


def test_the_budget_is_the_papers_network():
    weights = Weights.random(1, rivals.WINDOW)[0]
    assert weights.count(biases=True) + 4 == rivals.NUMBERS_BUDGET
    rows = [r for r in results.read("rivals")["rows"] if r["rival"] == lineup.REFERENCE]
    assert max(r["count"] for r in rows) == rivals.NUMBERS_BUDGET


def test_the_square_is_recorded_on_a_grid_up_to_45_degrees():
    found = rivals.square_recordings(STATE_FEEDBACK, 3)
    np.testing.assert_allclose(found.extents_deg[:4], [[15, 15], [15, 30], [15, 45], [30, 15]])
    assert found.extents_deg[-1].tolist() == [45.0, 45.0] and found.inside[-1]
    assert found.inside.tolist() == [bool(inside_hull(each)) for each in found.extents_deg]
    alone = STATE_FEEDBACK.record(found.extents_deg[1])
    assert found.recording.q.shape == (9, *alone.q.shape)
    reach = np.abs(found.recording.reference.q).max(-2)
    np.testing.assert_allclose(reach, np.deg2rad(found.extents_deg), rtol=1e-3)
