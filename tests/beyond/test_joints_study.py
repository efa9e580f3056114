"""Arms of more joints on given motions."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from beyond.studies.loop.chain import REACH, SPACING, chain, extents, moved, recorded
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.setups import JOINT_DAMPING, STATE_FEEDBACK
from ddlib.simulation import LOG_STEP


@pytest.mark.parametrize("setup", (JOINT_DAMPING, STATE_FEEDBACK), ids=lambda setup: setup.name)
def test_each_joint_answers_as_its_own_loop(setup):
    """The oscillator, integrated by another method; the reference jumps where it does."""
    answer, omega = chain(2, setup.name).answer(360, 20), np.pi / 3
    kp, kd = np.array(setup.controller.kp), np.array(getattr(setup.controller, "kd", (0.0, 0.0)))
    inertia = np.diag(CMU_DD_ARM_II.mass_matrix(np.zeros(2)))
    viscous = np.array(setup.effects.friction[0].coefficient)

    def rate(t, x):
        q, qd = x.reshape(2, 2)
        moving = 0 <= t < 3
        off = -np.sin(omega * t) * moving - q, -omega * np.cos(omega * t) * moving - qd
        return np.concatenate([qd, (kp * off[0] + kd * off[1] - viscous * qd) / inertia])

    options = {"rtol": 1e-10, "atol": 1e-12, "max_step": 0.01}
    start, t = np.zeros(4), LOG_STEP * np.arange(339)
    for first, last, end in ((0, 300, 3 - 1e-12), (300, 339, 3.39)):
        found = solve_ivp(rate, (t[first], end), start, t_eval=t[first:last], **options)
        wanted = np.moveaxis(found.y.reshape(2, 2, -1), -1, 0)  # (time, derivative, joint)
        np.testing.assert_allclose(
            answer[20 + first : 20 + last, :, :2].swapaxes(1, 2), wanted, atol=1e-6
        )
        start = np.concatenate([answer[320, :, 0], answer[320, :, 1]])
    assert not answer[:20].any()


def test_torque_is_the_books_with_friction():
    made, states = chain(2), moved(chain(2), extents(2, 3, 0))
    q, qd, qdd = np.moveaxis(states, -1, 0)
    wanted = CMU_DD_ARM_II.inverse_dynamics(q, qd, qdd) + JOINT_DAMPING.effects.friction_torque(qd)
    np.testing.assert_allclose(made.torque(states), wanted, atol=1e-10)


@pytest.mark.parametrize("joints", (1, 3, 4, 7))
def test_readings_of_any_number_of_joints_are_within_half_a_step_of_the_truth(joints):
    """Each joint's encoder is rounded after a shift of its own, which is taken off again."""
    arm = chain(joints)
    sample = recorded(arm, extents(joints, 3, 0), 0)
    assert sample.windows.shape[1:] == (joints, 2 * REACH // SPACING + 1)
    off = np.abs(sample.windows[..., REACH // SPACING] - sample.states[..., 0])
    assert 0.4 * arm.encoder < off.max() <= 0.5 * arm.encoder * (1 + 1e-9)
