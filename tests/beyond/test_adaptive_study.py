"""Adaptive laws side by side: each run as if it were alone, and what the study counts."""

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II, end_point_error
from ddlib.effects import IDEAL
from ddlib.setups import JOINT_DAMPING, KD, STATE_FEEDBACK
from ddlib.simulation import record
from ddlib.trajectories import APPENDIX_I, pick_and_place
from workshop.beyond.control.adaptive.regressor import mixed_regressor
from workshop.beyond.control.adaptive.running import Watched
from workshop.beyond.control.adaptive.slotine_li import SlotineLi
from workshop.beyond.studies.loop.runs import adaptive as runs

HALF = 0.5 * runs.TRUTH


def test_a_law_beside_others_is_the_law_alone():
    slope, _ = runs.gains(STATE_FEEDBACK)
    own = SlotineLi(KD, slope, runs.SIZES[:3] ** 2, HALF)
    laws = {"PD": runs.fixed(STATE_FEEDBACK)["PD"], "own": own}
    found = runs.trial(laws, [[40.0, 30.0], [10.0, 20.0]], CMU_DD_ARM_II, IDEAL)
    watched = Watched(own)
    log = record(CMU_DD_ARM_II, watched, (40.0, 30.0), rest=runs._AFTER)
    off = 1e3 * np.linalg.norm(
        end_point_error(CMU_DD_ARM_II, log.reference.q, log.q_true)[log.motion], axis=-1
    )
    assert found.hand[1, 0] == pytest.approx(np.sqrt((off**2).mean()), rel=1e-6)
    assert found.settled[1, 0] == pytest.approx(np.sqrt((off[100:] ** 2).mean()), rel=1e-6)
    np.testing.assert_allclose(found.laws["own"].estimate[0], watched.law.estimate, rtol=1e-6)
    assert found.laws["PD"] is laws["PD"] and not found.stops.stopped.any()


def test_what_is_learnt_is_taken_along():
    laws = {"learning": runs.make("rigid body", STATE_FEEDBACK, np.tile(HALF, (2, 1)))}
    course = np.tile([40.0, 30.0], (3, 2, 1))
    found, after = runs.trials(laws, course, CMU_DD_ARM_II, IDEAL)
    errors = runs.by_law(found, laws)["learning"]
    assert errors.shape == (3, 2) and (errors[-1] < 0.3 * errors[0]).all()
    assert (np.abs(after["learning"].estimate / runs.TRUTH - 1) < 0.2).all()


def test_all_laws_have_one_linear_loop_when_they_know_the_arm():
    for setup in (JOINT_DAMPING, STATE_FEEDBACK):
        slope, (a0, a1) = runs.gains(setup)
        np.testing.assert_allclose(slope * KD, setup.controller.kp)
        for j in range(2):  # Slotine & Li's: the poles are the slope and K / m
            poles = sorted(np.roots([1.0, a1[j], a0[j]]))
            assert poles == pytest.approx(sorted([-slope[j], -KD[j] / runs._INERTIA[j]]))


def test_estimates_rest_while_the_motors_are_not_able():
    law = runs.make("rigid body", STATE_FEEDBACK, HALF, jumps=False).controller
    wanted = pick_and_place((45.0, 45.0), np.zeros(1))
    running = law.start(wanted, 0.002)
    torque = running(0, np.array([0.5, 0.5]), np.zeros(2))
    assert (np.abs(torque) > runs.LIMITS).any()
    np.testing.assert_array_equal(running.estimate, HALF)
    calm = law.start(wanted, 0.002)
    assert (np.abs(calm(0, wanted.q[0], 0.9 * wanted.qd[0])) < runs.LIMITS).all()
    assert (calm.estimate != HALF).any()


def test_the_smooth_model_asks_only_for_what_the_motors_have():
    t = np.arange(0, 3, 0.002)
    model = runs.SMOOTH.model(pick_and_place((45.0, 45.0), t), 0.002)
    assert (np.abs(CMU_DD_ARM_II.inverse_dynamics(*model)).max(0) <= runs.LIMITS).all()
    np.testing.assert_allclose(model.q[-1], pick_and_place((45.0, 45.0), t).q[-1], atol=1e-4)


def test_excitation_is_what_sums_of_squared_torques_say():
    t = (np.arange(1500) + 0.5) * 0.002
    wanted = pick_and_place(APPENDIX_I[5], t)
    off = np.array([0.1, -0.2, 0.3])
    torque = mixed_regressor(wanted.q, wanted.qd, wanted.qd, wanted.qdd) @ (off * runs.TRUTH)
    found = off @ runs.excitation(APPENDIX_I[5]) @ off
    assert found == pytest.approx((torque**2).sum() * 0.002, rel=1e-9)


def test_the_lyapunov_function_of_a_sampled_run_begins_with_what_is_unknown():
    slope, _ = runs.gains(STATE_FEEDBACK)
    law = SlotineLi(KD, slope, runs.SIZES[:3] ** 2, HALF)
    t = np.arange(-20, 80) * 0.002
    values = runs.sampled_lyapunov(law, pick_and_place(APPENDIX_I[:2], t), t, IDEAL)
    assert values.shape == (2, 100)
    start = 0.5 * ((HALF - runs.TRUTH) ** 2 / runs.SIZES[:3] ** 2).sum()
    np.testing.assert_allclose(values[:, :20], start, rtol=1e-9)
    assert (values[:, 20] > 1.2 * start).any()  # the jump


def test_readings_are_rounded_by_a_step_of_each_run():
    rounded = runs.Rounded(np.array([[0.1], [0.0]]), np.array([[0.02, 0.0], [0.0, 0.0]]))
    found = rounded.apply(np.array([[0.24, 0.26], [0.24, 0.26]]))
    np.testing.assert_allclose(found, [[0.28, 0.3], [0.24, 0.26]])
