"""A model of windows as feedforward: what it sees, and what happens between its samples."""

import numpy as np
import pytest

from ddlib.control import Feedforward, pd
from ddlib.control.windowed import WindowFeedforward
from ddlib.dynamics import CMU_DD_ARM_II as ARM
from ddlib.simulation import record

T = np.arange(0, 400) * 0.002
Q = np.stack([np.sin(3 * T), np.cos(2 * T)], -1)


def middle(windows):
    """The centre of each window, as a torque."""
    return windows[..., windows.shape[-1] // 2]


def curvature(windows):
    """Second difference of neighbouring samples 10 ms apart."""
    c = windows.shape[-1] // 2
    return (windows[..., c - 1] - 2 * windows[..., c] + windows[..., c + 1]) / 0.01**2


def test_every_control_sample_has_its_own_window():
    np.testing.assert_array_equal(WindowFeedforward(middle, 5)(Q, Q, Q), Q)
    found = WindowFeedforward(curvature, 5)(Q, Q, Q)
    exact = np.stack([-9 * np.sin(3 * T), -4 * np.cos(2 * T)], -1)
    np.testing.assert_allclose(found[5:-5], exact[5:-5], atol=2e-3)


def test_between_samples_it_holds_or_draws_a_line():
    hold = WindowFeedforward(middle, 5, between="hold")(Q, Q, Q)
    np.testing.assert_array_equal(hold, np.repeat(Q[::5], 5, axis=0))
    line = WindowFeedforward(middle, 5, between="line")(Q, Q, Q)
    for joint in range(2):
        drawn = np.interp(T, T[::5], Q[::5, joint])
        np.testing.assert_allclose(line[:396, joint], drawn[:396], atol=1e-12)


def test_the_reference_rests_beyond_its_ends():
    def first(windows):
        return windows[..., 0]

    found = WindowFeedforward(first, 21)(Q, Q, Q)
    np.testing.assert_array_equal(found[:51], np.tile(Q[0], (51, 1)))
    np.testing.assert_array_equal(found[51:], Q[1:-50])


def test_runs_are_independent_and_a_perfect_model_helps_the_loop():
    both = np.stack([Q, 2 * Q])
    model = WindowFeedforward(curvature, 5)
    np.testing.assert_allclose(model(both, both, both)[1], model(2 * Q, Q, Q), atol=1e-9)

    def torque(windows):
        q, qdd = middle(windows), curvature(windows)
        qd = (windows[..., 3] - windows[..., 1]) / 0.02
        return ARM.inverse_dynamics(q, qd, qdd)

    feedback = pd((300.0, 90.0), (35.0, 10.0))
    plain = record(ARM, feedback, (40.0, 30.0))
    helped = record(ARM, Feedforward(WindowFeedforward(torque, 5), feedback), (40.0, 30.0))
    inside = slice(120, 220)
    errors = [np.abs(run.tracking_error[inside]).max() for run in (plain, helped)]
    assert errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize(
    "change, name",
    [({"width": 4}, "width"), ({"every": 0}, "every"), ({"between": "x"}, "between")],
)
def test_bad_arguments_are_refused(change, name):
    with pytest.raises(ValueError, match=name):
        WindowFeedforward(**{"model": middle, "width": 5, **change})


def test_a_model_of_another_shape_is_refused():
    with pytest.raises(ValueError, match="model"):
        WindowFeedforward(lambda w: w[:, 0], 5)(Q, Q, Q)
