"""Torques at run time: motions, scores and the linear loop against independent truths."""

from dataclasses import replace

import control
import numpy as np
import pytest

from beyond.studies.loop import run_time_parts as parts
from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM, Arm
from ddlib.effects import Effects, ViscousFriction
from ddlib.setups import JOINT_DAMPING, Setup
from ddlib.simulation import CONTROL_STEP
from ddlib.trajectories import Trajectory, pick_and_place

WHEELS = Arm("two wheels", 2.0, 0.0, 1.0, (0.4, 0.3))
"""An arm whose mass matrix is constant and that has no centrifugal torques: a linear one."""

FRICTION = Effects(friction=(ViscousFriction((3.0, 1.0)),))
LINEAR = Setup("linear", pd((60.0, 30.0), (4.0, 2.0)), arm=WHEELS, effects=FRICTION)
T = parts._T


def driven(torque, plan):
    """A recording of `LINEAR` with a feedforward of given torques."""
    law = parts.given(torque, LINEAR.controller)
    return parts.follow(WHEELS, law, plan, T, effects=FRICTION, duration=3.0)


def python_control(torque):
    """Joint angles of `LINEAR` that start at rest and are driven by torques, by python-control."""
    M, F = WHEELS.mass_matrix(np.zeros(2)), np.diag([3.0, 1.0])
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [np.zeros((2, 2)), -np.linalg.solve(M, F)]])
    arm = control.ss(A, np.vstack([np.zeros((2, 2)), np.linalg.inv(M)]), np.eye(4), 0)
    held = control.sample_system(arm, CONTROL_STEP, "zoh")
    gain = np.hstack([np.diag([60.0, 30.0]), np.diag([4.0, 2.0])])
    loop = control.ss(held.A - held.B @ gain, held.B, np.eye(2, 4), 0, CONTROL_STEP)
    return control.forced_response(loop, T, torque.T).outputs.T


def test_end_point_error_along_a_linear_loop_is_that_of_python_control():
    rng = np.random.default_rng(0)
    wrong = 3 * np.sin(np.outer(T, [5.0, 8.0]) + rng.uniform(0, 6, 2))
    still = np.zeros((T.size, 2))
    log = driven(wrong, Trajectory(still, still, still))
    q = python_control(wrong)
    moving = (T >= 0) & (T < 3 - 1e-9)
    np.testing.assert_allclose(log.q_true, q[::5], atol=1e-9)
    q1, q12 = q[:, 0], q.sum(1)
    hand = np.stack([0.4 * np.cos(q1) + 0.3 * np.cos(q12), 0.4 * np.sin(q1) + 0.3 * np.sin(q12)])
    gap2 = 1e6 * ((hand - [[0.7], [0.0]]) ** 2).sum(0)[moving][::5]
    found = parts.score(WHEELS, log)
    assert found.whole == pytest.approx(np.sqrt(gap2.mean()), rel=1e-6)
    assert found.largest == pytest.approx(np.sqrt(gap2.max()), rel=1e-6)
    first = round(parts._START / 0.01)
    assert found.start == pytest.approx(np.sqrt(gap2[:first].mean()), rel=1e-6)
    assert found.rest == pytest.approx(np.sqrt(gap2[first:].mean()), rel=1e-6)
    degrees = np.rad2deg(np.sqrt((q[moving][::5] ** 2).mean(0)))
    assert (found.shoulder, found.elbow) == pytest.approx(tuple(degrees), rel=1e-6)


def test_the_linear_loop_is_python_controls():
    torque = np.random.default_rng(1).standard_normal((T.size, 2))
    found = parts.through_loop(parts.linear_loop(LINEAR, 0.3), np.stack([torque, 2 * torque]))
    np.testing.assert_allclose(found[0], python_control(torque), atol=1e-9)
    np.testing.assert_allclose(found[1], 2 * found[0], atol=1e-12)


def test_the_error_along_the_path_and_across_it():
    """A hand that is late on its path errs along it; one link alone shows both by hand."""
    plan = pick_and_place([30.0, 0.0], T)
    late = np.roll(plan.q, 5, axis=0)
    log = parts.follow(ARM, lambda wanted, q, qd: 0 * q, plan, T, duration=3.0, log_every=1)
    found = parts.score(ARM, replace(log, q_true=late))
    assert found.across < 0.02 * found.along
    assert found.whole == pytest.approx(np.hypot(found.along, found.across), rel=1e-6)
    reach = replace(log, q_true=plan.q + np.array([0.0, 0.02]))
    turned = parts.score(ARM, reach)
    gap = 1e3 * 2 * 0.4 * np.sin(0.01)
    assert turned.whole == pytest.approx(gap, rel=1e-9)


def test_the_impulse_changes_the_momentum_by_the_jump():
    plan = pick_and_place([30.0, 20.0], T)
    extra = parts._with_impulse(JOINT_DAMPING)(*plan) - parts.exact(JOINT_DAMPING)(*plan)
    at = np.flatnonzero(np.abs(extra).max(-1) > 1e-9)
    assert len(at) == 2 and np.abs(T[at] - [0.0, 3.0]).max() < 0.0021
    for k in at:  # it starts backwards, and is stopped on its way forwards
        M = JOINT_DAMPING.arm.mass_matrix(plan.q[k])
        wanted = M @ -np.deg2rad([30.0, 20.0]) * np.pi / 3
        np.testing.assert_allclose(extra[k] * CONTROL_STEP, wanted, rtol=1e-4)
