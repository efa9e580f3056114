"""Learners in the loop: their steps against other truths, and what they do to a run."""

import numpy as np
import pytest

from beyond.control.online import LastLayer, OnlineDescent, OnlineFeedforward
from ddlib.control import pd, proportional
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.identification import RecursiveLeastSquares
from ddlib.learning import Scaler, TorqueModel, Weights
from ddlib.simulation import record

WIDTH = 5
INPUTS = Scaler(np.array([-0.8, -0.9]), np.array([0.1, 0.2]))
OUTPUTS = Scaler(np.array([-60.0, -15.0]), np.array([50.0, 14.0]), (0.2, 0.8))
FEEDBACK = pd((300.0, 90.0), (35.0, 10.0))
EXTENTS = (40.0, 30.0)
SHORT = {"duration": 1.0, "rest": 0.1}


def model(members=3, seed=0):
    return TorqueModel(Weights.random(members, WIDTH, seed=seed), INPUTS, OUTPUTS)


def windows(seed=1, cases=6):
    return np.random.default_rng(seed).uniform(-0.8, 0.2, (cases, 2, WIDTH))


@pytest.mark.parametrize("part", ["hidden", "output"])
def test_a_step_of_descent_is_the_gradient_by_differences(part):
    wanted = np.random.default_rng(2).uniform(-20, 20, (6, 2))
    before = OnlineDescent(model(1), rate=1.0)
    before.hidden, before.output = before.hidden[0], before.output[0]

    def cost(learner):
        off = learner.scaled(wanted) - learner.scaled(learner.torque(windows()))
        return 0.5 * (off**2).sum(-1).mean()

    step = before.gradient(windows(), torque=wanted)[part == "output"]
    weights, rng = getattr(before, part), np.random.default_rng(3)
    for _ in range(8):
        place, tiny = tuple(rng.integers(0, weights.shape)), np.zeros_like(weights)
        tiny[place] = 1e-5
        ends = []
        for sign in (1, -1):
            setattr(before, part, weights + sign * tiny)
            ends.append(cost(before))
        setattr(before, part, weights)
        assert -(ends[0] - ends[1]) / 2e-5 == pytest.approx(step[place], rel=1e-5, abs=1e-9)


@pytest.mark.parametrize("forgetting", [1.0, 0.97])
def test_recursive_least_squares_on_line_is_batch_least_squares(forgetting):
    networks, rng = model(2), np.random.default_rng(0)
    learner = LastLayer(networks, lambda w: RecursiveLeastSquares(w, 0.2, forgetting))
    first = learner.output
    each, torque = rng.uniform(-0.8, 0.2, (2, 30, 2, WIDTH)), rng.uniform(-40, 40, (2, 30, 2))
    torque[..., 1] /= 4
    for k in range(30):
        learner.learn(each[:, k], torque[:, k])
    y = OUTPUTS.scale(torque)
    y = np.log(y / (1 - y))
    for k in range(2):
        x = networks[k].weights.activity(networks.scaled(each[k]))[0]
        x = np.hstack([x, networks.scaled(each[k]).reshape(30, -1), np.ones((30, 1))])
        age = forgetting ** np.arange(30)[::-1]
        ridge = 0.2 * forgetting**30 * np.eye(x.shape[1])
        wanted = np.linalg.solve((x.T * age) @ x + ridge, (x.T * age) @ y[k] + ridge @ first[k].T)
        np.testing.assert_allclose(learner.output[k], wanted.T, rtol=1e-6, atol=1e-8)


class Noting:
    """A learner that gives a constant torque and keeps what it is taught."""

    def __init__(self, level):
        self.level, self.seen = level, []

    def torque(self, windows):
        return self.level + 0 * windows[..., 0]

    def learn(self, windows, torque):
        self.seen.append((windows, torque))

    correct = learn


def test_measured_windows_are_learnt_with_the_torque_at_their_centre():
    learner = Noting(2.0)
    run = record(ARM, OnlineFeedforward(learner, FEEDBACK, WIDTH), EXTENTS, **SHORT)
    moving = np.flatnonzero((run.t > -1e-9) & (run.t < 1.0 - 1e-9))
    assert len(learner.seen) == len(moving)
    for (window, torque), k in list(zip(learner.seen, moving))[::17]:
        np.testing.assert_allclose(window, run.q[k - 2 : k + 3].T, atol=1e-12)
        np.testing.assert_allclose(torque, run.tau_true[k], rtol=1e-9)


def test_desired_windows_are_learnt_with_the_feedback():
    learner = Noting(0.0)
    law = OnlineFeedforward(learner, proportional((300.0, 90.0)), WIDTH, "feedback")
    run = record(ARM, law, EXTENTS, **SHORT)
    centre = np.flatnonzero(run.t > -1e-9)[40]
    window, feedback = learner.seen[40]
    wanted = run.reference.q[centre - 2 : centre + 3].T
    np.testing.assert_allclose(window, wanted, atol=1e-12)
    np.testing.assert_allclose(feedback, run.tau_true[centre], rtol=1e-9)
