"""Circles, via points and their study: families, what is learnt and asked, the picker's file."""

import itertools

import numpy as np
import pytest

from beyond.chapters.stirring import needed
from beyond.studies.loop import motions, stirring
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.setups import JOINT_DAMPING
from ddlib.trajectories import MOTION_SECONDS

T = motions.times()
INSIDE = (T >= 0) & (T < MOTION_SECONDS)
L1, L2 = ARM.lengths


def hand_of(q):
    z = L1 * np.exp(1j * q[..., 0]) + L2 * np.exp(1j * (q[..., 0] + q[..., 1]))
    return np.stack([z.real, z.imag], -1)


class TestCircles:
    @pytest.mark.parametrize("elbow, start", [("negative", "jump"), ("positive", "smooth")])
    def test_the_hand_goes_round(self, elbow, start):
        circles = motions.random_circles(20, 1)
        q = motions.stirred(ARM, circles, T, elbow, start).q
        offset = hand_of(q) - circles.centre[:, None]
        np.testing.assert_allclose(
            np.linalg.norm(offset, axis=-1), circles.radius[:, None] + 0 * T, rtol=1e-9
        )
        assert (np.sign(q[..., 1]) == (1 if elbow == "positive" else -1)).all()
        angle = np.unwrap(np.arctan2(offset[..., 1], offset[..., 0]))
        turns = (angle[:, -1] - angle[:, 0]) / (2 * np.pi)
        lasts = MOTION_SECONDS - (motions._RAMP if start == "smooth" else 0)
        wanted = np.where(circles.clockwise, -1, 1) * lasts / circles.period
        np.testing.assert_allclose(turns, wanted, rtol=1e-9)
        farthest = np.linalg.norm(hand_of(q[:, 0]), axis=-1)  # where it begins
        np.testing.assert_allclose(farthest, circles.distance + circles.radius)

    @pytest.mark.parametrize("start", ["jump", "smooth"])
    def test_derivatives_are_those_of_finite_differences(self, start):
        reference = motions.stirred(ARM, motions.random_circles(10, 5), T, start=start)
        inner = np.flatnonzero(INSIDE)[2:-2]
        for x, rate in itertools.pairwise(reference):
            numeric = np.gradient(x, T, axis=1)[:, inner]
            np.testing.assert_allclose(rate[:, inner], numeric, atol=4e-3 * np.abs(rate).max())
        assert not reference.qd[:, ~INSIDE].any() and not reference.qdd[:, ~INSIDE].any()
        jump = np.abs(np.diff(reference.qd, axis=1)).max()
        assert jump < 0.05 if start == "smooth" else jump > 0.2


class TestViaPoints:
    def test_they_pass_all_points_at_equal_times(self):
        count = 6
        points = motions._random_points(5, count, 0)
        assert (points <= 0).all() and (points >= -np.pi / 4).all()
        when = MOTION_SECONDS * np.arange(count + 2) / (count + 1)
        reference = motions._via_points(points, when)
        np.testing.assert_allclose(reference.q[:, 1:-1], points, atol=1e-12)
        for x in reference:
            np.testing.assert_allclose(x[:, [0, -1]], 0, atol=1e-9)  # rest at both ends
        dense = motions._via_points(points, T)
        inner = np.flatnonzero(INSIDE)[1:-1]  # the jerk jumps where the motion begins and ends
        for x, rate in itertools.pairwise(dense):
            numeric = np.gradient(x, T, axis=1)[:, inner]
            np.testing.assert_allclose(rate[:, inner], numeric, atol=3e-3 * np.abs(rate).max())


def test_errors_of_the_hand_are_distances_in_millimetres():
    reference = motions.stirred(ARM, motions.random_circles(2, 0), T)
    torques = np.stack([0 * reference.q, needed(JOINT_DAMPING, *reference)])
    log = stirring.through(JOINT_DAMPING, torques, reference)
    assert log.q.shape[:2] == (2, 2)
    gap = hand_of(log.q_true) - hand_of(log.reference.q)
    gap = np.sqrt((gap[..., log.motion, :] ** 2).sum(-1).mean(-1)) * 1000
    np.testing.assert_allclose(stirring.off(JOINT_DAMPING, log), gap)
    alone = motions.recorded(JOINT_DAMPING, reference)
    np.testing.assert_allclose(log.q_true[0], alone.q_true, atol=1e-9)  # no torque, no change
