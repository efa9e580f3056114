"""Findings that logs in public repositories asked for, on motions made for them."""

import numpy as np
import pytest

from ddlib.dynamics import Arm, Link
from ddlib.logs import Log, LoggedRun, check_recording

T = 0.004 * np.arange(1000)


def log(q, tau, t=T):
    return Log((LoggedRun("run", t, q, tau, None),))


def motion(t=T):
    """Angles and torques of two joints that swing, smooth and of both signs."""
    q = np.stack([np.sin(3 * t) + 0.2 * t, 0.7 * np.sin(5 * t + 1)], axis=-1)
    tau = np.stack([np.sin(3 * t + 2) + 0.3 * np.sin(17 * t), 0.5 * np.sin(5 * t)], axis=-1)
    return q, tau


def kinds(check):
    return {finding.kind for finding in check.findings}


def held(x, seed=5):
    """Readings that come every three to six lines, all of a line together."""
    rng = np.random.default_rng(seed)
    last = np.zeros(len(x), int)
    new = np.cumsum(rng.integers(3, 7, len(x)))
    last[new[new < len(x)]] = new[new < len(x)]
    return x[np.maximum.accumulate(last)]


def test_readings_slower_than_the_lines_are_told_and_no_saturation():
    # a Pendubot's file: angles and current stay for three to six lines
    both = held(np.concatenate(motion(), axis=1))
    check = check_recording(log(both[:, :2], both[:, 2:]))
    (slow,) = check.of("slow readings")
    assert slow.severity == "doubtful" and "change together, every" in slow.what
    assert "saturation" not in kinds(check)


@pytest.mark.parametrize("step", [0.0, 0.002])
def test_quantised_angles_and_rests_are_no_slow_readings(step):
    q, tau = motion()
    q[:300], tau[:300] = q[300], tau[300]  # a rest without noise
    if step:
        q = step * np.round(0.1 * q / step)
        tau = 0.1 * np.round(tau / 0.1)
    assert "slow readings" not in kinds(check_recording(log(q, tau)))


def test_a_torque_at_its_limit_is_still_told():
    q, tau = motion()
    check = check_recording(log(q, np.clip(tau, -0.8, 0.8)))
    assert {finding.where for finding in check.of("saturation")} == {(0, 0)}


def test_a_torque_without_its_sign_is_told():
    q, tau = motion()
    check = check_recording(log(q, np.abs(tau) * [1, -1]))
    told = check.of("torque of one sign")
    assert [(finding.where, finding.severity) for finding in told] == [
        ((0, 0), "doubtful"), ((0, 1), "doubtful")]  # fmt: skip
    assert "never changes its sign" in told[0].what


@pytest.mark.parametrize("change", [lambda tau: tau, lambda tau: tau + 3, lambda tau: 0 * tau])
def test_a_torque_of_both_signs_or_far_from_zero_has_its_sign(change):
    q, tau = motion()
    assert "torque of one sign" not in kinds(check_recording(log(q, change(tau))))


def test_rounding_is_no_motion_and_no_torque():
    # values that stay, brought onto an even grid, vary by rounding
    rng = np.random.default_rng(8)
    q = np.array([0.5, -0.4]) * (1 + 1e-16 * rng.choice([-2, 0, 2], (1000, 2)))
    tau = np.array([-78.0, -691.0]) * (1 + 1e-16 * rng.choice([-2, 0, 2], (1000, 2)))
    check = check_recording(log(q, tau))
    assert kinds(check) >= {"at rest", "no torque"} and "little torque" not in kinds(check)
    assert "within 0 rad" in check.of("at rest")[0].what


def test_a_torque_later_than_all_that_is_tried_has_no_margin():
    t = 0.01 * np.arange(1500)
    q = 0.5 * np.stack([np.sin(4 * t) + np.sin(7 * t), np.sin(5 * t) + np.cos(9 * t)], -1)
    qd = np.gradient(q, 0.01, axis=0)
    qdd = np.gradient(qd, 0.01, axis=0)
    tau = Arm("my arm", 1.0, 0.2, 0.3, (0.3, 0.3)).inverse_dynamics(q, qd, qdd)
    rng = np.random.default_rng(3)
    late = np.roll(tau, 11, axis=0)[20:-20] + rng.normal(0, 0.01, (1460, 2))
    (lag,) = check_recording(log(q[20:-20], late, t[20:-20])).of("lag")
    assert "8.0 or more samples" in lag.what


