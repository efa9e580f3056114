"""A model of windows as feedforward: what it sees, and what happens between its samples."""

import numpy as np
import pytest

from beyond.control.windowed import (
    MeasuredWindows,
    WindowFeedforward,
    poles_inside,
)
from ddlib.control import late_poles, pd, plant
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.trajectories import Trajectory

T = np.arange(0, 400) * 0.002
Q = np.stack([np.sin(3 * T), np.cos(2 * T)], -1)


def middle(windows):
    """The centre of each window, as a torque."""
    return windows[..., windows.shape[-1] // 2]


def curvature(windows):
    """Second difference of neighbouring samples 10 ms apart."""
    c = windows.shape[-1] // 2
    return (windows[..., c - 1] - 2 * windows[..., c] + windows[..., c + 1]) / 0.01**2


def test_every_control_sample_has_its_own_window_or_it_holds_or_draws_a_line():
    np.testing.assert_array_equal(WindowFeedforward(middle, 5)(Q, Q, Q), Q)
    exact = np.stack([-9 * np.sin(3 * T), -4 * np.cos(2 * T)], -1)
    bent = WindowFeedforward(curvature, 5)(Q, Q, Q)
    np.testing.assert_allclose(bent[5:-5], exact[5:-5], atol=2e-3)
    both = np.stack([Q, 2 * Q])  # runs are independent
    np.testing.assert_allclose(
        WindowFeedforward(curvature, 5)(both, both, both)[0], bent, atol=1e-9
    )
    hold = WindowFeedforward(middle, 5, between="hold")(Q, Q, Q)
    np.testing.assert_array_equal(hold, np.repeat(Q[::5], 5, axis=0))
    line = WindowFeedforward(middle, 5, between="line")(Q, Q, Q)
    for joint in range(2):
        drawn = np.interp(T, T[::5], Q[::5, joint])
        np.testing.assert_allclose(line[:396, joint], drawn[:396], atol=1e-12)


FEEDBACK = pd((300.0, 90.0), (35.0, 10.0))


@pytest.mark.parametrize("tap, late", [(0, 10), (1, 5), (2, 0), (3, -5), (4, -10)])
def test_what_has_been_is_measured_and_what_is_to_come_desired(tap, late):
    """A model that passes on one sample of its window."""
    made = WindowFeedforward(lambda windows: windows[..., tap], 5)
    law = MeasuredWindows(made, lambda *_: np.zeros(2)).start(Trajectory(Q, 0 * Q, 0 * Q), 0.002)
    measured = Q + 0.1 * np.random.default_rng(0).standard_normal(Q.shape)
    passed = np.array([law(k, measured[k], 0 * measured[k]) for k in range(60)])
    if late < 0:
        np.testing.assert_array_equal(passed, Q[-late : 60 - late])
    else:
        np.testing.assert_allclose(passed[late:], measured[: 60 - late], atol=1e-12)
        np.testing.assert_array_equal(passed[:late], np.tile(Q[0], (late, 1)))


JOINTS = plant(ARM.mass_matrix([0.0, -0.3]), (5.3, 1.1))
PAST = np.zeros((2, 2, 3))
PRESENT, LATE = PAST.copy(), PAST.copy()
PRESENT[..., 2], LATE[..., 0] = [[-100, -7], [5, -30]], -np.diag([400.0, 120.0])
OTHER_GAINS = np.hstack([np.diag([300.0, 90.0]) - PRESENT[..., 2], np.diag([35.0, 10.0])])


@pytest.mark.parametrize(
    "feedback, past, late, gain, delay",
    [
        *((FEEDBACK, PRESENT, late, OTHER_GAINS, late * 0.002) for late in (0, 1, 5)),
        (pd((0.0, 0.0), (0.0, 0.0)), LATE, 0, np.hstack([-LATE[..., 0], np.zeros((2, 2))]), 0.02),
    ],
)
def test_poles_with_a_model_inside_are_those_of_other_gains_or_of_a_late_loop(
    feedback, past, late, gain, delay
):
    inside = np.abs(poles_inside(JOINTS, feedback, past, 0.002, late=late)).max()
    wanted = np.abs(late_poles(JOINTS, gain, 0.002, delay)).max()
    assert inside == pytest.approx(wanted, abs=1e-12)
