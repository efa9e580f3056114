"""Two harmonics: the paper's family as a limit, true derivatives, position and acceleration."""

from itertools import pairwise

import numpy as np
import pytest

from ddlib.analysis import explained
from ddlib.setups import POSITION_FEEDBACK, STATE_FEEDBACK, true_states
from ddlib.trajectories import APPENDIX_I, pick_and_place, time_grid
from workshop.report.two_harmonics import (
    NEUTRAL,
    ORDER,
    _two_harmonics,
    record_circle,
    record_quintic,
    record_two_harmonics,
)

T = time_grid(0.01, 0.2)


def test_without_a_second_sine_it_is_the_papers_family():
    own = _two_harmonics(APPENDIX_I, 0 * APPENDIX_I, T)
    for found, wanted in zip(own, pick_and_place(APPENDIX_I, T)):
        np.testing.assert_allclose(found, wanted, atol=1e-15)


@pytest.mark.parametrize("order", [2, 3, 5])
def test_velocity_and_acceleration_are_the_derivatives(order):
    t = np.linspace(0.5, 2.5, 20_001)
    reference = _two_harmonics([40.0, 10.0], [-3.0, 2.0], t, order)
    for lower, upper in pairwise(reference):
        slope = np.gradient(lower, t, axis=0)[1:-1]
        np.testing.assert_allclose(slope, upper[1:-1], atol=2e-6)
    middle = _two_harmonics([40.0, 10.0], [-3.0, 2.0], [1.5], order).q[0]
    sign = np.sin(order * np.pi / 2)  # the second sine half-way: its top, bottom or a zero
    np.testing.assert_allclose(np.rad2deg(middle), [-40 + 3 * sign, -10 - 2 * sign], atol=1e-12)


def test_it_rests_before_and_after():
    reference = _two_harmonics([45.0, 45.0], [3.0, -3.0], T)
    still = (T < 0) | (T >= 3)
    assert still.sum() == 40
    for x in reference:
        assert (x[still] == 0).all()
    # it does not start from rest: both sines are steepest there
    speed = -np.pi / 3 * np.deg2rad([45 + 3 * ORDER, 45 - 3 * ORDER])
    np.testing.assert_allclose(reference.qd[T == 0], [speed], atol=1e-12)


@pytest.fixture(scope="module")
def recordings():
    return {
        "one sine": (STATE_FEEDBACK, STATE_FEEDBACK.record()),
        "ringing": (POSITION_FEEDBACK, POSITION_FEEDBACK.record()),
        "two sines": (STATE_FEEDBACK, record_two_harmonics()),
    }


def test_what_position_explains_of_acceleration(recordings):
    share = {}
    for name, (setup, recording) in recordings.items():
        late = true_states(recording, setup, skip=1.0)[:5].reshape(-1, 2, 3)
        share[name] = [explained(late[:, j, 2], late[:, j, 0]) for j in (0, 1)]
    assert min(share["one sine"]) > 0.85
    assert max(share["ringing"]) < 0.1
    assert max(share["two sines"]) < 0.25


@pytest.mark.parametrize("record", [record_quintic, record_circle])
def test_single_motions_tell_position_from_acceleration(record):
    recording = record(STATE_FEEDBACK)
    states = true_states(recording, STATE_FEEDBACK)
    assert recording.q.shape[-1] == 2 and states.shape == (300, 2, 3)
    assert recording.q.min() > np.deg2rad(-50) and recording.q.max() < np.deg2rad(5)
    for joint in (0, 1):
        assert abs(np.corrcoef(states[:, joint, 0], states[:, joint, 2])[0, 1]) < 0.9


def test_quintic_rests_at_both_ends_and_in_the_middle():
    reference = record_quintic(STATE_FEEDBACK, -30.0).reference
    middle = reference.q[..., 0].argmin()
    assert np.rad2deg(reference.q[middle]) == pytest.approx([-30, -18])
    for k in (0, middle, -1):
        assert np.allclose(reference.qd[k], 0, atol=1e-3)
        assert np.allclose(reference.qdd[k], 0, atol=0.1)
    assert np.abs(reference.qd).max() == pytest.approx(np.deg2rad(30) * 1.875 / 1.5, rel=1e-3)


def test_the_hand_goes_round_a_circle():
    recording = record_circle(STATE_FEEDBACK, radius=0.02, turns=3)
    hand = STATE_FEEDBACK.arm.forward_kinematics(recording.reference.q)[:, -1]
    centre = STATE_FEEDBACK.arm.forward_kinematics(np.array(NEUTRAL))[-1]
    assert np.linalg.norm(hand - centre, axis=-1) == pytest.approx(0.02)
    x = hand[recording.motion, 0] - centre[0]
    assert (np.diff(np.sign(x[np.abs(x) > 1e-9])) != 0).sum() == 6
