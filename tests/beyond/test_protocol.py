"""The protocol of rivals: what is refused, what is warned of, what a trial measures."""

import warnings

import numpy as np
import pytest

from beyond.rivals.protocol import Cases, Estimating, Rival, _NotFitted, trial
from ddlib.dynamics import CMU_DD_ARM_II, Operations
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

    def operations(self):
        return Operations(self.matrix.size, self.matrix.size - 2)


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
    assert within.operations() == (12 + 2 * 3 * 11, 10 + 2 * 3 * 10, 0, 0)


def test_a_trial_measures_errors_by_each_sets_own_deviation():
    _, exact = windows()
    half = Cases(exact.x[:70], exact.torque[:70], "states", STEP)
    found = trial(Linear(), exact, {"all": exact, "half": half})
    flat = exact.x.reshape(140, -1)
    left = flat @ np.linalg.pinv(flat) @ exact.torque - exact.torque
    for name, n in (("all", 140), ("half", 70)):
        error = (left[:n] ** 2).mean(0) / exact.torque[:n].var(0)
        assert found.rmss[name] == pytest.approx(np.sqrt(error.mean()), rel=1e-9)
    assert found.count == 12 and found.operations == (12, 10, 0, 0) and found.seconds >= 0


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


SEEN, EXACT = windows()
BAD = np.where(np.arange(140)[:, None, None] == 0, np.nan, EXACT.x)


def test_what_makes_no_sense_is_refused():
    for make, message in (
        (lambda: Linear().fit(SEEN), "data must be states for Linear, got windows"),
        (lambda: Linear("windows").fit(Cases(SEEN.x[:0], SEEN.torque[:0], "windows", STEP)), "one"),
        (lambda: Linear("windows").fit(SEEN).torque(SEEN.x[:, :1]), r"shape \(cases, 2, 11\)"),
        (lambda: Cases(SEEN.x, SEEN.torque, "states", STEP), r"x must have .* \(cases, joint, 3\)"),
        (lambda: Cases(SEEN.x, SEEN.torque[:-1], "windows", STEP), "torque"),
        (lambda: EXACT.estimated(), "kind must be 'windows'"),
        (lambda: Estimating(Linear("windows")), "rival must be one of states"),
        (lambda: Linear().fit(EXACT).torque(BAD), "finite"),
    ):
        with pytest.raises(ValueError, match=message):
            make()
    with pytest.raises(_NotFitted):
        Linear().torque(EXACT.x)
