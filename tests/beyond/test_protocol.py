"""The protocol of rivals: what is refused, what is warned of, what a trial measures."""

import warnings

import numpy as np
import pytest

from ddlib.dynamics import CMU_DD_ARM_II, Operations
from ddlib.setups import STATE_FEEDBACK
from ddlib.trajectories import OutsideFamilyWarning, pick_and_place
from workshop.beyond.rivals.protocol import Cases, Estimating, NotFitted, Rival, trial
from workshop.report import two_harmonics


class Linear(Rival):
    """Least squares on the inputs, without a constant."""

    def __init__(self, kind="states"):
        self.kind = kind

    def _fit(self, x, torque):
        self.matrix = np.linalg.lstsq(x.reshape(len(x), -1), torque, rcond=None)[0]

    def _torque(self, x):
        return x.reshape(len(x), -1) @ self.matrix

    def count(self):
        return self.matrix.size

    def operations(self):
        return Operations(self.matrix.size, self.matrix.size - 2)


STEP = 0.01
TIMES = np.arange(-20, 321) * STEP


def windows(extents=(30.0, 20.0), width=11):
    q, qd, qdd = pick_and_place(extents, TIMES)
    x = np.lib.stride_tricks.sliding_window_view(q, width, axis=0)[60:200]
    centre = slice(60 + width // 2, 200 + width // 2)
    states = np.stack([q, qd, qdd], -1)[centre]
    return Cases(x, CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(states, -1, 0)), "windows", STEP), (
        states
    )


def test_states_estimated_from_windows_are_those_of_the_motion():
    found, states = windows()
    estimated = found.estimated(degree=4)
    assert estimated.kind == "states"
    np.testing.assert_allclose(estimated.x, states, atol=2e-6)


def test_a_rival_of_states_sees_windows_through_filters():
    data, _ = windows()
    alone = Linear().fit(data.estimated())
    within = Estimating(Linear()).fit(data)
    np.testing.assert_allclose(
        within.torque(data.x), alone.torque(data.estimated().x), rtol=1e-9, atol=1e-9
    )
    assert within.count() == alone.count() + 3 * 11
    assert within.operations() == (12 + 2 * 3 * 11, 10 + 2 * 3 * 10, 0, 0)


def test_recordings_become_cases():
    recording = STATE_FEEDBACK.record()
    five = recording[:5]
    data = Cases.windows(five, 21)
    exact = Cases.states(five, two_harmonics.true_states(five, STATE_FEEDBACK))
    assert data.x.shape == (1500, 2, 21) and exact.x.shape == (1500, 2, 3)
    np.testing.assert_array_equal(data.torque, exact.torque)
    assert np.abs(data.x[..., 10] - exact.x[..., 0]).max() < 1e-3


def test_a_trial_measures_errors_by_each_sets_own_deviation():
    data, states = windows()
    exact = Cases(states, data.torque, "states", STEP)
    half = Cases(states[:70], data.torque[:70], "states", STEP)
    found = trial(Linear(), exact, {"all": exact, "half": half})
    left = states.reshape(140, -1) @ np.linalg.pinv(states.reshape(140, -1)) @ data.torque
    for name, n in (("all", 140), ("half", 70)):
        error = ((left - data.torque)[:n] ** 2).mean(0) / data.torque[:n].var(0)
        assert found.rmss[name] == pytest.approx(np.sqrt(error.mean()), rel=1e-9)
    assert found.count == 12 and found.operations == (12, 10, 0, 0) and found.seconds >= 0


def test_inputs_beyond_the_training_box_are_told_and_counted():
    data, states = windows()
    rival = Linear().fit(Cases(states, data.torque, "states", STEP))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rival.torque(states)
    far = states[:3].copy()
    far[1, 0, 1] += 1.2 * np.ptp(states[:, 0, 1])
    with pytest.warns(OutsideFamilyWarning, match="1 of 3 inputs lie outside what Linear"):
        rival.torque(far)
    with warnings.catch_warnings():  # a trial asks on purpose
        warnings.simplefilter("error")
        trial(
            Linear(),
            Cases(states, data.torque, "states", STEP),
            {"far": Cases(far, data.torque[:3], "states", STEP)},
        )


def test_what_makes_no_sense_is_refused():
    data, states = windows()
    with pytest.raises(NotFitted, match="Linear has learnt nothing"):
        Linear().torque(states)
    with pytest.raises(ValueError, match="data must be states for Linear, got windows"):
        Linear().fit(data)
    with pytest.raises(ValueError, match="at least one case"):
        Linear("windows").fit(Cases(data.x[:0], data.torque[:0], "windows", STEP))
    with pytest.raises(ValueError, match=r"x must have shape \(cases, 2, 11\)"):
        Linear("windows").fit(data).torque(data.x[:, :1])
    with pytest.raises(ValueError, match="kind"):
        Cases(data.x, data.torque, "images", STEP)
    with pytest.raises(ValueError, match="step"):
        Cases(data.x, data.torque, "windows", 0.0)
    with pytest.raises(ValueError, match=r"x must have shape \(cases, joint, 3\)"):
        Cases(data.x, data.torque, "states", STEP)
    with pytest.raises(ValueError, match="torque"):
        Cases(data.x, data.torque[:-1], "windows", STEP)
    with pytest.raises(ValueError, match="kind must be 'windows'"):
        Cases(states, data.torque, "states", STEP).estimated()
    with pytest.raises(ValueError, match="rival must be one of states"):
        Estimating(Linear("windows"))
    bad = states.copy()
    bad[0, 0, 0] = np.nan
    with pytest.raises(ValueError, match="finite"):
        Linear().fit(Cases(states, data.torque, "states", STEP)).torque(bad)
