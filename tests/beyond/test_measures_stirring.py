"""Measures of stirring on planted studies."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import stirring as measures
from workshop.report import results

DAY = np.array([1.0, 1.2, 0.8, 1.1, 0.9, 1.05])


def told(size):
    """Errors by day: RMSS, and joints whose root mean square is `size` times the day's factor."""
    return np.stack([0.1 * size * DAY, np.sqrt(1.5) * size * DAY, np.sqrt(0.5) * size * DAY], 1)


def learnt(own, other):
    return {
        "pick and place": {"pick and place": told(own), "circles": told(other)},
        "circles": {"pick and place": told(2 * other), "circles": told(2 * own)},
    }


def filters(velocity, unique):
    classes = np.stack([velocity + 0 * DAY, 1 - velocity + 0 * DAY], 1)
    return {"classes": classes, "unique": np.full((len(DAY), 3), [0.1, unique, 0.2])}


@pytest.fixture(autouse=True)
def planted(monkeypatch):
    found = {
        "errors": {"network": learnt(1, 10), "identified": learnt(2, 3)},
        "wider": {"41": {name: rows for name, rows in learnt(1, 30).items()}},
        "coverage": {
            "all": {"circles": {"other family": {"shared": 0.02}, "same family": {"shared": 0.8}}}
        },
        "hands": {
            "none": {"circles": [[8.0, 12.0, 10.0]]},
            "good": {"circles": [[1.0, 3.0, 2.0]] * 6},
            "bad": {"circles": np.multiply.outer(DAY, [19.0, 21.0, 20.0])},
        },
        "filters": {
            "classes": ["velocity", "jerk"],
            "circles": {"real": filters(0.4, 0.5), "phases": filters(0.1, 0.3)},
            "pick and place": {"real": filters(0.35, 0.45), "phases": filters(0.0, 0.1)},
        },
    }
    monkeypatch.setattr(
        results, "read", lambda name: {"stirring": {"setups": {"joint damping": found}}}[name]
    )


def test_joints_are_pooled_in_newton_metres():
    np.testing.assert_allclose(measures.error("network", "pick and place", "circles"), 10 * DAY)
    found = measures.error("network", "pick and place", "circles", width=41)
    np.testing.assert_allclose(found, 30 * DAY)
    np.testing.assert_allclose(
        measures.pooled_rmss("network", "pick and place", "pick and place"), 0.1 * DAY
    )


def test_transfer_is_against_those_that_learnt_the_test():
    found = measures.transfer()
    assert found.value == pytest.approx(5)  # 10 over 2
    np.testing.assert_allclose(found.replicates, 5)  # days go together
    back = measures.transfer("identified", "circles", "pick and place")
    assert back.value == pytest.approx(3) and "pick and place" in back.text
    assert measures.transfer(against="pick and place").value == pytest.approx(1)


def test_rivals_are_compared_on_the_same_test():
    assert measures.instead("identified").value == pytest.approx(0.3)
    harder = measures.asked_over("network", "pick and place", "circles", "pick and place")
    assert harder.value == pytest.approx(10)


def test_shares_are_against_another_draw():
    assert measures.shared().value == pytest.approx(0.025)


def test_hands_are_medians_over_a_family():
    np.testing.assert_allclose(measures.hand("bad"), 20 * DAY)
    assert measures.hand_over("bad").value == pytest.approx(2.05)
    assert measures.hand_over("good", "none").value == pytest.approx(0.2)
    single = measures.hand_over("none", "good")
    assert single.value == pytest.approx(5) and single.replicates is None


def test_filters_are_compared_with_nulls_and_with_the_other_family():
    assert measures.velocity_share().value == pytest.approx(0.3)
    assert measures.velocity_share("pick and place").value == pytest.approx(0.05)
    assert measures.follows().value == pytest.approx(0.2)
    assert measures.follows(2, "pick and place").value == pytest.approx(0)


def test_appendix_i_turns_once(monkeypatch):
    assert measures.turns().value is True
    twice = lambda extents, t: type("", (), {"qd": np.sin(6 * t)[:, None] * np.ones((6, 1, 2))})  # noqa: E731
    monkeypatch.setattr(measures, "pick_and_place", twice)
    assert measures.turns().value is False
