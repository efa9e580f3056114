"""Conditions of findings on closed loops: parts of the study, small, against plain reckoning."""

import numpy as np
import pytest

from ddlib.setups import JOINT_DAMPING
from workshop.beyond.studies.loop import learners
from workshop.beyond.studies.loop.chain import chain, extents, recorded
from workshop.beyond.studies.loop.runs import conditions as study


@pytest.fixture(scope="module")
def five():
    return recorded(chain(2), extents(2, 5, 0), 0).thinned(150)


def test_equations_need_the_copy_and_not_the_plan():
    found = study._copies(JOINT_DAMPING, range(1))
    error = {name: float(value[0]) for name, value in found.items()}
    assert error["0.1"] < 0.1 * error["0"] < error["none"]


def test_the_choice_is_the_least_error_of_motions_left_out(five, monkeypatch):
    courses = {1e-6: [9, 5, 7], 1e-3: [9, 6, 2], 1e-2: [9, 3, 3]}
    seen = []

    def course(training, test, seed, decay):
        seen.append((training.runs, test.runs))
        return np.array(courses[decay], float)[:, None]

    monkeypatch.setattr(study, "_course", course)
    assert study._chosen_decay(five, 0) == (1e-3, 2)
    assert set(seen) == {(4, 1)} and len(seen) == 5 * len(study._DECAYS)


def test_the_elbow_goes_later_and_both_come_back():
    draw = learners.Draw(JOINT_DAMPING, seeds=1)
    q, qd, _ = study._out_of_step(draw)
    moving = np.abs(qd[0]) > 1e-3
    first = moving.argmax(0) * 0.002
    assert first[1] - first[0] == pytest.approx(0.9, abs=0.05)
    rate = np.gradient(q[0], 0.002, axis=0)
    assert np.abs(rate - qd[0])[5:-5].max() < 0.02
    np.testing.assert_allclose(q[0, [0, -1]], 0, atol=1e-9)
    lowest = np.rad2deg(-q[0].min(0))
    np.testing.assert_allclose(lowest, draw.learnt[0], rtol=1e-3)
