"""The experiment of section 4: its split, its counts, its ways to measure an error."""

from dataclasses import replace

import numpy as np
import pytest

from ddlib import paper
from ddlib.metrics import rmss
from ddlib.setups import (
    JOINT_DAMPING,
    STATE_FEEDBACK,
    errors,
    split,
    train_windows,
    true_states,
)
from ddlib.simulation import LOG_STEP
from ddlib.trajectories import pick_and_place

QUICK = replace(STATE_FEEDBACK, epochs=60, momentum=0.5)


@pytest.fixture(scope="module")
def recording():
    return STATE_FEEDBACK.record()


@pytest.fixture(scope="module")
def trained(recording):
    """Three small networks after 60 epochs."""
    return train_windows(QUICK, recording, 11, 3, seed=4, snapshots=(0, 60), progress=False)


def by_loop(recording, numbers, width):
    """Windows and torques of some runs, sample by sample."""
    half, x, y = width // 2, [], []
    for i in numbers:
        for k in range(50, 350):
            x.append(recording.q[i, k - half : k + half + 1].T)
            y.append(recording.tau[i, k])
    return np.array(x), np.array(y)


def test_another_day_rounds_otherwise():
    """Another zero of the encoders: the same motion on another grid of readings."""
    step = JOINT_DAMPING.effects.encoder[0].step
    first, other, again = (JOINT_DAMPING.repeated(k).record() for k in (1, 2, 1))
    np.testing.assert_array_equal(first.q, again.q)
    np.testing.assert_array_equal(first.tau, again.tau)
    zeros = [(r.q / step) % 1 for r in (first, other)]
    for zero in zeros:  # all readings of a joint lie on one grid
        np.testing.assert_allclose(np.ptp((zero - zero[0, 0] + 0.5) % 1, axis=(0, 1)), 0, atol=1e-6)
    assert (np.abs(zeros[0][0, 0] - zeros[1][0, 0]) > 0.01).all()
    for made in (first, other):
        miss = made.q - made.q_true
        assert np.abs(miss).max() <= 0.5001 * step and np.abs(miss).max() > 0.45 * step
    assert not np.array_equal(first.tau - first.tau_true, other.tau - other.tau_true)


def test_split_is_by_trajectory(recording):
    training, test = split(recording)
    assert training.q.shape == (5, 400, 2) and test.q.shape == (400, 2)
    numbers = (*paper.TRAINING_TRAJECTORIES, paper.TEST_TRAJECTORY)
    for part, i in zip((*(training[k] for k in range(5)), test), numbers):
        for name in ("q", "tau", "q_true", "qd_true", "tau_true"):
            np.testing.assert_array_equal(getattr(part, name), getattr(recording, name)[i - 1])
        for field, whole in zip(part.reference, recording.reference):
            np.testing.assert_array_equal(field, whole[i - 1])
        np.testing.assert_array_equal(part.t, recording.t)
        assert part.motion == recording.motion
    extent = np.rad2deg(np.abs(test.reference.q).max(0))
    np.testing.assert_allclose(extent, paper.APPENDIX_I_EXTENTS_DEG[5], rtol=1e-3)


def test_errors_are_what_their_names_say(recording, trained):
    """Each recomputed from windows made by a loop."""
    model = trained[0]
    found = errors(model, recording).named()
    (x, y), (x6, y6) = by_loop(recording, range(5), 11), by_loop(recording, [5], 11)
    reference = pick_and_place(paper.APPENDIX_I_EXTENTS_DEG[5], recording.t).q
    desired = np.array([reference[k - 5 : k + 6].T for k in range(50, 350)])
    predicted = model.torque(x6)
    wrong = predicted - y6
    wanted = {
        "training": rmss(model.torque(x), y),
        "test": np.sqrt(((wrong**2).mean(1) / y6.var(0)).mean(-1)),
        "test by training deviation": np.sqrt(((wrong**2).mean(1) / y.var(0)).mean(-1)),
        "test shoulder": np.sqrt((wrong[..., 0] ** 2).mean(1) / y6[:, 0].var()),
        "test elbow": np.sqrt((wrong[..., 1] ** 2).mean(1) / y6[:, 1].var()),
        "test, desired positions": rmss(model.torque(desired), y6),
    }
    assert list(found) == list(wanted)
    for name, value in wanted.items():
        assert found[name].shape == (3,)
        np.testing.assert_allclose(found[name], value, rtol=1e-9, err_msg=name)


def test_true_states_are_position_and_its_derivatives(recording):
    states = true_states(recording, STATE_FEEDBACK)
    assert states.shape == (6, 300, 2, 3)
    np.testing.assert_array_equal(states[..., 0], recording.q_true[:, recording.motion])
    slope = np.gradient(states[..., 1], LOG_STEP, axis=1)[:, 60:-1]
    wrong = np.abs(slope - states[:, 60:-1, :, 2])  # beyond the jump at the start
    assert np.median(wrong) < 0.02 and np.percentile(wrong, 95) < 0.2
    late = true_states(recording[2], STATE_FEEDBACK, skip=0.5)
    np.testing.assert_array_equal(late, states[2, 50:])
    other = STATE_FEEDBACK.record([20.0, 10.0], log_step=0.02, duration=2.0)
    states = true_states(other, STATE_FEEDBACK, skip=0.5)
    assert states.shape == (75, 2, 3)
    np.testing.assert_array_equal(states[0, :, 0], other.q_true[np.searchsorted(other.t, 0.499)])
