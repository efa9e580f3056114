"""What simpler models lose, against closed forms and limits."""

import numpy as np
import pytest

from ddlib.analysis import linear_residual, share_of_other_joint, share_of_velocity_terms
from ddlib.dynamics import CMU_DD_ARM_II, REYES_KELLY_ARM, Arm
from ddlib.effects import CoulombFriction, Effects
from ddlib.trajectories import APPENDIX_I, pick_and_place

MOTION = pick_and_place(APPENDIX_I[:3], np.arange(300) * 0.01)
SEPARATE = Arm("no coupling", a=2.0, b=0.0, d=1e-9, lengths=(0.5, 0.4))


def test_without_friction_and_gravity_speed_does_not_matter():
    slow, fast = (share_of_velocity_terms(CMU_DD_ARM_II, MOTION, s) for s in (0.1, 10.0))
    np.testing.assert_allclose(slow, fast, rtol=1e-12)
    assert (0.02 < slow).all() and (slow < 0.2).all()


@pytest.mark.parametrize("arm", [CMU_DD_ARM_II, REYES_KELLY_ARM], ids=lambda a: a.name)
def test_friction_and_gravity_hide_velocity_terms_at_low_speed(arm):
    effects = Effects((CoulombFriction((0.5, 0.15), smoothing=1e-7),))
    shares = np.array([share_of_velocity_terms(arm, MOTION, s, effects) for s in (1e-3, 1e-2, 1.0)])
    assert (np.diff(shares, axis=0) > 0).all() and (shares[0] < 1e-3).all()
    # friction that stays the same: the share grows with the square of speed
    assert shares[1] / shares[0] == pytest.approx([100.0, 100.0], rel=0.05)


def test_gears_hide_the_other_joint_by_their_square():
    shares = share_of_other_joint(CMU_DD_ARM_II, MOTION, [0.0, 1e3, 2e3, 4e3], rotor=2e-4)
    assert shares.shape == (4, 2) and (np.diff(shares, axis=0) < 0).all()
    np.testing.assert_allclose(shares[2] / shares[3], 4.0, rtol=0.02)
    without = share_of_other_joint(CMU_DD_ARM_II, MOTION, [100.0], rotor=0.0)
    np.testing.assert_allclose(without, shares[:1])
    assert share_of_other_joint(SEPARATE, MOTION, [1.0], 0.0)[0, 0] < 1e-6


def test_a_linear_arm_has_no_linear_residual():
    rng = np.random.default_rng(0)
    states = rng.uniform(-np.pi, np.pi, (3, 2000, 2))
    line = Arm("line", a=2.0, b=0.0, d=0.5, lengths=(0.5, 0.4))
    assert linear_residual(line, *states) < 1e-12
    residual = [linear_residual(CMU_DD_ARM_II, *(x * s for x in states)) for s in (0.01, 0.3, 1.0)]
    assert residual[0] < 1e-3 < residual[1] < residual[2] < 1.0
