"""Rivals for an unknown load: the arm they drive, their observers and their delay margins."""

import numpy as np
import pytest
from scipy.linalg import expm

from beyond.studies.loop import fair_rivals as study
from beyond.studies.loop.run_time_parts import rounded
from ddlib.control import pd
from ddlib.dynamics import CMU_DD_ARM_II, end_point_error, with_load
from ddlib.effects import CoulombFriction, Effects, Saturation, ViscousFriction
from ddlib.setups import JOINT_DAMPING_COULOMB, JOINT_DAMPING_VISCOUS
from ddlib.simulation import REST, follow
from ddlib.trajectories import Trajectory, time_grid

SOFT = study.RIVALS["PD, the book's gains"]
STIFF = study.RIVALS["PD, ten times as stiff"]


def by_ddlib(rival, arm):
    """The end-point error of a PD controller in `ddlib.simulation.follow`, mm."""
    t = time_grid(0.002, REST)
    plan = Trajectory(*rounded(study._EXTENTS, study._CORNER))
    friction = (
        ViscousFriction(JOINT_DAMPING_VISCOUS),
        CoulombFriction(JOINT_DAMPING_COULOMB, study._SIGN),
    )
    effects = Effects(friction=friction, actuator=(Saturation(tuple(study.LIMITS)),))
    law = pd(np.multiply(rival.gain, rival.slope), rival.gain)
    log = follow(arm, law, plan, t, effects=effects, log_every=1, duration=3.0)
    gap = end_point_error(arm, log.reference.q, log.q_true)[log.motion]
    return 1e3 * np.sqrt((gap**2).sum(-1).mean())


def test_pd_is_that_of_ddlib_with_and_without_the_load(monkeypatch):
    monkeypatch.setattr(study, "TRIALS", 1)
    found = study.errors({"soft": SOFT, "stiff": STIFF})
    for name, rival in (("soft", SOFT), ("stiff", STIFF)):
        for k, arm in enumerate((CMU_DD_ARM_II, with_load(CMU_DD_ARM_II, study.LOAD))):
            assert found[name][k] == pytest.approx(by_ddlib(rival, arm), rel=0.01)


def test_an_observer_has_nothing_to_add_to_right_numbers(monkeypatch):
    monkeypatch.setattr(study, "TRIALS", 1)
    names = ("exact numbers, held", "exact numbers, and an observer")
    held, observed = study.errors({n: study.RIVALS[n] for n in names}).values()
    assert observed[0] == pytest.approx(held[0], rel=0.1)
    assert observed[1] < 0.3 * held[1]  # a load is what it is there for


def test_only_what_learns_changes_from_motion_to_motion(monkeypatch):
    monkeypatch.setattr(study, "TRIALS", 2)
    learner = study.RIVALS["adaptive (Slotine & Li)"]
    found = study.errors({"soft": SOFT, "learner": learner})
    assert found["soft"][0] == found["soft"][1] and found["soft"][2] == found["soft"][3]
    assert found["learner"][1] < 0.5 * found["learner"][0]


def spectral_radius(rival, late):
    """Largest pole of PD about the stretched arm, torques late by so many periods of 2 ms."""
    inverse = np.linalg.inv(CMU_DD_ARM_II.mass_matrix(np.zeros(2)))
    continuous = np.zeros((6, 6))
    continuous[:2, 2:4] = np.eye(2)
    continuous[2:4, 2:4] = -inverse * JOINT_DAMPING_VISCOUS
    continuous[2:4, 4:] = inverse
    step = expm(0.002 * continuous)[:4]
    gains = -np.hstack([np.diag(np.multiply(rival.gain, rival.slope)), np.diag(rival.gain)])
    size = 4 + 2 * late
    loop = np.zeros((size, size))
    loop[:4, :4] = step[:, :4]
    if late:
        loop[:4, 4:6] = step[:, 4:]
        loop[4:-2, 6:] = np.eye(size - 6)
        loop[-2:, :4] = gains
    else:
        loop[:4, :4] += step[:, 4:] @ gains
    return np.abs(np.linalg.eigvals(loop)).max()


@pytest.mark.parametrize("rival", [SOFT, STIFF])
def test_a_delay_margin_is_where_poles_leave_the_unit_circle(rival):
    margin = study.delay_margin(rival)
    late = int(margin / 0.002)
    assert spectral_radius(rival, late) < 1 < spectral_radius(rival, late + 1)


def test_proportional_feedback_bears_friction_over_stiffness():
    # a joint by itself: F/K less half a period; two joints lie between what each would bear
    alone = np.array(JOINT_DAMPING_VISCOUS) / (750.0, 225.0) - 0.001
    assert alone.min() < study.delay_margin(study.POSITION_ALONE) < alone.max()
