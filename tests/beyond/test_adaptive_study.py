"""Adaptive laws side by side: each run as if it were alone, and what the study counts."""

import numpy as np
import pytest

from beyond.control.adaptive import SlotineLi, Watched, mixed_regressor
from beyond.studies.loop.runs import adaptive as runs
from ddlib.dynamics import CMU_DD_ARM_II, end_point_error
from ddlib.effects import IDEAL
from ddlib.setups import KD, STATE_FEEDBACK
from ddlib.simulation import record
from ddlib.trajectories import APPENDIX_I, pick_and_place

HALF = 0.5 * runs.TRUTH


def test_a_law_beside_others_is_the_law_alone():
    slope, _ = runs.gains(STATE_FEEDBACK)
    own = SlotineLi(KD, slope, runs.SIZES[:3] ** 2, HALF)
    laws = {"PD": runs._fixed(STATE_FEEDBACK)["PD"], "own": own}
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


def test_excitation_is_what_sums_of_squared_torques_say():
    t = (np.arange(1500) + 0.5) * 0.002
    wanted = pick_and_place(APPENDIX_I[5], t)
    off = np.array([0.1, -0.2, 0.3])
    torque = mixed_regressor(wanted.q, wanted.qd, wanted.qd, wanted.qdd) @ (off * runs.TRUTH)
    found = off @ runs.excitation(APPENDIX_I[5]) @ off
    assert found == pytest.approx((torque**2).sum() * 0.002, rel=1e-9)
