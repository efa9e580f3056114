"""Learners in the loop: what they begin with, what a trial reports, and what it rests on."""

import numpy as np
import pytest

from beyond.studies.loop import _learning as learning, learners
from ddlib.control import Feedforward
from ddlib.dynamics import end_point_error
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import follow
from ddlib.trajectories import Trajectory


@pytest.fixture(scope="module")
def draw():
    return learners.Draw(STATE_FEEDBACK, first=2000, seeds=2)


def test_learners_from_nothing_give_no_torque(draw):
    t, motion = learners.motions(draw)["the same"]
    one = Trajectory(*(x[None] for x in motion))
    plain = Feedforward(lambda q, qd, qdd: 0 * q, draw.setup.controller)
    alone, _ = learning._trial(draw, [plain], [1], one, t)
    for name, learner in learners._lineup(draw).items():
        errors, stops = learning._trial(draw, [learner.controller(False)], [1], one, t)
        np.testing.assert_allclose(errors, alone, rtol=1e-6, err_msg=name)
        assert not np.any(stops.stopped)


def test_errors_of_a_trial_are_those_of_the_hand_during_the_motion(draw):
    t, motion = learners.motions(draw)["in half the time"]
    one = Trajectory(*(x[None] for x in motion))
    exact = Feedforward(draw.equations, draw.setup.controller)
    errors, _ = learning._trial(draw, [exact], [1], one, t)
    run = follow(draw.setup.arm, exact, one, t, effects=draw.effects, duration=1.5)
    off = end_point_error(draw.setup.arm, run.reference.q, run.q_true)[..., run.motion, :]
    np.testing.assert_allclose(errors, 1e3 * np.sqrt((off**2).sum(-1).mean(-1)), rtol=1e-9)
    assert errors.max() < 2.0
