"""Least squares for the arm's parameters: exact where the data are, honest where they are not."""

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II, IMI_ARM, REYES_KELLY_ARM
from ddlib.effects import CoulombFriction, Effects, ViscousFriction
from ddlib.identification import (
    FRICTION,
    GRAVITY,
    RIGID,
    Equations,
    excitation,
    from_states,
    least_squares,
    true_parameters,
)
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
    assert found.names == ALL and found.freedom == 400 - 9
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


def test_refusals():
    motion = states(3)
    y = torque(CMU_DD_ARM_II, motion)
    with pytest.raises(ValueError, match="names must be one of 'a', 'b', 'd'"):
        from_states(*motion, y, ("a", "mass"))
    with pytest.raises(ValueError, match="equations must be more than the 9"):
        least_squares(from_states(*motion, y, ALL))
    shoulder = pick_and_place(APPENDIX_I[3], T)
    with pytest.raises(ValueError, match="must determine all of a, b, d"):
        least_squares(from_states(*shoulder, torque(CMU_DD_ARM_II, shoulder)))
