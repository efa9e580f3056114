"""Feedback-error learning: the identity with Slotine & Li, and what it learns."""

import numpy as np

from beyond.control.adaptive import PARAMETERS, SlotineLi, Watched
from beyond.control.feedback_error import (
    FeedbackErrorLearning,
    MotionMemory,
    RigidBodyTerms,
)
from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.simulation import record

GAIN, SLOPE = 30.0, np.array([8.0, 6.0])
RATE = np.array([2.0, 0.5, 0.2, 10.0, 4.0])
NAMES = (*PARAMETERS[:3], "F_v1", "F_v2")
TEACHER = pd(tuple(GAIN * SLOPE), (GAIN, GAIN))


def learner(rate=RATE / GAIN, weights=(0.0,) * 5, names=NAMES):
    return FeedbackErrorLearning(RigidBodyTerms(names), rate, weights, TEACHER)


def both(extents, **change):
    fixed = dict(gain=(GAIN, GAIN), slope=SLOPE, rate=RATE, estimate=np.zeros(5), names=NAMES)
    ours = Watched(learner())
    theirs = Watched(SlotineLi(**fixed, **{"at": "desired", **change}))
    runs = [record(ARM, law, extents, duration=1.0, rest=0.2) for law in (ours, theirs)]
    return runs, ours.law.weights, theirs.law.estimates


def test_it_is_slotine_and_li_at_the_desired_state_with_another_gain():
    runs, weights, estimates = both([[40.0, 30.0], [10.0, 45.0]])
    assert np.abs(weights[..., -1, :]).max() > 0.1
    np.testing.assert_allclose(weights, estimates, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(runs[0].tau_true, runs[1].tau_true, rtol=1e-12, atol=1e-11)
    _, weights, estimates = both((40.0, 30.0), at="measured")
    assert np.abs(weights - estimates).max() > 1e-3


def test_a_memory_learns_its_motion_and_no_other():
    extents, errors = np.array([[40.0, 30.0]]), []
    memory = MotionMemory(pd((300.0, 90.0), (35.0, 10.0)), 0.3, lead=25, smoothing=5)
    bare = record(ARM, memory, [[10.0, 45.0]]).tracking_error
    for _ in range(8):
        watched = Watched(memory)
        errors.append(np.abs(record(ARM, watched, extents).tracking_error).mean())
        memory.learn(watched.law)
    assert errors[-1] < 0.35 * errors[0]
    other = record(ARM, memory, [[10.0, 45.0]]).tracking_error
    assert np.abs(other).mean() > np.abs(bare).mean()
