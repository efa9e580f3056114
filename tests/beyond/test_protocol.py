"""The protocol of rivals: what is refused, what is warned of, what a trial measures."""

import warnings

import numpy as np
import pytest

from beyond.rivals.protocol import Cases, Estimating, NotFitted, Rival, trial
from ddlib.dynamics import CMU_DD_ARM_II
from ddlib.trajectories import OutsideFamilyWarning, pick_and_place

STEP = 0.01
TIMES = np.arange(-20, 321) * STEP


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


def windows(extents=(30.0, 20.0), width=11):
    q, qd, qdd = pick_and_place(extents, TIMES)
    x = np.lib.stride_tricks.sliding_window_view(q, width, axis=0)[60:200]
    centre = slice(60 + width // 2, 200 + width // 2)
    states = np.stack([q, qd, qdd], -1)[centre]
    torque = CMU_DD_ARM_II.inverse_dynamics(*np.moveaxis(states, -1, 0))
    return Cases(x, torque, "windows", STEP), Cases(states, torque, "states", STEP)


def test_states_estimated_from_windows_are_those_of_the_motion():
    data, exact = windows()
    np.testing.assert_allclose(data.estimated(degree=4).x, exact.x, atol=2e-6)
    alone = Linear().fit(data.estimated())
    within = Estimating(Linear()).fit(data)
    wanted = alone.torque(data.estimated().x)
    np.testing.assert_allclose(within.torque(data.x), wanted, rtol=1e-9, atol=1e-9)
    assert within.count() == alone.count() + 3 * 11


def test_a_trial_measures_errors_by_each_sets_own_deviation():
    _, exact = windows()
    half = Cases(exact.x[:70], exact.torque[:70], "states", STEP)
    found = trial(Linear(), exact, {"all": exact, "half": half})
    flat = exact.x.reshape(140, -1)
    left = flat @ np.linalg.pinv(flat) @ exact.torque - exact.torque
    for name, n in (("all", 140), ("half", 70)):
        error = (left[:n] ** 2).mean(0) / exact.torque[:n].var(0)
        assert found.rmss[name] == pytest.approx(np.sqrt(error.mean()), rel=1e-9)
    assert found.count == 12


def test_inputs_beyond_the_training_box_are_told_and_counted():
    _, exact = windows()
    rival, far = Linear().fit(exact), exact.x[:3].copy()
    far[1, 0, 1] += 1.2 * np.ptp(exact.x[:, 0, 1])
    with pytest.warns(OutsideFamilyWarning, match="1 of 3 inputs lie outside what Linear"):
        rival.torque(far)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rival.torque(exact.x)
        # a trial asks on purpose
        trial(Linear(), exact, {"far": Cases(far, exact.torque[:3], "states", STEP)})


def test_what_makes_no_sense_is_refused():
    seen, exact = windows()
    with pytest.raises(ValueError, match="data must be states for Linear, got windows"):
        Linear().fit(seen)
    with pytest.raises(NotFitted):
        Linear().torque(exact.x)
