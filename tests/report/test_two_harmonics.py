"""Two harmonics: the paper's family as a limit, true derivatives, position and acceleration."""

import numpy as np
import pytest

from ddlib.analysis import explained
from ddlib.setups import POSITION_FEEDBACK, STATE_FEEDBACK, true_states
from ddlib.simulation import LOG_STEP, REST
from ddlib.trajectories import APPENDIX_I, pick_and_place, time_grid
from workshop.report.two_harmonics import (
    NEUTRAL,
    record_circle,
    record_quintic,
    record_two_harmonics,
)


@pytest.mark.parametrize("order", [2, 5])
def test_the_reference_is_the_papers_family_and_a_second_sine(order):
    recording = record_two_harmonics(order=order)
    t = time_grid(LOG_STEP, REST)
    second = [x - y for x, y in zip(recording.reference, pick_and_place(APPENDIX_I, t))]
    moving, omega = (t >= 0) & (t < 3), order * np.pi / 3
    sine, cosine = (f(omega * t)[:, None] * moving[:, None] for f in (np.sin, np.cos))
    size = second[0][:, [sine.argmax()]] / sine.max()
    assert (np.abs(size) > 0).all() and np.abs(size).max() < np.deg2rad(2 * 45 / order**2)
    for x, wanted in zip(second, (sine, omega * cosine, -(omega**2) * sine), strict=True):
        np.testing.assert_allclose(x, size * wanted, atol=1e-12)  # and rests before and after


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