def test_a_motion_that_tells_no_parameter_is_asked_to_be_longer():
    t = 0.01 * np.arange(300)
    q = np.stack([0.2 * t, 0.1 * t], -1)
    rng = np.random.default_rng(3)
    q, tau = q + rng.normal(0, 1e-4, q.shape), 1.0 + rng.normal(0, 0.1, q.shape)
    (told,) = check_recording(log(q, tau, t)).of("excitation")
    assert told.what.startswith("The motion tells no parameter") and "Record longer" in told.advice


@pytest.mark.parametrize("size, told", [(300.0, []), (700.0, [(0, 0)])])
def test_a_torque_in_milliamperes_is_doubted(size, told):
    q, tau = motion()
    check = check_recording(log(q, size * tau * [1 / np.abs(tau[:, 0]).max(), 0.5]))
    doubted = [f.where for f in check.of("units of torque") if f.severity == "doubtful"]
    assert doubted == told


def driven(seed, held=False, slow=1.0, step=0.005, weight=0.0):
    """Angles and torques of a small arm that swings by three sines a joint.

    A shoulder that is held gives way a little, as the loop that holds it is a spring.
    """
    arm = Arm.from_links("small", Link(4.0, 0.35, 0.16, 0.05), Link(2.5, 0.3, 0.14, 0.025), weight)
    rng, t = np.random.default_rng(seed), step * np.arange(1200)
    speed = rng.uniform(2.0, 7.0, (3, 2)) * slow
    angle = speed * t[:, None, None] + rng.uniform(0, 6, (3, 2))
    waves = np.sin(angle), speed * np.cos(angle), -(speed**2) * np.sin(angle)
    q, v, a = (0.35 / slow**0.5 * x.sum(1) for x in waves)
    if held:
        for x in (q, v, a):
            x[:, 0] = 0.0
        q[:, 0] = -arm.inverse_dynamics(q, v, a)[:, 0] / 60.0
        v[:, 0] = np.gradient(q[:, 0], step)
        a[:, 0] = np.gradient(v[:, 0], step)
    tau = arm.inverse_dynamics(q, v, a) + 0.4 * v + 0.1 * np.tanh(v / 0.02)
    tau += rng.normal(0, [0.1, 0.03], tau.shape)
    return np.round(q / 1e-4) * 1e-4, tau, t


def test_a_shoulder_that_is_held_gives_way_and_has_no_wrong_sign():
    for seed in range(8):
        q, tau, t = driven(seed, held=True)
        assert not check_recording(log(q, tau, t)).wrong, seed
        told = check_recording(log(q, -tau, t)).of("sign of the torque")
        assert {finding.where[1] for finding in told} == {0, 1}


def test_a_small_torque_that_is_no_noise_hides_no_other_finding():
    q, tau, t = driven(2, slow=0.25)
    assert not check_recording(log(q, tau, t)).of("little torque")
    assert "sign of a torque" in kinds(check_recording(log(q, tau * [1, -1], t)))
    noise = np.random.default_rng(0).normal(0, 0.03, len(t))
    drowned = np.stack([tau[:, 0], noise], -1)
    (told,) = check_recording(log(q, drowned, t)).of("little torque")
    assert told.where == (0, 1)


def repeated(x, times=4):
    return np.repeat(x, times, axis=0)


@pytest.mark.parametrize("late", [0, 3])
def test_half_a_message_is_no_lag_where_four_lines_repeat_it(late):
    # a KUKA's file: messages of 100 Hz on lines of 400 Hz
    q, tau, t = driven(1, step=0.01)
    middle = (tau[1:] + tau[:-1])[: len(t) - 1] / 2  # of the torque that acts until the next
    q, tau = q[: len(middle)], np.roll(middle, late, axis=0)
    check = check_recording(log(repeated(q), repeated(tau), 0.0025 * np.arange(4 * len(q))))
    assert "slow readings" in kinds(check) and ("lag" in kinds(check)) == (late > 0)


def test_an_arm_at_rest_has_neither_lag_nor_excitation():
    rng = np.random.default_rng(4)
    q = repeated(0.02 + 1e-6 * rng.normal(size=(400, 2)).cumsum(0))
    tau = repeated([3.0, 1.0] + 0.05 * rng.normal(size=(400, 2)).cumsum(0))
    check = check_recording(log(q, tau, 0.0025 * np.arange(len(q))))
    assert kinds(check) == {"at rest", "slow readings"}
    assert "of an arm that hangs" in check.wrong[0].effect


def test_a_free_swing_is_asked_of_an_arm_that_can_swing_freely():
    for weight in (0.0, 9.81):
        q, tau, t = driven(3, weight=weight)
        (lag,) = check_recording(log(q[:-6], tau[6:], t[6:])).of("lag")
        assert ("free swing" in lag.advice) == (weight > 0) != ("push" in lag.advice)
