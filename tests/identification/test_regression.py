"""Least squares for the arm's parameters: exact where the data are, honest where they are not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student

from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    OFFSETS,
    RIGID,
    Equations,
    ImpossibleArm,
    by_modulation,
    excitation,
    from_states,
    least_squares,
    true_parameters,
)
from ddlib.setups import STATE_FEEDBACK
from ddlib.simulation import Recording
from ddlib.trajectories import APPENDIX_I, Trajectory, pick_and_place

FRICTIONS = Effects((ViscousFriction((0.5, 0.15)), CoulombFriction((0.4, 0.1))))
T = np.arange(300) * 0.01
ALL = RIGID + GRAVITY + FRICTION


def states(n=200, seed=0):
    """Random states whose speeds have a sure sign."""
    q, qd, qdd = np.random.default_rng(seed).uniform(-2, 2, (3, n, 2))
    return q, qd + 0.1 * np.sign(qd), qdd


def torque(arm, motion, effects=FRICTIONS):
    return arm.inverse_dynamics(*motion) + effects.friction_torque(motion[1])


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_exact_states_give_exact_parameters(arm):
    motion = states()
    found = least_squares(from_states(*motion, torque(arm, motion), ALL))
    np.testing.assert_allclose(found.values, true_parameters(arm, FRICTIONS, ALL), atol=1e-10)
    assert found.names == ALL and 200 - 9 <= found.freedom < 200, "of one joint"
    assert found.errors.max() < 1e-10 and found.noise.max() < 1e-10


def test_least_squares_agrees_with_the_textbook_for_equal_noise():
    """One joint only: ordinary least squares, its covariance and its residual variance."""
    rng = np.random.default_rng(2)
    a = rng.normal(size=(40, 3))
    y = a @ [1.0, -2.0, 0.5] + 0.1 * rng.normal(size=40)
    found = least_squares(Equations(("x", "y", "z"), (a,), (y,)))
    beta, squares, *_ = np.linalg.lstsq(a, y)
    variance = squares[0] / 37
    np.testing.assert_allclose(found.values, beta, rtol=1e-10)
    np.testing.assert_allclose(found.noise, np.sqrt([variance]), rtol=1e-10)
    errors = np.sqrt(np.diag(np.linalg.inv(a.T @ a)) * variance)
    np.testing.assert_allclose(found.errors, errors, rtol=1e-10)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """White torque noise of different size at the joints, known states: 2,000 repetitions."""
    motion, names = states(40, seed=3), RIGID + FRICTION
    noise = np.random.default_rng(4).normal(size=(2000, 40, 2)) * [0.5, 0.05]
    found = least_squares(from_states(*motion, torque(IMI_ARM, motion) + noise, names))
    truth = true_parameters(IMI_ARM, FRICTIONS, names)
    for level in (0.5, 0.9, 0.99):
        share = found.covers(truth, level).mean(0)
        spread = 4 * np.sqrt(level * (1 - level) / 2000)
        np.testing.assert_allclose(share, level, atol=spread + 0.01)
    np.testing.assert_allclose(found.noise.mean(0), [0.5, 0.05], rtol=0.02)
    # weighting by the joints' own noise beats treating them alike
    alike = least_squares(from_states(*motion, torque(IMI_ARM, motion) + noise, names), rounds=1)
    assert (found.values.std(0)[:3] < alike.values.std(0)[:3]).all()


def test_excitation_is_the_regressors_condition_number():
    both = pick_and_place(APPENDIX_I[0], T)
    y = CMU_DD_ARM_II.regressor(*both)[..., :3].reshape(-1, 3)
    assert excitation(both) == pytest.approx(np.linalg.cond(y), rel=1e-6)
    for alone in (3, 4):  # one joint at rest
        assert excitation(pick_and_place(APPENDIX_I[alone], T)) == np.inf
    together = excitation(pick_and_place(APPENDIX_I[:5], T))
    assert together < min(excitation(pick_and_place(e, T)) for e in APPENDIX_I[:3])
    still = Trajectory(*np.zeros((3, 10, 2)))
    assert excitation(still) == np.inf


def locked(encoder=0.0, noise=0.01, elbow=True, seed=0):
    """Two sines at the shoulder, the elbow held straight; a, b, d = 1, .2, .3."""
    rng, t = np.random.default_rng(seed), T
    angles = (0.5 * np.sin(2 * t) + 0.4 * np.sin(3 * t), np.cos(2 * t) + 1.2 * np.cos(3 * t))
    angles = (*angles, -2 * np.sin(2 * t) - 3.6 * np.sin(3 * t))
    motion = Trajectory(*(np.stack([x, 0 * t], -1) for x in angles))
    arm = replace(CMU_DD_ARM_II, a=1.0, b=0.2, d=0.3)
    tau = arm.inverse_dynamics(*motion) * [1, elbow]
    tau = tau + noise * rng.normal(size=tau.shape) * [1, elbow]
    q = motion.q + encoder * rng.normal(size=tau.shape)
    return Recording(t, motion, q, tau, motion.q, motion.qd, tau, control_step=0.0)


@pytest.mark.parametrize("encoder", [0.0, 1e-4])
@pytest.mark.parametrize("noise", [0.01, 1e-6])
def test_a_locked_elbow_leaves_two_sums_and_no_guess(encoder, noise):
    """Of the rows (a + 2 b) q1'' and (b + d) q1'' no parameter can be told by itself."""
    found = least_squares(by_modulation(locked(encoder, noise), RIGID))
    assert np.isnan(found.values).all() and not found.told.any()
    shoulder, elbow = found.combinations
    np.testing.assert_allclose(shoulder.factors, [1, 2, 0], atol=2e-3)
    np.testing.assert_allclose(elbow.factors, [0, 1, 1], atol=2e-3)
    for one, truth in ((shoulder, 1.4), (elbow, 0.5)):
        assert abs(one.value - truth) < 5e-3
    assert str(shoulder).startswith("a + 2 b = 1.4")
    assert "cannot be told" in repr(found) and "a, b, d cannot be told" in found.notes[0]


@pytest.mark.parametrize("encoder", [0.0, 1e-4])
def test_intervals_of_sums_hold_and_friction_is_told(encoder):
    held = []
    for seed in range(60):
        found = least_squares(by_modulation(locked(encoder, seed=seed)))
        assert np.array_equal(found.told, [n in ("F_v1", "F_c1") for n in found.names])
        (one,) = found.combinations
        held.append([abs(one.value - 1.4) < 2 * one.error, *found.covers(np.zeros(7))[[3, 5]]])
    assert np.mean(held, 0).min() > 0.85


@pytest.mark.parametrize(("encoder", "least", "most"), [(1e-4, 1, 1), (0.01, 1, 1), (0.03, 0, 0.3)])
def test_sums_that_noise_in_the_motion_biases_have_no_interval(encoder, least, most):
    """At .03 rad a + 2 b comes out near 1.25; a fifth of the intervals would not hold 1.4."""
    found = [least_squares(by_modulation(locked(encoder, seed=k), RIGID)) for k in range(40)]
    found = [one for one in found if one.combinations]
    sums = [one.combinations[0] for one in found]
    given = np.array([np.isfinite(one.half_width) for one in sums])
    assert least <= given.mean() <= most
    assert all(("±" in str(one)) == has for one, has in zip(sums, given))
    held = np.array([abs(one.value - 1.4) <= one.half_width for one in sums])
    assert held[given].mean() > 0.9
    # 95 % as for single parameters, not one standard error
    k = int(given.argmax())
    ratio = sums[k].half_width / sums[k].error
    assert ratio == pytest.approx(student.ppf(0.975, found[k].freedom))
    if not least:
        assert np.mean([abs(one.value - 1.4) < 2 * one.error for one in sums]) < 0.9


def test_a_passive_joint_is_left_out_with_a_word():
    found = least_squares(by_modulation(locked(elbow=False), RIGID))
    assert found.notes[0] == "Joint 2 has no torque; its equations were left out."
    (one,) = found.combinations
    assert one.value == pytest.approx(1.4, abs=2e-3)


def test_masked_torques_are_refused_wherever_they_come_in():
    motion = states()
    tau = torque(CMU_DD_ARM_II, motion)
    spiky = np.ma.masked_greater(np.where(tau > np.percentile(tau, 98), 200.0, tau), 100.0)
    equations = from_states(*motion, tau, ALL)
    masked = equations._replace(torque=(spiky[:, 0], spiky[:, 1]))
    for call, name in (
        (lambda: from_states(*motion, spiky, ALL), "torque"),
        (lambda: least_squares(masked), "equations.torque"),
        (lambda: replace(locked(), tau=np.ma.masked_greater(locked().tau, 1.0)), "tau"),
    ):
        with pytest.raises(ValueError, match=f"^{name} must have no masked entries"):
            call()


@pytest.mark.parametrize("by", ["states", "modulation"])
def test_an_offset_of_the_torques_is_found(by):
    names, offset = RIGID + FRICTION + OFFSETS, np.array([0.3, -0.05])
    if by == "states":
        motion = states()
        equations = from_states(*motion, torque(IMI_ARM, motion) + offset, names)
        truth = true_parameters(IMI_ARM, FRICTIONS, names)
    else:
        setup = STATE_FEEDBACK
        recording = setup.record(APPENDIX_I[:5], effects=setup.effects.without("torque_sensor"))
        off = replace(recording, tau=recording.tau + offset)
        equations = by_modulation(off, names)
        truth = true_parameters(setup.arm, setup.effects, names)
    found = least_squares(equations)
    assert found.names == names and (truth[-2:] == 0).all()
    np.testing.assert_allclose(found.values[-2:], offset, atol=2e-3)
    np.testing.assert_allclose(found.values[:-2], truth[:-2], rtol=0.02, atol=2e-3)


def test_impossible_inertias_are_flagged():
    motion = states(60)
    arm = CMU_DD_ARM_II.regressor(*motion)[..., :3] @ [1.0, 0.7, 0.3]
    with pytest.warns(ImpossibleArm, match="No arm has these inertias") as caught:
        found = least_squares(from_states(*motion, arm))
    assert caught[0].filename == __file__
    assert found.notes == (
        "No arm has these inertias: its mass matrix would not be positive at every elbow angle.",
    )


def test_excitation_is_judged_against_noise():
    slight = pick_and_place([(40.0, 0.3)], T)
    assert np.isfinite(excitation(slight))
    assert np.isinf(excitation(slight, noise=1.0)) and np.isfinite(excitation(slight, noise=1e-6))


def test_a_joint_that_is_left_out_is_named_with_the_parameter_that_asked_for_it():
    """With F_c2 the locked elbow's equations go, and b + d, which they alone tell, with them."""
    with_dry = least_squares(by_modulation(locked(), (*RIGID, "F_c2")))
    left_out = [note for note in with_dry.notes if "joint 2" in note]
    assert left_out == [
        "All equations of joint 2 were left out: with F_c2 they ask for a joint that moves on at "
        "0.1 rad/s or more. Without F_c2 they count."
    ]
    assert left_out[0] in repr(with_dry) and len(with_dry.combinations) == 1
    without = least_squares(by_modulation(locked(), RIGID))
    assert len(without.combinations) == 2 and not any("left out" in n for n in without.notes)
