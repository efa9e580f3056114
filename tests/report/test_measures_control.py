"""The continuous simulation behind two claims, against the sampled one and closed forms."""

import numpy as np
import pytest

from ddlib.control import Feedforward, pd
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.setups import KD, KP
from ddlib.simulation import SecondOrderModel, follow, smooth_pick_and_place
from workshop.report.measures.control import EXTENTS, TIMES, track


def nothing(q, qd, qdd):
    return 0 * qdd


def test_the_arm_itself_moves_as_in_the_simulator():
    motion = smooth_pick_and_place(EXTENTS, TIMES)
    sampled = np.rad2deg(follow(ARM, pd(KP, KD), motion, TIMES, log_every=5).tracking_error)
    errors = track([[0, 0]], [False], nothing, [[1, 1]])[0]
    assert errors.shape == sampled.shape
    assert np.abs(errors - sampled).max() < 0.02 < 0.01 * np.abs(sampled).max() + 0.02
    half = Feedforward(lambda *motion: 0.5 * ARM.inverse_dynamics(*motion), pd(KP, KD))
    sampled = np.rad2deg(follow(ARM, half, motion, TIMES, log_every=5).tracking_error)
    errors = track([[0, 0]], [False], half.model, [[1, 1]])[0]
    assert np.abs(errors - sampled).max() < 0.02 < np.abs(sampled).max()


def test_perfect_models_leave_nothing_whatever_the_arm():
    rotors = np.array([[0.0, 0.0], [2.0, 1.0], [0.0, 0.0]])
    frozen = [False, False, True]

    def model(q, qd, qdd):
        torque = ARM.inverse_dynamics(q, qd, qdd) + rotors[:, None] * qdd
        torque[2] = SecondOrderModel(ARM)(q, qd, qdd)[2]
        return torque

    assert np.abs(track(rotors, frozen, model, np.zeros((3, 2)), speed=2.0)).max() < 1e-5
    # and the test can fail: a model of the arm without rotors leaves an error
    assert np.abs(track(rotors, frozen, ARM.inverse_dynamics, np.zeros((3, 2)))).max() > 1


def test_a_heavy_rotor_makes_a_joint_that_knows_nothing_of_the_other():
    """Behind a rotor of a ton the motion is that of one inertia on its own spring and damper."""
    heavy = np.array([[1000.0, 1000.0]])
    inertia = heavy + np.diag(ARM.mass_matrix([0.0, 0.0]))
    gains = inertia / np.diag(ARM.mass_matrix([0.0, 0.0]))
    alone = track(heavy, [False], nothing, gains, extents=(20.0, 0.0))[0]
    assert np.abs(alone[:, 0]).max() > 1
    assert np.abs(alone[:, 1]).max() < 0.01 * np.abs(alone[:, 0]).max()


def test_a_frozen_arm_is_linear():
    single, double = (
        track([[0, 0]], [True], nothing, [[1, 1]], extents=x) for x in ((10, 5), (20, 10))
    )
    np.testing.assert_allclose(double, 2 * single, atol=1e-10)
    bent = track([[0, 0]], [False], nothing, [[1, 1]], extents=(20, 10))
    assert np.abs(bent - double).max() > 1e-4


@pytest.mark.parametrize("speed", [0.0, -1.0, np.nan])
def test_bad_speeds_are_refused_by_name(speed):
    with pytest.raises(ValueError, match=r"^speed must"):
        track([[0, 0]], [False], nothing, [[1, 1]], speed=speed)
