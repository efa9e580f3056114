"""Torque beyond the rigid body's: nothing for the rigid arm, each effect for an arm with it."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.effects import (
    ComputingTime,
    CoulombFriction,
    Effects,
    FlexibleJoint,
    Ripple,
    StickSlipFriction,
    ViscousFriction,
)
from ddlib.setups import KD, KP
from ddlib.simulation import CONTROL_STEP, record, residual_torque
from ddlib.trajectories import APPENDIX_I

ARM = CMU_DD_ARM_II


def drive(arm=ARM, log_step=CONTROL_STEP, **parts):
    return record(arm, pd(KP, KD), APPENDIX_I[5], effects=Effects(**parts), log_step=log_step)


@pytest.mark.parametrize(
    "friction",
    [ViscousFriction((0.5, 0.15)), CoulombFriction((0.5, 0.15))],
    ids=["viscous", "Coulomb"],
)
def test_friction_is_what_is_left(friction):
    run = drive(friction=(friction,))
    middle = (run.qd_true[1:] + run.qd_true[:-1]) / 2
    steady = np.abs(middle).min(-1) > 0.02
    left = residual_torque(ARM, run)
    np.testing.assert_allclose(left[steady], friction.torque(middle)[steady], atol=2e-4)


def test_a_stuck_joint_needs_no_torque_but_gets_some():
    """At rest what is left is the whole applied torque."""
    run = drive(friction=(StickSlipFriction((0.5, 0.15), (0.65, 0.195)),))
    left = residual_torque(ARM, run)
    still = ~(run.qd_true[:-1].any(-1) | run.qd_true[1:].any(-1))
    assert still.sum() > 100
    np.testing.assert_allclose(left[still], run.tau_true[:-1][still], atol=1e-12)


def test_ripple_is_what_is_left():
    ripple = Ripple(cogging=(0.1, 0.05), share=(0.02, 0.02))
    run = drive(motor=(ripple,))
    middle = (run.q_true[1:] + run.q_true[:-1]) / 2
    expected = run.tau_true[:-1] - ripple.shaft_torque(run.tau_true[:-1], middle)
    np.testing.assert_allclose(residual_torque(ARM, run), expected, atol=2e-3)


def test_a_springy_shaft_leaves_the_snap_of_the_motion():
    """Where nothing rings: motor inertia times the second derivative of the shaft's twist."""
    shaft = FlexibleJoint((2e4, 6e3), (0.4, 0.15), (5.0, 1.0))
    run = drive(transmission=(shaft,))
    left = residual_torque(ARM, run)
    smooth = slice(550, 1700)  # 0.6 s after the start, before the end
    twist = run.q - run.q_true
    second = np.gradient(np.gradient(twist, CONTROL_STEP, axis=0), CONTROL_STEP, axis=0)
    rotors = np.array([0.4, 0.15]) * second
    rotors[:, 0] += rotors[:, 1]  # the elbow's motor rides on link 1
    assert np.abs(shaft.spring_torque(twist, 0 * twist)).max() > 20
    np.testing.assert_allclose(left[smooth], rotors[:-1][smooth], atol=3e-4)
    assert np.abs(left[smooth]).max() > 2e-3


@pytest.mark.parametrize("period", [0.001, 0.004])
def test_any_control_period_will_do_and_no_other_log(period):
    options = dict(control_step=period, duration=2.0, rest=0.4)
    made = record(ARM, pd(KP, KD), APPENDIX_I[5], log_step=period, **options)
    assert np.abs(residual_torque(ARM, made)).max() < 2e-6 * (period / CONTROL_STEP) ** 2 * 10
    with pytest.raises(ValueError, match=rf"must be logged every {period:g} s.*got 0\.008 s"):
        residual_torque(ARM, record(ARM, pd(KP, KD), APPENDIX_I[5], log_step=0.008, **options))
    with pytest.raises(ValueError, match="recording must have a control_step above 0"):
        residual_torque(ARM, replace(made, control_step=None))


def test_a_rigid_arm_with_a_late_torque_leaves_nothing():
    made = drive(actuator=(ComputingTime(0.0012),))
    assert np.abs(np.diff(made.tau_true, axis=0)).max() > 1
    assert np.abs(residual_torque(ARM, made)).max() < 5e-3
    assert np.abs(residual_torque(ARM, replace(made, computing_time=0.0))).max() > 1
