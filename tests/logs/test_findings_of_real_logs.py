"""Findings that logs in public repositories asked for, on motions made for them."""

import numpy as np
import pytest

from ddlib.dynamics import Arm
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
