"""Measures of what the rigid body leaves out, against the motion that the reference asks for."""

from __future__ import annotations

import re

import numpy as np

from ddlib.simulation import rms
from ddlib.trajectories import APPENDIX_I, pick_and_place
from workshop.report.measures import dynamics

ARM, EFFECTS = dynamics.SETUP.arm, dynamics.SETUP.effects
T = np.arange(0.0, 3.0, 0.002)
REFERENCE = pick_and_place(APPENDIX_I[5], T)


def test_friction_is_told_as_a_share_of_both_torques():
    measured = dynamics.friction()
    driven, asked, turn = (
        [float(x) for x in re.findall(r"\d+\.?\d*", part)] for part in measured.text.split(";")
    )
    share = rms(EFFECTS.friction_torque(REFERENCE.qd)) / rms(ARM.inverse_dynamics(*REFERENCE))
    np.testing.assert_allclose(np.array(asked) / 100, share, atol=0.015)
    catching_up = rms(dynamics._ideal().tau_true[dynamics._ideal().motion])
    np.testing.assert_allclose(
        np.divide(asked, driven), catching_up / rms(ARM.inverse_dynamics(*REFERENCE)), rtol=0.1
    )
    # the share grows nearly in proportion to the friction
    assert np.isclose(measured.value, 20 / min(driven), rtol=0.06)
    assert turn == [20, round(measured.value, 1)]


def test_the_snap_that_is_measured_is_the_snap_of_the_reference():
    """Twist: torque through the shaft over its stiffness; left: motor inertia times its qdd."""
    shaft = dynamics.SHAFT
    motors, stiffness = np.array(shaft.motor_inertia), np.array(shaft.stiffness)
    through = ARM.inverse_dynamics(*REFERENCE) - motors * REFERENCE.qdd
    twist = through / stiffness
    left = np.diff(twist, 2, axis=0) / 0.002**2 @ motors
    expected = rms(left[:, None])[0] / EFFECTS.torque_sensor[0].std[0]
    slowest = shaft.mode_frequencies(ARM, [0.0, 0.0]).min() / (2 * np.pi)
    # ten times softer: ten times the torque, and a mode slower by the root of ten
    assert np.isclose(dynamics.snap().value, slowest * np.sqrt(expected), rtol=0.02)
