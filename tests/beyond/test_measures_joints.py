"""Measures of arms of more joints, on planted results with answers known by hand."""

import numpy as np
import pytest

from workshop.beyond.measures.loop import joints as measures
from workshop.report import results

FIVE = 0.9, 1.0, 1.1, 1.0, 1.0


def row(joints, motions, error, linear=0.5):
    each = error * np.array(FIVE)
    return {
        "joints": joints, "motions": motions, "test": each, "training": each / 2,
        "linear": linear * np.array(FIVE), "by joint": np.tile(each[:, None], joints),
    }  # fmt: skip


@pytest.fixture
def plant(monkeypatch):
    """``plant(**parts)`` puts a result in place of the committed one."""

    def put(**parts):
        monkeypatch.setattr(results, "read", lambda name: {"joints": parts}[name])

    return put


def test_ratios_of_medians(plant):
    known = [{"joints": 4, "motions": 5, "test": [0.1, 0.2, 0.4]}]
    plant(**{"windows": [row(4, 5, 0.8), row(2, 5, 0.2)], "known structure": known})
    assert measures.over_two().value == pytest.approx(4)
    assert measures.over_rival().value == pytest.approx(1.6)
    assert measures.over_rival(rival="known structure").value == pytest.approx(4)
    assert measures.over_two().replicates.min() >= 0.8 * 0.9 / (0.2 * 1.1)


def test_joints_three_and_four_alone(plant):
    cell = row(4, 20, 1.0)
    cell["by joint"] = np.tile([9.0, 9.0, 0.3, 0.4], (5, 1))
    plant(windows=[cell])
    assert measures.by_group(20).value == pytest.approx(np.sqrt((0.09 + 0.16) / 2))


def test_what_is_needed_lies_between_the_numbers_tried(plant):
    plant(windows=[row(3, 5, 0.8), row(3, 20, 0.2), row(3, 80, 0.05)])
    assert measures.needed(3, 0.4)[0] == pytest.approx(10)
    assert measures.needed(3, 0.1)[0] == pytest.approx(40)
    assert measures.needed(3, 0.9)[0] == 5
    assert measures.needed(3, 0.01)[0] == np.inf


def test_it_is_needed_until_the_last_crossing(plant):
    plant(windows=[row(3, 5, 0.1), row(3, 10, 0.8), row(3, 40, 0.2)])
    assert measures.needed(3, 0.4)[0] == pytest.approx(20)


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_a_planted_law_is_found(plant, power):
    rows = []
    for n in (1, 2, 4, 7):
        motions = np.array([0.5, 2.0]) * 4 * n**power
        rows += [row(n, m, e) for m, e in zip(motions, (0.4, 0.1))]
    plant(windows=rows)
    found = measures.growth(0.2)
    assert found.value == pytest.approx(power)
    assert np.percentile(found.replicates, 1) < power < np.percentile(found.replicates, 99)
    joints, motions, _ = measures.law(0.2)
    np.testing.assert_allclose(joints, [2, 4, 7])
    np.testing.assert_allclose(motions[0], 4 * joints**power)


def test_couplings_leave_out_a_joint_by_itself(plant):
    inertia = np.array([[5.0, 1.0, 0.2], [1.0, 2.0, 0.3], [0.2, 0.3, 1.0]])
    real = inertia * (1 + 9 * np.eye(3))
    null = np.ones((3, 3)) - inertia
    pairs = {
        "inertia": inertia, "gains": {"real": [real] * 5, "unrelated": [null] * 5},
        "acceleration": [1.0, 1.0, 1.0], "deviation": [1.0, 1.0, 1.0],
    }  # fmt: skip
    plant(pairs=pairs)
    assert measures.couplings().value == pytest.approx(1)
    assert measures.couplings("unrelated").value == pytest.approx(-1)
    assert measures.gain_error().value == pytest.approx(9 * 5 / np.sqrt(26.04))


def test_gains_are_shares_of_the_torque(plant):
    one = np.ones((2, 2))
    pairs = {
        "inertia": one, "gains": {"real": [one] * 5}, "acceleration": [3.0, 5.0],
        "deviation": [1.0, 2.0],
    }  # fmt: skip
    plant(pairs=pairs)
    np.testing.assert_allclose(measures.scaled()[1], [[3, 5], [1.5, 2.5]])


def test_costs_and_interactions(plant):
    costs = [{"joints": n, "network": 10 * n**2, "recursion": 20 * n} for n in (2, 3, 4)]
    plant(costs=costs, interactions={"2": [0.3, 0.4], "4": [0.5] * 4})
    assert measures.cost_over("recursion", 4).value == pytest.approx(2)
    assert measures.cost_grows("network").value == pytest.approx(2)
    assert measures.cost_grows("recursion").value == pytest.approx(1)
    assert measures.interactions().value == pytest.approx(0.5 / np.sqrt(0.125))


def test_random_states_and_two_joints(plant):
    states = [
        {"joints": n, "units": 10, "samples": 1000, "test": e * np.array(FIVE)}
        for n, e in ((2, 0.1), (4, 0.6))
    ]
    loops = [
        {
            "reading": "joint damping",
            "motions": 20,
            "kind": k,
            "taps": 5,
            "test": e * np.array(FIVE),
        }
        for k, e in (("closed loop", 0.2), ("answered", 0.3))
    ]
    plant(**{"random states": states, "closed loops": loops})
    assert measures.states_over_two().value == pytest.approx(6)
    assert measures.followed().value == pytest.approx(1.5)
